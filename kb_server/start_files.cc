#include "kb_server/start_files.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <future>
#include <memory>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "graph/base/overload.h"
#include "graph/rdf/document_name.h"
#include "graph/rdf/formats/parser.h"
#include "graph/rdf/formats/text_input.h"
#include "graph/rdf/vocabulary.h"
#include "graph/store/server_graphs.h"
#include "kb_server/work/known_prefixes.h"
#include "kb_server/work/load_runner.h"
#include "reasoner/rules/rule_sets.h"
#include "spdlog/spdlog.h"

namespace docent::server {
namespace {

// True if the module's graph holds exactly these triples.
bool SameGraph(const Dictionary& dictionary, const GraphVersion& version, const std::string& graph,
               const std::vector<TermQuad>& quads) {
  auto id = dictionary.FindIri(graph);
  if (!id) return false;
  uint64_t count = 0;
  version.ForEach({{}, {}, {}, *id}, [&count](const Quad&) {
    ++count;
    return true;
  });
  if (count != quads.size()) return false;
  for (const TermQuad& quad : quads) {
    auto s = dictionary.Find(quad.subject);
    auto p = dictionary.Find(quad.predicate);
    auto o = dictionary.Find(quad.object);
    if (!s || !p || !o || !version.Contains({*s, *p, *o, *id})) return false;
  }
  return true;
}

absl::Status LoadAndWait(const RunPorts& ports, WriteBatch batch, const std::string& what) {
  std::promise<absl::Status> answer;
  LoadJob job;
  job.batch = std::move(batch);
  job.cancellation = std::make_shared<Cancellation>(std::chrono::milliseconds(ports.limits.query_timeout_ms));
  job.done = [&answer, &what](const absl::StatusOr<BatchOutcome>& outcome, const Diagnostics& warnings) {
    for (const Diagnostic& warning : warnings) spdlog::warn("{}: {}", what, warning.message);
    answer.set_value(outcome.status());
  };
  ports.workers->Submit({.run = [&ports, &job] { ports.loads->Run(std::move(job)); },
                         .refuse = [&answer](const absl::Status& why) { answer.set_value(why); }});
  const absl::Status status = answer.get_future().get();
  return status.ok() ? status : WithMessage(status, absl::StrCat(what, ": ", status.message()));
}

}  // namespace

absl::Status LoadOntologyFiles(const RunPorts& ports, const std::vector<std::string>& files) {
  for (const std::string& file : files) {
    auto rdf = ReadRdf(file, "", "", kDocumentText);
    if (!rdf.ok()) return rdf.status();
    std::string name = std::filesystem::path(file).filename().string();
    ParseRdfOptions options = rdf->Options(file);
    options.refuse_graph = RefuseGraph;
    options.blank_node_scope = absl::StrCat(NameInBlankLabel(name), "_");
    ParsedRdf parsed = ParseRdf(rdf->text, rdf->format, options);
    if (!parsed.ok()) return ToStatus(parsed, rdf->text);
    std::string graph = OntologyGraph(name);
    if (SameGraph(*ports.dictionary, *ports.queries->Newest(), graph, parsed.quads)) continue;
    WriteBatch batch;
    batch.mode = WriteBatch::Mode::kLoad;
    batch.documents.push_back(
        {Document::Kind::kOntology, Document::Action::kPut, name, DeclarePrefixes(parsed.prefixes)});
    for (TermQuad& quad : parsed.quads) {
      quad.graph = Term::Iri(graph);
      batch.operations.push_back({QuadOperation::Kind::kAdd, std::move(quad)});
    }
    if (absl::Status status = LoadAndWait(ports, std::move(batch), file); !status.ok()) return status;
  }
  return absl::OkStatus();
}

absl::Status LoadRuleFiles(const RunPorts& ports, const std::vector<std::string>& names) {
  const std::vector<std::string> built_in = rules::BuiltInRuleSets();
  const auto named = [&](const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  const bool chosen = named("none") || std::any_of(built_in.begin(), built_in.end(), named);
  const auto catalog = ports.catalog->Get();
  for (const ModuleEntry& module : catalog->modules) {
    if (!chosen || module.kind != Document::Kind::kRules || named(module.name)) continue;
    if (std::find(built_in.begin(), built_in.end(), module.name) == built_in.end()) continue;
    WriteBatch batch;
    batch.documents.push_back({Document::Kind::kRules, Document::Action::kRemove, module.name, ""});
    if (absl::Status status = LoadAndWait(ports, std::move(batch), module.name); !status.ok()) return status;
  }
  for (const std::string& given : names) {
    if (given == "none") continue;
    std::string name = given;
    std::string text = rules::BuiltInRuleSet(given);
    if (text.empty()) {
      auto file = ReadText(given, kDocumentText);
      if (!file.ok()) {
        return absl::Status(
            file.status().code(),
            absl::StrCat(file.status().message(), "; --rules takes .rules files, none, and the sets ",
                         absl::StrJoin(built_in, ", ")));
      }
      text = *std::move(file);
      name = std::filesystem::path(given).filename().string();
    }
    const bool same =
        std::any_of(catalog->modules.begin(), catalog->modules.end(), [&](const ModuleEntry& module) {
          return module.kind == Document::Kind::kRules && module.name == name && module.text != nullptr &&
                 *module.text == text;
        });
    if (same) continue;
    WriteBatch batch;
    batch.documents.push_back({Document::Kind::kRules, Document::Action::kPut, name, std::move(text)});
    if (absl::Status status = LoadAndWait(ports, std::move(batch), given); !status.ok()) return status;
  }
  return absl::OkStatus();
}

}  // namespace docent::server
