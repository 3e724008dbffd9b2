// docent validate: SHACL validation of files, or of what a running server holds.
#include <CLI/CLI.hpp>
#include <chrono>
#include <iostream>
#include <map>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "docent/v1/ontologies.grpc.pb.h"
#include "graph/rdf/formats/parser.h"
#include "graph/rdf/formats/serializer.h"
#include "graph/rdf/formats/text_input.h"
#include "graph/rdf/vocabulary.h"
#include "graph/sparql/values/function_registry.h"
#include "kb_server/cli/client.h"
#include "kb_server/cli/commands.h"
#include "kb_server/cli/display_width.h"
#include "kb_server/cli/result_json.h"
#include "kb_server/cli/terminal.h"
#include "kb_server/grpc/convert.h"
#include "kb_server/grpc/validation_proto.h"
#include "kb_server/turn/spatial_functions.h"
#include "nlohmann/json.hpp"
#include "reasoner/shapes/file_graph.h"
#include "reasoner/shapes/report.h"
#include "reasoner/shapes/shape_reader.h"
#include "reasoner/shapes/validator.h"

namespace docent::server {
namespace {

constexpr char kDataGraph[] = "urn:docent:data";
constexpr char kShapesGraph[] = "urn:docent:shapes";

struct ValidateArguments {
  ClientOptions client;
  std::vector<std::string> shapes, data;
  std::string base;
  int timeout_ms = 0;
  bool rdf = false;
};

std::vector<std::pair<std::string, std::string>> ReportPrefixes() {
  std::vector<std::pair<std::string, std::string>> prefixes = {{"sh", std::string(shapes::kShaclNs)}};
  for (const auto& [prefix, iri] : kWellKnownPrefixes) prefixes.emplace_back(prefix, iri);
  return prefixes;
}

int PrintRdf(const std::vector<TermQuad>& report, bool conforms) {
  auto text = SerializeRdf(report, RdfFormat::kTurtle, ReportPrefixes());
  if (!text.ok()) return Fail(text.status());
  PrintForPrograms(*text);
  return conforms ? kExitOk : kExitNegative;
}

void PrintResultJson(const shapes::ResultText& result) {
  std::cout << PrintableJson(
                   ResultJson(result).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace))
            << "\n";
}

void PrintEnd(bool json, bool conforms, uint64_t total, uint64_t focus_nodes, const std::string& summary) {
  if (!json) {
    std::cout << summary << "\n";
    return;
  }
  std::cout
      << nlohmann::json({{"conforms", conforms}, {"results", total}, {"focus_nodes", focus_nodes}}).dump()
      << "\n";
}

// Files are validated here, without a server.
class FileValidator {
 public:
  explicit FileValidator(const ValidateArguments& arguments) : arguments_(arguments) {
    RegisterSpatialFunctions(&functions_);
  }

  int Run() {
    for (const std::string& file : arguments_.data) {
      if (!Load(file, kDataGraph)) return kExitBad;
    }
    for (const std::string& file : arguments_.shapes) {
      if (!Load(file, kShapesGraph)) return kExitBad;
    }
    // Without --shapes the data bring their own.
    const char* shapes_graph = arguments_.shapes.empty() ? kDataGraph : kShapesGraph;
    const shapes::GraphView view = graph_.View(shapes_graph);
    const shapes::SourceMap& places = graph_.Places(shapes_graph);
    const shapes::ParsedShapes parsed =
        shapes::ReadShapes(view, graph_.dictionary(), {}, &places, &functions_,
                           {{}, Diagnostic::Severity::kError});  // files are as they are: nothing is inferred
    for (const Diagnostic& d : parsed.diagnostics) std::cerr << Render({d}, texts_[d.file]);
    if (!parsed.ok()) return kExitBad;
    if (!parsed.shapes.HasTargets()) {
      std::cerr << "docent: no shape has a target; name the file of shapes with --shapes, and give them "
                   "sh:targetClass, "
                   "sh:targetNode, sh:targetSubjectsOf, sh:targetObjectsOf or sh:target\n";
      return kExitBad;
    }
    Cancellation cancellation{std::chrono::milliseconds(arguments_.timeout_ms)};
    shapes::ValidateOptions options;
    options.functions = &functions_;
    options.now_us = absl::ToUnixMicros(absl::Now());
    if (arguments_.timeout_ms > 0) options.cancellation = &cancellation;
    auto report = shapes::Validate(parsed.shapes, graph_.View(kDataGraph), graph_.dictionary(), options);
    if (!report.ok()) return Fail(report.status());
    return Print(*report, places);
  }

 private:
  bool Load(const std::string& file, const std::string& graph) {
    auto rdf = ReadRdf(file, arguments_.base);
    if (!rdf.ok()) {
      Fail(rdf.status());
      return false;
    }
    ParseRdfOptions options = rdf->Options(file);
    options.blank_node_scope = absl::StrCat("f", texts_.size(), "_");
    const LocatedRdf document = ParseLocatedRdf(rdf->text, rdf->format, options);
    std::cerr << Render(document.rdf.diagnostics, rdf->text);
    if (!document.rdf.ok()) return false;
    graph_.Add(file, document, graph);
    texts_[file] = std::move(rdf->text);
    return true;
  }

  int Print(const shapes::ValidationReport& report, const shapes::SourceMap& shape_places) {
    if (arguments_.rdf) return PrintRdf(shapes::ToRdf(report, graph_.dictionary()), report.conforms());
    for (const shapes::ValidationResult& result : report.results) {
      const shapes::ResultText text =
          shapes::Describe(result, graph_.dictionary(), &graph_.Places(kDataGraph), &shape_places);
      if (arguments_.client.json) {
        PrintResultJson(text);
      } else {
        std::cout << shapes::Render(text);
      }
    }
    PrintEnd(arguments_.client.json, report.conforms(), report.total, report.focus_nodes,
             shapes::Summary(report, graph_.dictionary()));
    return report.conforms() ? kExitOk : kExitNegative;
  }

  const ValidateArguments& arguments_;
  sparql::FunctionRegistry functions_;
  shapes::FileGraph graph_;
  std::map<std::string, std::string> texts_;
};

absl::StatusOr<v1::ValidateRequest> ToRequest(const ValidateArguments& arguments) {
  v1::ValidateRequest request;
  request.set_timeout_ms(arguments.timeout_ms);
  request.set_rdf(arguments.rdf);
  for (const std::string& file : arguments.shapes) {
    auto rdf = ReadRdfToSend(file, arguments.base);
    if (!rdf.ok()) return rdf.status();
    v1::ShapesText* shapes = request.add_shapes();
    shapes->set_name(file);
    shapes->set_text(std::move(rdf->text));
    shapes->set_media_type(MediaTypeOf(rdf->format));
    shapes->set_base_iri(rdf->base_iri);
  }
  return request;
}

int ValidateServer(const ValidateArguments& arguments) {
  auto request = ToRequest(arguments);
  if (!request.ok()) return Fail(request.status());
  v1::ValidateReply reply;
  grpc::ClientContext context;
  grpc::Status status =
      v1::Ontologies::NewStub(Connect(arguments.client))->Validate(&context, *request, &reply);
  if (!status.ok()) return Fail(status, arguments.client);
  PrintDiagnostics(reply.diagnostics());
  if (arguments.rdf) {
    std::vector<TermQuad> quads;
    for (const v1::Quad& quad : reply.report()) {
      auto triple = FromProto(quad, "report", Limits());
      if (!triple.ok()) return Fail(triple.status());
      quads.push_back(*std::move(triple));
    }
    return PrintRdf(quads, reply.conforms());
  }
  for (const v1::ValidationResult& r : reply.results()) {
    const shapes::ResultText text = FromProto(r);
    if (arguments.client.json) {
      PrintResultJson(text);
    } else {
      std::cout << shapes::Render(text);
    }
  }
  PrintEnd(arguments.client.json, reply.conforms(), reply.total(), reply.focus_nodes(),
           absl::StrCat(reply.summary(), ", revision ", reply.revision()));
  return reply.conforms() ? kExitOk : kExitNegative;
}

}  // namespace

void AddValidateCommand(CLI::App* app, int* exit_code) {
  auto arguments = std::make_shared<ValidateArguments>();
  CLI::App* command =
      app->add_subcommand("validate", "Validate files, or the graph of the server, against SHACL shapes");
  command->group(kDocumentsGroup);
  AddClientOptions(command, &arguments->client);
  command->add_option(
      "data", arguments->data,
      "RDF files to validate, without a server. None: the server validates its graph, against --shapes "
      "or else the shapes of its ontology modules");
  command->add_option("--shapes", arguments->shapes, "RDF file with shapes; by default those of the data")
      ->type_name("FILE")
      ->allow_extra_args(false);
  AddBaseOption(command, &arguments->base);
  command->add_flag("--rdf", arguments->rdf, "Print the report as RDF: an sh:ValidationReport in Turtle");
  command->add_option("--timeout-ms,--timeout", arguments->timeout_ms, "Give up after this time")
      ->check(CLI::NonNegativeNumber)
      ->type_name("MS");
  command->footer(
      "Exit code 1: the data do not conform.\n"
      "Example:\n"
      "  docent validate hall.ttl --shapes shapes.ttl");
  command->callback([arguments, exit_code] {
    *exit_code = arguments->data.empty() ? ValidateServer(*arguments) : FileValidator(*arguments).Run();
  });
}

}  // namespace docent::server
