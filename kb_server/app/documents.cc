#include "kb_server/app/documents.h"

#include <algorithm>
#include <set>

#include "absl/strings/str_cat.h"
#include "kb_server/app/robot_directory.h"
#include "kb_server/base/text.h"
#include "kb_server/rdf/vocabulary.h"
#include "workflow/cawl/parser.h"
#include "workflow/rsel/parser.h"

namespace docent {
namespace {

const std::string& DocumentsGraph() {
  static const std::string* graph = new std::string(DocentIri("documents"));
  return *graph;
}

// Brings the description of what is registered from `before` to `after`.
void Describe(const std::set<std::tuple<std::string, std::string, Term>>& before,
              const std::set<std::tuple<std::string, std::string, Term>>& after, WriteBatch* batch) {
  auto change = [&](const auto& fact, QuadOperation::Kind kind) {
    batch->operations.push_back({kind,
                                 {Term::Iri(std::get<0>(fact)), Term::Iri(std::get<1>(fact)), std::get<2>(fact),
                                  Term::Iri(DocumentsGraph())}});
  };
  for (const auto& fact : before) {
    if (after.count(fact) == 0) change(fact, QuadOperation::Kind::kRemove);
  }
  for (const auto& fact : after) {
    if (before.count(fact) == 0) change(fact, QuadOperation::Kind::kAdd);
  }
}

// Workflows and robot services as facts.
std::set<std::tuple<std::string, std::string, Term>> Facts(const Engine& engine) {
  std::set<std::tuple<std::string, std::string, Term>> facts;
  const std::string type(kRdfType);
  const std::string label = Concat(kRdfsNs, "label");
  for (const rsel::PlanPtr& plan : engine.services().Plans()) {
    std::string iri = absl::StrCat("urn:docent:service:", plan->process);
    facts.insert({iri, type, Term::Iri(DocentIri("RobotService"))});
    facts.insert({iri, label, Term::Literal(plan->process)});
    for (const rsel::PlanStep& step : plan->steps) {
      facts.insert({iri, DocentIri("hasStep"), Term::Iri(OperationIri(step.operation))});
    }
  }
  for (const cawl::DocumentPtr& document : engine.workflows()) {
    std::string iri = absl::StrCat("urn:docent:workflow:", document->name.value);
    facts.insert({iri, type, Term::Iri(DocentIri("Workflow"))});
    facts.insert({iri, label, Term::Literal(document->name.value)});
    for (const cawl::Flow& flow : document->flows) facts.insert({iri, DocentIri("flow"), Term::Literal(flow.name.value)});
  }
  return facts;
}

}  // namespace

absl::Status Documents::ApplyOntology(const Document& document, const Dictionary& dictionary,
                                      const GraphVersion& version, WriteBatch* batch) {
  // what the graph has now goes, unless the new text has it too; the applier nets removals and additions out
  std::vector<QuadOperation> operations;
  std::optional<TermId> graph = dictionary.FindIri(OntologyGraph(document.name));
  if (graph) {
    version.ForEach({{}, {}, {}, *graph}, [&](const Quad& quad) {
      operations.push_back({QuadOperation::Kind::kRemove,
                            {dictionary.Decode(quad.subject), dictionary.Decode(quad.predicate),
                             dictionary.Decode(quad.object), dictionary.Decode(quad.graph)}});
      return true;
    });
  }
  operations.insert(operations.end(), std::make_move_iterator(batch->operations.begin()),
                    std::make_move_iterator(batch->operations.end()));
  batch->operations = std::move(operations);
  return absl::OkStatus();
}

absl::Status Documents::ApplyRules(const Document& document, RuleEngine* rules) {
  if (document.action == Document::Action::kRemove) {
    if (rules->RemoveRules(document.name)) return absl::OkStatus();
    return absl::NotFoundError(absl::StrCat("there is no rule set \"", document.name, "\""));
  }
  return ToStatus(rules->PutRules(document.name, document.text), document.text);
}

absl::Status Documents::ApplyCawl(const Document& document, Engine* engine, const Limits& limits, std::string* name) {
  if (document.action == Document::Action::kRemove) {
    if (engine->Undeploy(document.name)) return absl::OkStatus();
    return absl::NotFoundError(absl::StrCat("there is no workflow \"", document.name, "\""));
  }
  cawl::ParsedCawl parsed = cawl::ParseCawl(document.text, document.name, limits);
  if (!parsed.ok()) return ToStatus(parsed.diagnostics, document.text);
  Diagnostics unsupported = Engine::CheckSupported(*parsed.document);
  if (HasErrors(unsupported)) return ToStatus(unsupported, document.text);
  *name = parsed.document->name.value;
  engine->Deploy(parsed.document);
  return absl::OkStatus();
}

absl::Status Documents::ApplyRsel(const Document& document, Engine* engine, const Limits& limits, std::string* name) {
  if (document.action == Document::Action::kRemove) return engine->RemoveServices(document.name);
  rsel::ParsedRsel parsed = rsel::ParseRsel(document.text, document.name, limits);
  if (!parsed.ok()) return ToStatus(parsed.diagnostics, document.text);
  *name = parsed.document->name.value;
  return ToStatus(engine->PutServices(parsed.document), document.text);
}

absl::Status Documents::Apply(WriteBatch* batch, Revision revision, const Dictionary& dictionary,
                              const GraphVersion& version, RuleEngine* rules, Engine* engine, const Limits& limits) {
  if (batch->documents.empty()) return absl::OkStatus();
  if (!undo_) undo_ = entries_;
  auto facts_before = Facts(*engine);
  for (const Document& document : batch->documents) {
    std::string name = document.name;
    uint64_t size = document.text.size();
    absl::Status status;
    switch (document.kind) {
      case Document::Kind::kOntology:
        size = batch->operations.size();
        status = ApplyOntology(document, dictionary, version, batch);
        break;
      case Document::Kind::kRules:
        status = ApplyRules(document, rules);
        break;
      case Document::Kind::kCawl:
        status = ApplyCawl(document, engine, limits, &name);
        break;
      case Document::Kind::kRsel:
        status = ApplyRsel(document, engine, limits, &name);
        break;
    }
    if (!status.ok()) return status;
    if (document.action == Document::Action::kPut) entries_[{document.kind, name}] = {size, std::hash<std::string>()(document.text), revision};
    else entries_.erase({document.kind, name});
  }
  Describe(facts_before, Facts(*engine), batch);
  return absl::OkStatus();
}

void Documents::Rollback() {
  if (undo_) entries_ = *std::move(undo_);
  undo_.reset();
}

std::shared_ptr<const Catalog> Documents::MakeCatalog(const Engine& engine) const {
  auto catalog = std::make_shared<Catalog>();
  for (const auto& [key, entry] : entries_) {
    if (key.first == Document::Kind::kOntology || key.first == Document::Kind::kRules) {
      catalog->modules.push_back({key.second, key.first, entry.size, entry.fingerprint, entry.revision});
    }
  }
  for (const cawl::DocumentPtr& document : engine.workflows()) {
    auto it = entries_.find({Document::Kind::kCawl, document->name.value});
    catalog->workflows.emplace_back(document, it == entries_.end() ? Revision() : it->second.revision);
  }
  catalog->services = engine.services();
  return catalog;
}

}  // namespace docent
