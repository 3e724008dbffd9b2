// docent load FILES: data, ontologies, rules, workflows and robot services into a running server.
#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "docent/v1/context.grpc.pb.h"
#include "docent/v1/ontologies.grpc.pb.h"
#include "docent/v1/robot_services.grpc.pb.h"
#include "docent/v1/workflows.grpc.pb.h"
#include "kb_server/app/client.h"
#include "kb_server/app/commands.h"
#include "kb_server/rdf/parser.h"

namespace docent {
namespace {

struct LoadArguments {
  ClientOptions client;
  std::vector<std::string> files;
  std::string as;      // data, ontology, rules, cawl, rsel; empty: by the file's ending
  std::string graph;   // data only
  std::string source;  // facts only
};

std::string KindOf(const std::string& file) {
  if (absl::EndsWith(file, ".rules")) return "rules";
  if (absl::EndsWith(file, ".cawl.xml") || absl::EndsWith(file, ".cawl")) return "cawl";
  if (absl::EndsWith(file, ".rsel.xml") || absl::EndsWith(file, ".rsel")) return "rsel";
  return "data";
}

std::string MediaTypeOfFile(const std::string& file) {
  switch (FormatOfFile(file).value_or(RdfFormat::kTurtle)) {
    case RdfFormat::kTurtle:
      return "text/turtle";
    case RdfFormat::kTriG:
      return "application/trig";
    case RdfFormat::kNTriples:
      return "application/n-triples";
    case RdfFormat::kNQuads:
      return "application/n-quads";
    case RdfFormat::kRdfXml:
      return "application/rdf+xml";
  }
  return "text/turtle";
}

void PrintWarnings(const google::protobuf::RepeatedPtrField<v1::Diagnostic>& diagnostics) {
  for (const v1::Diagnostic& d : diagnostics) {
    std::cerr << d.file() << ":" << d.line() << ":" << d.column() << ": "
              << (d.warning() ? "warning: " : "error: ") << d.message() << "\n";
    if (!d.hint().empty()) std::cerr << "  hint: " << d.hint() << "\n";
  }
}

class Loader {
 public:
  explicit Loader(const LoadArguments& arguments)
      : arguments_(arguments), channel_(Connect(arguments.client)) {}

  int Load(const std::string& file) {
    auto text = ReadText(file);
    if (!text.ok()) return Fail(text.status());
    std::string kind = arguments_.as.empty() ? KindOf(file) : arguments_.as;
    if (kind == "cawl") return Deploy(file, *text);
    if (kind == "rsel") return Register(file, *text);
    if (kind == "facts") return Assert(file, *text);
    return LoadModule(file, kind, *text);
  }

 private:
  int Deploy(const std::string& file, const std::string& text) {
    v1::DeployRequest request;
    request.set_name(file);
    request.set_cawl(text);
    v1::DeployReply reply;
    grpc::ClientContext context;
    grpc::Status status = v1::Workflows::NewStub(channel_)->Deploy(&context, request, &reply);
    if (!status.ok()) return Fail(status, arguments_.client);
    PrintWarnings(reply.diagnostics());
    std::cout << file << ": workflow " << reply.workflow() << " deployed, revision " << reply.revision()
              << "\n";
    return kExitOk;
  }

  int Register(const std::string& file, const std::string& text) {
    v1::RegisterRequest request;
    request.set_name(file);
    request.set_rsel(text);
    v1::RegisterReply reply;
    grpc::ClientContext context;
    grpc::Status status = v1::RobotServices::NewStub(channel_)->Register(&context, request, &reply);
    if (!status.ok()) return Fail(status, arguments_.client);
    PrintWarnings(reply.diagnostics());
    std::cout << file << ": robot services";
    for (const std::string& process : reply.processes()) std::cout << " " << process;
    std::cout << " registered, revision " << reply.revision() << "\n";
    return kExitOk;
  }

  // Facts as a robot or sensor would tell them: state properties replace.
  int Assert(const std::string& file, const std::string& text) {
    v1::AssertRequest request;
    request.set_rdf(text);
    request.set_rdf_media_type(MediaTypeOfFile(file));
    request.set_source(arguments_.source);
    v1::AssertReply reply;
    grpc::ClientContext context;
    grpc::Status status = v1::Context::NewStub(channel_)->Assert(&context, request, &reply);
    if (!status.ok()) return Fail(status, arguments_.client);
    std::cout << file << ": " << reply.added() << " added, " << reply.removed() << " removed, "
              << reply.inferred() << " inferred, revision " << reply.offset() << "\n";
    return kExitOk;
  }

  int LoadModule(const std::string& file, const std::string& kind, const std::string& text) {
    v1::LoadRequest request;
    request.set_name(file == "-" ? "stdin" : std::filesystem::path(file).filename().string());
    request.set_kind(kind == "rules"      ? v1::LoadRequest::RULES
                     : kind == "ontology" ? v1::LoadRequest::ONTOLOGY
                                          : v1::LoadRequest::DATA);
    request.set_text(text);
    request.set_media_type(MediaTypeOfFile(file));
    request.set_graph(arguments_.graph);
    v1::LoadReply reply;
    grpc::ClientContext context;
    grpc::Status status = v1::Ontologies::NewStub(channel_)->Load(&context, request, &reply);
    if (!status.ok()) return Fail(status, arguments_.client);
    PrintWarnings(reply.diagnostics());
    std::cout << file << ": " << kind << ", " << reply.added() << " added, " << reply.removed()
              << " removed, " << reply.inferred() << " inferred, revision " << reply.revision() << "\n";
    return kExitOk;
  }

  const LoadArguments& arguments_;
  std::shared_ptr<grpc::Channel> channel_;
};

}  // namespace

void AddLoadCommand(CLI::App* app, int* exit_code) {
  auto arguments = std::make_shared<LoadArguments>();
  CLI::App* command = app->add_subcommand("load",
                                          "Load files into a running server: RDF data, ontologies, .rules, "
                                          ".cawl.xml workflows, .rsel.xml services");
  AddClientOptions(command, &arguments->client);
  command->add_option("files", arguments->files, "Files, in this order; - is standard input")->required();
  command
      ->add_option(
          "--as", arguments->as,
          "What the files are, where the ending does not tell. facts: as a robot or sensor would tell them, "
          "a new value of a state property replaces the old one")
      ->check(CLI::IsMember({"data", "facts", "ontology", "rules", "cawl", "rsel"}));
  command->add_option("--graph", arguments->graph, "Data: the named graph to load into");
  command->add_option("--source", arguments->source, "Facts: IRI of who says it");
  command->callback([arguments, exit_code] {
    Loader loader(*arguments);
    for (const std::string& file : arguments->files) {
      *exit_code = loader.Load(file);
      if (*exit_code != kExitOk) return;
    }
  });
}

}  // namespace docent
