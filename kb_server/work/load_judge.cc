#include "kb_server/work/load_judge.h"

#include <algorithm>
#include <set>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "graph/rdf/vocabulary.h"
#include "graph/store/graph_writer.h"
#include "kb_server/door/catalog.h"
#include "reasoner/shapes/shape_reader.h"
#include "reasoner/shapes/source_map.h"
#include "reasoner/shapes/validator.h"

namespace docent::server {
namespace {

// The batch as the server's stages would apply it, rules aside.
void Apply(const WriteBatch& batch, Dictionary& dictionary, GraphWriter& writer) {
  for (const Document& document : batch.documents) {
    if (document.kind != Document::Kind::kOntology) continue;
    const std::optional<TermId> graph = dictionary.FindIri(OntologyGraph(document.name));
    if (!graph) continue;
    std::vector<Quad> old;
    writer.current().ForEach({{}, {}, {}, *graph}, [&old](const Quad& quad) {
      old.push_back(quad);
      return true;
    });
    for (const Quad& quad : old) writer.Remove(quad);
  }
  const Term default_graph = Term::Iri(batch.source.empty() ? std::string(kDefaultGraph) : batch.source);
  for (const QuadOperation& operation : batch.operations) {
    const TermQuad& q = operation.quad;
    const Quad quad{dictionary.Intern(q.subject), dictionary.Intern(q.predicate), dictionary.Intern(q.object),
                    dictionary.Intern(q.graph.lexical.empty() ? default_graph : q.graph)};
    if (operation.kind == QuadOperation::Kind::kAdd) {
      writer.Add(quad);
    } else {
      writer.Remove(quad);
    }
  }
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

struct Outcome {
  shapes::ParsedShapes shapes;
  shapes::ValidationReport report;
};

absl::StatusOr<Outcome> Validate(const ReadPorts& ports, const GraphVersion& version, Dictionary& dictionary,
                                 const shapes::SourceMap* places, Cancellation* cancellation) {
  Outcome outcome;
  outcome.shapes = shapes::ReadShapes(shapes::GraphView(version, ModuleGraphs(version, dictionary)),
                                      dictionary, {}, places, ports.functions);
  if (!outcome.shapes.ok() || !outcome.shapes.shapes.HasTargets()) return outcome;
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
                              const LoadedText& text) {
  if (!SpeaksOfShapes(batch)) return {};
  Dictionary dictionary(ports.dictionary);
  GraphWriter writer(GraphVersionPtr(&version, [](const GraphVersion*) {}));
  Apply(batch, dictionary, writer);
  const shapes::SourceMap places = PlacesOf(text, dictionary);
  const GraphVersion& after = writer.current();
  return OfText(shapes::ReadShapes(shapes::GraphView(after, ModuleGraphs(after, dictionary)), dictionary, {},
                                   &places, ports.functions)
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
                                      Cancellation* cancellation) {
  Dictionary dictionary(ports.dictionary);
  // a version without owner: it outlives the writer, which only shares its nodes
  GraphWriter writer(GraphVersionPtr(&version, [](const GraphVersion*) {}));
  Apply(batch, dictionary, writer);
  shapes::SourceMap places;
  if (SpeaksOfShapes(batch)) places = PlacesOf(text, dictionary);
  auto after = Validate(ports, writer.current(), dictionary, &places, cancellation);
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
  if (after->shapes.shapes.any_property) {
    verdict.reads.push_back({});
  } else if (after->shapes.shapes.HasTargets()) {
    for (const TermId property : after->shapes.shapes.properties) {
      verdict.reads.push_back({std::nullopt, dictionary.Decode(property), std::nullopt, std::nullopt});
    }
  }
  if (after->report.conforms()) return verdict;
  auto before = Validate(ports, version, dictionary, nullptr, cancellation);
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
