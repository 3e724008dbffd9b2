#include "kb_server/work/load_judge.h"

#include <algorithm>
#include <set>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "graph/rdf/vocabulary.h"
#include "graph/store/batch_applier.h"
#include "graph/store/graph_writer.h"
#include "graph/store/server_graphs.h"
#include "kb_server/door/catalog.h"
#include "kb_server/work/rule_change.h"
#include "reasoner/rules/rule_engine.h"
#include "reasoner/shapes/shape_reader.h"
#include "reasoner/shapes/source_map.h"
#include "reasoner/shapes/validator.h"

namespace docent::server {
namespace {

// The quads of modules that the batch replaces or removes go.
std::vector<QuadOperation> ModulesThatGo(const WriteBatch& batch, const Dictionary& dictionary,
                                         const GraphVersion& version) {
  std::vector<QuadOperation> operations;
  for (const Document& document : batch.documents) {
    if (document.kind != Document::Kind::kOntology) continue;
    const std::optional<TermId> graph = dictionary.FindIri(OntologyGraph(document.name));
    if (!graph) continue;
    version.ForEach({{}, {}, {}, *graph}, [&](const Quad& quad) {
      operations.push_back({QuadOperation::Kind::kRemove,
                            {dictionary.Decode(quad.subject), dictionary.Decode(quad.predicate),
                             dictionary.Decode(quad.object), dictionary.Decode(quad.graph)}});
      return true;
    });
  }
  return operations;
}

// What the rules in use derive of a change, and those that the batch brings or takes away.
absl::StatusOr<Delta> Derive(const ReadPorts& ports, const RuleTexts& rules, const WriteBatch& batch,
                             const Delta& told, Dictionary& dictionary, GraphWriter& writer,
                             Cancellation* cancellation) {
  const bool changes = std::any_of(batch.documents.begin(), batch.documents.end(),
                                   [](const Document& d) { return d.kind == Document::Kind::kRules; });
  if (rules.empty() && !changes) return told;
  rules::RuleEngine engine(dictionary, ports.limits, ports.functions);
  for (const rules::RuleSetText& set : rules) {
    const Diagnostics wrong = engine.PutRules(set.name, set.text, rules::RuleTextOrigin::kAccepted);
    if (HasErrors(wrong)) return ToStatus(wrong, set.text);
  }
  engine.Adopt();
  for (const Document& document : batch.documents) {
    if (document.kind != Document::Kind::kRules) continue;
    if (document.action == Document::Action::kRemove) {
      engine.RemoveRules(document.name);
    } else if (const Diagnostics wrong = engine.PutRules(document.name, document.text); HasErrors(wrong)) {
      return ToStatus(wrong, document.text);
    }
  }
  return engine.Update(writer, told, cancellation);
}

// The batch as the server's stages would apply it, runs aside: what it changes.
absl::StatusOr<Delta> Apply(const ReadPorts& ports, const RuleTexts& rules, const WriteBatch& batch,
                            Dictionary& dictionary, GraphWriter& writer, Cancellation* cancellation) {
  BatchApplier applier(dictionary, ports.limits);
  applier.Announce(batch, writer.current());
  const auto told = applier.Apply(batch, writer, ModulesThatGo(batch, dictionary, writer.current()));
  if (!told.ok()) return told.status();
  return Derive(ports, rules, batch, *told, dictionary, writer, cancellation);
}

// Whether a module is loaded that has words of SHACL.
bool SpeaksOfShapes(const WriteBatch& batch) {
  const bool module = std::any_of(batch.documents.begin(), batch.documents.end(),
                                  [](const Document& d) { return d.kind == Document::Kind::kOntology; });
  return module && std::any_of(batch.operations.begin(), batch.operations.end(), [](const QuadOperation& o) {
           return o.quad.predicate.lexical.starts_with(shapes::kShaclNs);
         });
}

// Warnings about shapes of other modules are left out: who loaded those was told.
Diagnostics OfText(Diagnostics diagnostics, const LoadedText& text) {
  std::erase_if(diagnostics, [&](const Diagnostic& d) {
    return d.severity != Diagnostic::Severity::kError && (text.name.empty() || d.file != text.name);
  });
  return diagnostics;
}

// Whether a validation by the shapes can see the change.
bool Reads(const shapes::ShapeSet& shapes, const Delta& delta, const Dictionary& dictionary) {
  const auto read = [&](const Quad& quad) {
    return shapes.any_property || IsModuleGraph(dictionary.Lexical(quad.graph)) ||
           std::binary_search(shapes.properties.begin(), shapes.properties.end(), quad.predicate);
  };
  return std::any_of(delta.added.begin(), delta.added.end(), read) ||
         std::any_of(delta.removed.begin(), delta.removed.end(), read);
}

struct Outcome {
  shapes::ParsedShapes shapes;
  shapes::ValidationReport report;
  bool sees = true;  // the change
};

// `delta`: a version of which this is known to be one step away, and that need not be looked at where the shapes do not see the
// step; null: it is looked at.
absl::StatusOr<Outcome> Validate(const ReadPorts& ports, const GraphVersion& version, Dictionary& dictionary,
                                 const RuleTexts& rules, const shapes::SourceMap* places,
                                 Cancellation* cancellation, const Delta* delta = nullptr) {
  Outcome outcome;
  outcome.shapes = shapes::ReadShapes(shapes::GraphView(version, ModuleGraphs(version, dictionary)),
                                      dictionary, {}, places, ports.functions, {RegimesOf(rules)});
  if (!outcome.shapes.ok() || !outcome.shapes.shapes.HasTargets()) return outcome;
  if (delta != nullptr && !Reads(outcome.shapes.shapes, *delta, dictionary)) {
    outcome.sees = false;
    return outcome;
  }
  const shapes::ValidateOptions options = ValidateOptionsOf(ports, cancellation);
  auto report = shapes::Validate(outcome.shapes.shapes, shapes::GraphView(version), dictionary, options);
  if (!report.ok()) return report.status();
  outcome.report = *std::move(report);
  return outcome;
}

// What makes a result the same one before and after. Ids of the version are those of its copy.
std::string KeyOf(const shapes::ValidationResult& result, const Dictionary& dictionary) {
  return absl::StrCat(result.focus.bits(), " ", result.value.bits(), " ", result.shape.bits(), " ",
                      static_cast<int>(result.component), " ", result.own_component.bits(), " ",
                      result.computed ? ToNTriples(*result.computed) : "", " ",
                      result.has_path ? shapes::PathText(result.path, dictionary) : "", " ",
                      result.messages[0].lexical);
}

// Where the quads of the text stand, by the ids of the private copy.
shapes::SourceMap PlacesOf(const LoadedText& text, const Dictionary& dictionary) {
  shapes::SourceMap places;
  if (text.name.empty()) return places;
  const LocatedRdf document = text.parse();
  for (size_t i = 0; i < document.rdf.quads.size(); ++i) {
    const TermQuad& q = document.rdf.quads[i];
    const auto subject = dictionary.Find(q.subject), predicate = dictionary.Find(q.predicate),
               object = dictionary.Find(q.object);
    if (!subject || !predicate || !object) continue;
    places.Add({*subject, *predicate, *object, TermId()}, {text.name, document.places[i].subject},
               {text.name, document.places[i].object});
  }
  return places;
}

void Collect(const Outcome& before, const Outcome& after, const WriteBatch& batch, const LoadedText& loaded,
             const Dictionary& dictionary, LoadVerdict* verdict) {
  shapes::SourceMap places;
  std::multiset<std::string> old;
  for (const shapes::ValidationResult& result : before.report.results) old.insert(KeyOf(result, dictionary));
  for (const shapes::ValidationResult& result : after.report.results) {
    if (auto known = old.find(KeyOf(result, dictionary)); known != old.end()) {
      old.erase(known);
      continue;
    }
    JudgedResult judged;
    if (verdict->results.empty()) places = PlacesOf(loaded, dictionary);
    // shapes are those of modules: data that speak of one do not say where it is
    judged.text = shapes::Describe(result, dictionary, &places, batch.documents.empty() ? nullptr : &places);
    judged.focus = dictionary.Decode(result.focus);
    if (auto value = shapes::ValueOf(result, dictionary)) judged.value = *std::move(value);
    judged.shape = dictionary.Decode(result.shape);
    judged.violation = judged.text.severity == "violation";
    verdict->results.push_back(std::move(judged));
  }
}

}  // namespace

shapes::ValidateOptions ValidateOptionsOf(const ReadPorts& ports, Cancellation* cancellation) {
  shapes::ValidateOptions options;
  options.memory_bytes = ports.limits.query_memory_bytes;
  options.all_memory = ports.query_memory;
  options.cancellation = cancellation;
  options.functions = ports.functions;
  options.now_us = ports.clock->Now();
  return options;
}

Diagnostics CheckLoadedShapes(const ReadPorts& ports, const WriteBatch& batch, const GraphVersion& version,
                              const LoadedText& text, const RuleTexts& rules) {
  if (!SpeaksOfShapes(batch)) return {};
  Dictionary dictionary(ports.dictionary);
  GraphWriter writer(GraphVersionPtr(&version, [](const GraphVersion*) {}));
  if (!Apply(ports, {}, batch, dictionary, writer, nullptr).ok()) return {};  // the turn says what is wrong
  const shapes::SourceMap places = PlacesOf(text, dictionary);
  const GraphVersion& after = writer.current();
  return OfText(shapes::ReadShapes(shapes::GraphView(after, ModuleGraphs(after, dictionary)), dictionary, {},
                                   &places, ports.functions, {RegimesOf(rules)})
                    .diagnostics,
                text);
}

bool LoadVerdict::HasViolations() const {
  return HasErrors(diagnostics) ||
         std::any_of(results.begin(), results.end(), [](const JudgedResult& r) { return r.violation; });
}

std::vector<TermId> ModuleGraphs(const GraphVersion& version, const Dictionary& dictionary) {
  const std::string base = OntologyGraph("");
  std::vector<TermId> graphs;
  for (const TermId graph : version.graphs()) {
    if (graph.IsIri() && dictionary.Lexical(graph).starts_with(base)) graphs.push_back(graph);
  }
  return graphs;
}

absl::StatusOr<LoadVerdict> JudgeLoad(const ReadPorts& ports, const WriteBatch& batch,
                                      const GraphVersion& version, const LoadedText& text,
                                      const RuleTexts& rules, Cancellation* cancellation) {
  Dictionary dictionary(ports.dictionary);
  // a version without owner: it outlives the writer, which only shares its nodes
  GraphWriter writer(GraphVersionPtr(&version, [](const GraphVersion*) {}));
  const auto delta = Apply(ports, rules, batch, dictionary, writer, cancellation);
  if (!delta.ok()) return delta.status();
  shapes::SourceMap places;
  if (SpeaksOfShapes(batch)) places = PlacesOf(text, dictionary);
  auto after = Validate(ports, writer.current(), dictionary, rules, &places, cancellation, &*delta);
  if (!after.ok()) return after.status();
  LoadVerdict verdict;
  verdict.diagnostics = OfText(std::move(after->shapes.diagnostics), text);
  // Whether there are shapes at all is looked for, too.
  for (const char* word : {"targetNode", "targetClass", "targetSubjectsOf", "targetObjectsOf", "target"}) {
    verdict.reads.push_back({std::nullopt, Term::Iri(shapes::Shacl(word)), std::nullopt, std::nullopt});
  }
  for (const char* word : {"NodeShape", "PropertyShape"}) {
    verdict.reads.push_back(
        {std::nullopt, Term::Iri(std::string(kRdfType)), Term::Iri(shapes::Shacl(word)), std::nullopt});
  }
  if (after->shapes.shapes.any_property || (!rules.empty() && after->shapes.shapes.HasTargets())) {
    verdict.reads.push_back({});  // with rules: what they derive may depend on any fact
  } else if (after->shapes.shapes.HasTargets() && after->sees) {
    for (const TermId property : after->shapes.shapes.properties) {
      verdict.reads.push_back({std::nullopt, dictionary.Decode(property), std::nullopt, std::nullopt});
    }
  }
  if (after->report.conforms()) return verdict;
  auto before = Validate(ports, version, dictionary, rules, nullptr, cancellation);
  if (!before.ok()) return before.status();
  Collect(*before, *after, batch, text, dictionary, &verdict);
  if (verdict.results.empty() && after->report.total > before->report.total) {
    return absl::ResourceExhaustedError(absl::StrCat(
        "the graph has ", after->report.total,
        " validation results, more than the limit validation_results = ", after->report.results.size(),
        ", so that new ones cannot be told from old ones; correct those it has"));
  }
  return verdict;
}

}  // namespace docent::server
