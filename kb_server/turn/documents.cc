#include "kb_server/turn/documents.h"

#include <algorithm>
#include <set>
#include <tuple>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "graph/base/diagnostic.h"
#include "graph/base/source_texts.h"
#include "graph/base/text.h"
#include "graph/rdf/docent_iris.h"
#include "graph/rdf/vocabulary.h"
#include "kb_server/door/parsed_document.h"
#include "kb_server/door/workflow_removal.h"
#include "workflow/cawl/parser.h"
#include "workflow/rsel/parser.h"

namespace docent::server {
namespace {

using Fact = std::tuple<std::string, std::string, Term>;

// What the graph says of one workflow, or of the robot services of one RSEL document; nothing if it is not
// there.
std::set<Fact> Facts(const engine::Engine& engine, Document::Kind kind, const std::string& name,
                     const DocumentVersions* versions = nullptr) {
  std::set<Fact> facts;
  const std::string type(kRdfType);
  const std::string label = Concat(kRdfsNs, "label");
  if (kind == Document::Kind::kRsel) {
    const std::string document = ServiceDocumentIri(name);
    if (versions != nullptr && versions->live) {
      const DocumentVersion& newest = versions->newest();
      facts.insert({document, type, Term::Iri(DocentIri("ServiceDocument"))});
      facts.insert({document, label, Term::Literal(name)});
      facts.insert({document, DocentIri("versionNumber"), Term::Integer(newest.number)});
      facts.insert({document, DocentIri("registeredAtRevision"),
                    Term::Integer(static_cast<int64_t>(newest.revision.value()))});
      if (!newest.own_version.empty())
        facts.insert({document, DocentIri("documentVersion"), Term::Literal(newest.own_version)});
    }
    for (const rsel::PlanPtr& plan : engine.services().Plans()) {
      if (plan->document != name) continue;
      std::string iri = ServiceIri(plan->process);
      facts.insert({document, DocentIri("defines"), Term::Iri(iri)});
      facts.insert({iri, type, Term::Iri(DocentIri("RobotService"))});
      facts.insert({iri, label, Term::Literal(plan->process)});
      for (const rsel::PlanStep& step : plan->steps) {
        facts.insert({iri, DocentIri("hasStep"), Term::Iri(OperationIri(step.operation))});
      }
    }
  }
  if (kind == Document::Kind::kCawl) {
    if (cawl::DocumentPtr document = engine.FindWorkflow(name)) {
      std::string iri = WorkflowIri(name);
      facts.insert({iri, type, Term::Iri(DocentIri("Workflow"))});
      facts.insert({iri, label, Term::Literal(name)});
      for (const cawl::Flow& flow : document->flows)
        facts.insert({iri, DocentIri("flow"), Term::Literal(flow.name.value)});
      if (!engine.IsEnabled(name)) facts.insert({iri, DocentIri("disabled"), Term::Boolean(true)});
      if (versions != nullptr && versions->live)
        facts.insert({iri, DocentIri("versionNumber"), Term::Integer(versions->newest().number)});
    }
  }
  return facts;
}

// Adds what leads from `before` to `after`.
void Describe(const std::set<Fact>& before, const std::set<Fact>& after,
              std::vector<QuadOperation>* operations) {
  auto change = [&](const Fact& fact, QuadOperation::Kind kind) {
    const auto& [subject, predicate, object] = fact;
    operations->push_back(
        {kind, {Term::Iri(subject), Term::Iri(predicate), object, Term::Iri(std::string(kDocumentsGraph))}});
  };
  for (const Fact& fact : before) {
    if (after.count(fact) == 0) change(fact, QuadOperation::Kind::kRemove);
  }
  for (const Fact& fact : after) {
    if (before.count(fact) == 0) change(fact, QuadOperation::Kind::kAdd);
  }
}

// As the service that brought it has parsed it, or parsed now (replay).
absl::StatusOr<cawl::DocumentPtr> CawlOf(const Document& document, const Limits& limits) {
  const auto* brought = dynamic_cast<const ParsedDocument*>(document.parsed.get());
  if (brought != nullptr && brought->cawl != nullptr) return brought->cawl;
  cawl::ParsedCawl parsed = cawl::ParseCawl(document.text, document.name, limits);
  if (!parsed.ok()) return ToStatus(parsed.diagnostics, document.text);
  return std::move(parsed.document);
}
absl::StatusOr<rsel::DocumentPtr> RselOf(const Document& document, const Limits& limits) {
  const auto* brought = dynamic_cast<const ParsedDocument*>(document.parsed.get());
  if (brought != nullptr && brought->rsel != nullptr) return brought->rsel;
  rsel::ParsedRsel parsed = rsel::ParseRsel(document.text, document.name, limits);
  if (!parsed.ok()) return ToStatus(parsed.diagnostics, document.text);
  return std::move(parsed.document);
}

// ABORTED where another version is deployed than the one that the document is to replace.
absl::Status CheckReplaced(const Document& document, const std::string& name,
                           const DocumentVersions* versions) {
  const uint32_t live = versions != nullptr && versions->live ? versions->newest().number : 0;
  if (!document.replaces || *document.replaces == live) return absl::OkStatus();
  const auto words = [](uint32_t number) { return number == 0 ? "none" : absl::StrCat("version ", number); };
  return absl::AbortedError(absl::StrCat("of workflow ", name, ", ", words(live), " is deployed and not ",
                                         words(*document.replaces),
                                         ", which this text is to replace; look at it and deploy again"));
}

// A removal that leaves the workflow there: it is enabled or disabled.
bool ChangesStarts(const Document& document) {
  return document.kind == Document::Kind::kCawl && document.action == Document::Action::kRemove &&
         (document.text == kRemovesStarts || document.text == kRemovesDisablement);
}

// The nodes of deployed workflows that invoke processes of the document.
std::vector<std::string> UsersOf(const rsel::Document& document, const engine::Engine& engine) {
  std::vector<std::string> users;
  for (const cawl::DocumentPtr& workflow : engine.workflows()) {
    for (const cawl::Flow& flow : workflow->flows) {
      for (const cawl::Node& node : flow.nodes) {
        for (const cawl::Invoke& invoke : node.invokes) {
          if (document.FindProcess(invoke.operation.value) == nullptr) continue;
          users.push_back(Concat("node ", node.name.value, " of workflow ", workflow->name.value, " (",
                                 invoke.operation.value, ")"));
        }
      }
    }
  }
  return users;
}

// FAILED_PRECONDITION, naming the users.
absl::Status CheckUnused(const std::string& name, const engine::Engine& engine) {
  constexpr size_t kNamed = 10;
  for (const rsel::DocumentPtr& document : engine.services().Documents()) {
    if (document->name.value != name) continue;
    std::vector<std::string> users = UsersOf(*document, engine);
    if (users.empty()) break;
    const size_t more = users.size() > kNamed ? users.size() - kNamed : 0;
    if (more > 0) {
      users.resize(kNamed);
      users.push_back(absl::StrCat(more, " more"));
    }
    return absl::FailedPreconditionError(Concat("RSEL document ", name, " is used by ",
                                                absl::StrJoin(users, ", "),
                                                "; undeploy what uses it first, or force the removal"));
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status Documents::ApplyOntology(const Document& document, const DocumentStages& stages,
                                      Operations* operations) {
  if (document.action == Document::Action::kRemove && entries_.count({document.kind, document.name}) == 0) {
    return absl::NotFoundError(absl::StrCat("there is no ontology \"", document.name, "\""));
  }
  // what the graph has now goes, unless the new text has it too; the applier nets removals and additions out
  const Dictionary& dictionary = stages.dictionary;
  if (const std::optional<TermId> graph = dictionary.FindIri(OntologyGraph(document.name))) {
    stages.version.ForEach({{}, {}, {}, *graph}, [&](const Quad& quad) {
      operations->push_back({QuadOperation::Kind::kRemove,
                             {dictionary.Decode(quad.subject), dictionary.Decode(quad.predicate),
                              dictionary.Decode(quad.object), dictionary.Decode(quad.graph)}});
      return true;
    });
  }
  return absl::OkStatus();
}

absl::Status Documents::ApplyRules(const Document& document, rules::RuleTextOrigin origin,
                                   rules::RuleEngine* rules) {
  if (document.action == Document::Action::kRemove) {
    if (rules->RemoveRules(document.name)) return absl::OkStatus();
    return absl::NotFoundError(absl::StrCat("there is no rule set \"", document.name, "\""));
  }
  const Diagnostics diagnostics = rules->PutRules(document.name, document.text, origin);
  if (!HasErrors(diagnostics)) return absl::OkStatus();
  SourceTexts texts;
  for (const auto& [key, entry] : entries_) {
    if (key.first == Document::Kind::kRules && entry.text != nullptr) texts.Put(key.second, *entry.text);
  }
  texts.Put(document.name, document.text);
  return texts.ToStatus(diagnostics);
}

// What is done to a workflow that is deployed.
absl::Status Documents::ChangeCawl(const Document& document, Revision revision, engine::Engine* engine,
                                   Operations* operations) {
  const VersionHistory::Key key{document.kind, document.name};
  if (engine->FindWorkflow(document.name) == nullptr) {
    std::vector<std::string> names;
    for (const cawl::DocumentPtr& workflow : engine->workflows()) names.push_back(workflow->name.value);
    const std::string near = Nearest(document.name, names);
    return absl::NotFoundError(absl::StrCat("there is no workflow \"", document.name, "\"",
                                            near.empty() ? "" : absl::StrCat("; did you mean ", near, "?")));
  }
  const std::set<Fact> before = Facts(*engine, document.kind, document.name, versions_.Find(key).get());
  std::set<Fact> after;
  if (ChangesStarts(document)) {
    engine->SetEnabled(document.name, document.text == kRemovesDisablement);
    after = Facts(*engine, document.kind, document.name, versions_.Find(key).get());
  } else {
    engine->Undeploy(document.name, document.text == kRemovesRuns);
    versions_.Remove(key, revision);
  }
  Describe(before, after, operations);
  return absl::OkStatus();
}

absl::Status Documents::ApplyCawl(const Document& document, Revision revision, const DocumentStages& stages,
                                  Operations* operations, std::string* name) {
  engine::Engine* engine = stages.engine;
  if (!undo_versions_) undo_versions_ = versions_;
  if (document.action == Document::Action::kRemove) return ChangeCawl(document, revision, engine, operations);
  const auto parsed = CawlOf(document, stages.limits);
  if (!parsed.ok()) return parsed.status();
  *name = (*parsed)->name.value;
  const VersionHistory::Key key{document.kind, *name};
  const DocumentVersionsPtr versions = versions_.Find(key);
  if (absl::Status status = CheckReplaced(document, *name, versions.get()); !status.ok()) return status;
  std::set<Fact> before = Facts(*engine, document.kind, *name, versions.get());
  if (absl::Status status = engine->Deploy(*parsed); !status.ok()) return status;
  versions_.Put(key, (*parsed)->version.value, document.text, revision, stages.now_us);
  Describe(before, Facts(*engine, document.kind, *name, versions_.Find(key).get()), operations);
  return absl::OkStatus();
}

absl::Status Documents::ApplyRsel(const Document& document, Revision revision, const DocumentStages& stages,
                                  Operations* operations, std::string* name) {
  engine::Engine* engine = stages.engine;
  if (!undo_versions_) undo_versions_ = versions_;
  if (document.action == Document::Action::kRemove) {
    const bool force = document.text == kForcedRemoval;
    const VersionHistory::Key key{document.kind, document.name};
    std::set<Fact> before = Facts(*engine, document.kind, document.name, versions_.Find(key).get());
    absl::Status status = force ? absl::OkStatus() : CheckUnused(document.name, *engine);
    if (status.ok()) status = engine->RemoveServices(document.name, force);
    if (!status.ok()) return status;
    versions_.Remove(key, revision);
    Describe(before, {}, operations);
    return status;
  }
  const auto parsed = RselOf(document, stages.limits);
  if (!parsed.ok()) return parsed.status();
  *name = (*parsed)->name.value;
  const VersionHistory::Key key{document.kind, *name};
  std::set<Fact> before = Facts(*engine, document.kind, *name, versions_.Find(key).get());
  if (absl::Status status = ToStatus(engine->PutServices(*parsed), document.text); !status.ok())
    return status;
  versions_.Put(key, (*parsed)->version.value, document.text, revision, stages.now_us);
  Describe(before, Facts(*engine, document.kind, *name, versions_.Find(key).get()), operations);
  return absl::OkStatus();
}

absl::StatusOr<std::vector<QuadOperation>> Documents::Apply(const WriteBatch& batch, Revision revision,
                                                            const DocumentStages& stages) {
  std::vector<QuadOperation> operations;
  if (batch.documents.empty()) return operations;
  if (!undo_) undo_ = entries_;
  for (const Document& document : batch.documents) {
    std::string name = document.name;
    uint64_t size = document.text.size();  // triples of ontologies, rules of rule sets; else bytes
    absl::Status status;
    switch (document.kind) {
      case Document::Kind::kOntology:
        size = batch.operations.size();
        status = ApplyOntology(document, stages, &operations);
        break;
      case Document::Kind::kRules:
        status = ApplyRules(document, stages.rule_origin, stages.rules);
        size = stages.rules->rule_count(document.name);
        break;
      case Document::Kind::kCawl:
        status = ApplyCawl(document, revision, stages, &operations, &name);
        break;
      case Document::Kind::kRsel:
        status = ApplyRsel(document, revision, stages, &operations, &name);
        break;
    }
    if (!status.ok()) return status;
    if (ChangesStarts(document)) continue;
    if (document.action == Document::Action::kRemove) {
      entries_.erase({document.kind, name});
      continue;
    }
    std::shared_ptr<const std::string> text;
    if (document.kind == Document::Kind::kRules || document.kind == Document::Kind::kOntology)
      text = std::make_shared<const std::string>(document.text);
    entries_[{document.kind, name}] = {size, revision, std::move(text)};
  }
  return operations;
}

absl::Status Documents::Restore(std::map<Key, Entry> entries, rules::RuleEngine* rules) {
  for (auto& [key, entry] : entries) {
    if (key.first != Document::Kind::kRules) continue;
    const Diagnostics diagnostics =
        rules->PutRules(key.second, *entry.text, rules::RuleTextOrigin::kAccepted);
    if (HasErrors(diagnostics)) return ToStatus(diagnostics, *entry.text);
  }
  entries_ = std::move(entries);
  return absl::OkStatus();
}

void Documents::RestoreVersions(VersionHistory versions, const engine::Engine& engine) {
  versions_ = std::move(versions);
  for (const cawl::DocumentPtr& workflow : engine.workflows()) {
    const Key key{Document::Kind::kCawl, workflow->name.value};
    if (versions_.Find(key) != nullptr) continue;
    const auto entry = entries_.find(key);
    versions_.Put(key, workflow->version.value, workflow->source,
                  entry == entries_.end() ? Revision() : entry->second.revision, 0);
  }
  for (const rsel::DocumentPtr& document : engine.services().Documents()) {
    const Key key{Document::Kind::kRsel, document->name.value};
    if (versions_.Find(key) != nullptr) continue;
    const auto entry = entries_.find(key);
    versions_.Put(key, document->version.value, document->source,
                  entry == entries_.end() ? Revision() : entry->second.revision, 0);
  }
}

void Documents::Rollback() {
  if (undo_) entries_ = *std::move(undo_);
  undo_.reset();
  if (undo_versions_) versions_ = *std::move(undo_versions_);
  undo_versions_.reset();
}

std::shared_ptr<const Catalog> Documents::MakeCatalog(const engine::Engine& engine) const {
  auto catalog = std::make_shared<Catalog>();
  for (const auto& [key, entry] : entries_) {
    if (key.first == Document::Kind::kOntology || key.first == Document::Kind::kRules) {
      catalog->modules.push_back({key.second, key.first, entry.size, entry.revision, entry.text});
    }
    if (key.first == Document::Kind::kRules) catalog->rules.push_back({key.second, entry.text});
  }
  for (const cawl::DocumentPtr& document : engine.workflows()) {
    auto it = entries_.find({Document::Kind::kCawl, document->name.value});
    if (!engine.IsEnabled(document->name.value)) catalog->disabled_workflows.insert(document->name.value);
    catalog->workflows.emplace_back(document, it == entries_.end() ? Revision() : it->second.revision);
  }
  catalog->services = engine.services();
  catalog->versions = versions_;
  return catalog;
}

}  // namespace docent::server
