// docent load FILES: data, ontologies, rules, workflows and robot services into a running server.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <filesystem>
#include <iostream>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_split.h"
#include "docent/v1/context.grpc.pb.h"
#include "docent/v1/ontologies.grpc.pb.h"
#include "docent/v1/robot_services.grpc.pb.h"
#include "docent/v1/workflows.grpc.pb.h"
#include "graph/base/regular_file.h"
#include "graph/rdf/formats/parser.h"
#include "graph/rdf/formats/text_input.h"
#include "kb_server/cli/client.h"
#include "kb_server/cli/commands.h"
#include "kb_server/cli/display_width.h"
#include "kb_server/cli/fact_arguments.h"
#include "kb_server/cli/part_loader.h"
#include "kb_server/cli/presenter.h"
#include "kb_server/cli/terminal.h"
#include "nlohmann/json.hpp"

namespace docent::server {
namespace {

using ProtoDiagnostics = google::protobuf::RepeatedPtrField<v1::Diagnostic>;

struct LoadArguments {
  ClientOptions client;
  std::vector<std::string> files;
  std::string as;        // data, ontology, rules, cawl, rsel; empty: by the file's ending
  std::string graph;     // data only
  std::string source;    // facts only
  std::string format;    // of RDF, as an ending; empty: that of the file
  std::string base;      // of RDF; empty: the file's IRI
  bool replace = false;  // what the graph holds; data only
};

// Empty: its ending does not tell. Standard input has none, and is Turtle where no format is given.
std::string LoadKindOf(const std::string& packed_file, const std::string& format) {
  const std::string file(NameWithoutGz(packed_file));
  if (!format.empty()) return "data";
  if (absl::EndsWith(file, ".rules")) return "rules";
  if (absl::EndsWith(file, ".cawl.xml") || absl::EndsWith(file, ".cawl")) return "cawl";
  if (absl::EndsWith(file, ".rsel.xml") || absl::EndsWith(file, ".rsel")) return "rsel";
  return file == "-" || FormatOfFile(file) ? "data" : "";
}

class Loader {
 public:
  explicit Loader(const LoadArguments& arguments)
      : arguments_(arguments), channel_(Connect(arguments.client)) {}

  int Load(const std::string& file) {
    std::string kind = arguments_.as.empty() ? LoadKindOf(file, arguments_.format) : arguments_.as;
    if (kind.empty()) {
      if (absl::Status regular = CheckRegularFile(file); !regular.ok()) return Fail(regular);
      if (absl::Status unread = CheckFormatOfFile(file); !unread.ok()) return Fail(unread);
      return Fail(absl::InvalidArgumentError(
          absl::StrCat(file,
                       ": unknown file name extension; use .ttl .trig .nt .nq .rdf "
                       ".owl .xml .rules .cawl.xml or .rsel.xml, or say "
                       "with --format or --as what it is (with --as data alone, Turtle)")));
    }
    if (kind == "facts" && !arguments_.graph.empty()) {
      return Fail(absl::InvalidArgumentError(
          "facts lie in the graph of who says them; name that with --source, not with --graph"));
    }
    if (kind != "data" && kind != "facts" && !arguments_.graph.empty()) {
      return Fail(absl::InvalidArgumentError(
          absl::StrCat("--graph goes with data, and ", file, " is read as ", kind)));
    }
    if (kind != "data" && kind != "facts" && kind != "ontology" && !arguments_.format.empty()) {
      return Fail(absl::InvalidArgumentError(
          absl::StrCat("--format goes with RDF, and ", file, " is read as ", kind)));
    }
    if (arguments_.replace && kind != "data") {
      return Fail(absl::InvalidArgumentError(absl::StrCat(
          "--replace goes with data, and ", file, " is read as ", kind,
          kind == "facts" ? "" : "; what is loaded under the name of an earlier one replaces it anyway")));
    }
    if (kind != "facts" && !arguments_.source.empty()) {
      return Fail(absl::InvalidArgumentError(
          "--source says who tells facts; give --as facts, too, or --graph for data"));
    }
    if (kind == "cawl" || kind == "rsel" || kind == "rules") {
      if (!arguments_.base.empty())
        return Fail(absl::InvalidArgumentError(
            absl::StrCat("--base goes with RDF, and ", file, " is read as ", kind)));
      RdfText text;
      if (auto read = ReadText(file, kDocumentText); read.ok()) {
        text.text = *std::move(read);
      } else {
        return Fail(read.status());
      }
      if (kind == "cawl") return Deploy(file, text.text);
      if (kind == "rsel") return Register(file, text.text);
      return LoadModule(file, kind, text);
    }
    // Data goes in parts, other RDF in one piece.
    const TextLimit limit = kind == "data" && !arguments_.replace ? TextLimit() : kDocumentText;
    const auto rdf = ReadRdfToSend(file, arguments_.base, arguments_.format, limit);
    if (!rdf.ok()) return Fail(rdf.status());
    if (kind == "data" && rdf->text.size() > kPartBytes && !arguments_.replace)
      return LoadInParts(file, *rdf);
    if (kind == "facts") return Assert(file, *rdf);
    return LoadModule(file, kind, *rdf);
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
    if (arguments_.client.json) {
      return Report(
          {{"file", file}, {"kind", "cawl"}, {"workflow", reply.workflow()}, {"revision", reply.revision()}},
          reply.diagnostics());
    }
    PrintDiagnostics(Named(reply.diagnostics()));
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
    if (arguments_.client.json) {
      const std::vector<std::string> services(reply.processes().begin(), reply.processes().end());
      return Report(
          {{"file", file}, {"kind", "rsel"}, {"services", services}, {"revision", reply.revision()}},
          reply.diagnostics());
    }
    PrintDiagnostics(Named(reply.diagnostics()));
    std::cout << file << ": robot services";
    for (const std::string& process : reply.processes()) std::cout << " " << process;
    std::cout << " registered, revision " << reply.revision() << "\n";
    return kExitOk;
  }

  // Facts as a robot or sensor would tell them: state properties replace.
  int Assert(const std::string& file, const RdfText& rdf) {
    v1::AssertRequest request;
    request.set_rdf(rdf.text);
    request.set_rdf_media_type(MediaTypeOf(rdf.format));
    request.set_rdf_base_iri(rdf.base_iri);
    request.set_source(facts_.Iri(arguments_.source));
    v1::AssertReply reply;
    grpc::ClientContext context;
    grpc::Status status = v1::Context::NewStub(channel_)->Assert(&context, request, &reply);
    if (!status.ok()) return Fail(AtPath(status, "rdf", file), arguments_.client);
    return ReportChange(file, "facts", reply, reply.offset(), AtPath(reply.warnings(), "rdf", file));
  }

  // A large file: checked whole before anything of it is sent.
  int LoadInParts(const std::string& file, const RdfText& rdf) {
    const auto start = std::chrono::steady_clock::now();
    const auto document = CutDocument(rdf.text, rdf.format, file, kPartBytes, rdf.base_iri);
    if (HasErrors(document->diagnostics)) return Fail(ToStatus(document->diagnostics, rdf.text));
    const auto rate = [&](size_t bytes) {
      const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      const double share =
          document->bytes == 0 ? 1 : static_cast<double>(bytes) / static_cast<double>(document->bytes);
      return absl::StrFormat("%.0f statements/s",
                             share * static_cast<double>(document->statements) / seconds);
    };
    v1::LoadRequest request;
    request.set_name(NameOf(file));
    request.set_graph(facts_.Iri(arguments_.graph));
    const bool terminal = isatty(STDERR_FILENO) != 0;
    const PartsOutcome outcome = LoadParts(channel_, *document, request, [&](size_t bytes) {
      if (terminal) PrintProgress(absl::StrCat(ProgressBar(bytes, document->bytes), " ", rate(bytes), "   "));
    });
    if (terminal) std::cerr << "\n";
    if (!outcome.status.ok() || !arguments_.client.json) PrintDiagnostics(Named(outcome.warnings));
    if (!outcome.status.ok()) {
      std::cerr << file << ": " << outcome.parts << " of " << document->parts.size() << " parts are loaded ("
                << outcome.added << " statements were new); loading the file again adds the rest\n";
      return Fail(outcome.status, arguments_.client);
    }
    if (arguments_.client.json) {
      return Report({{"file", file},
                     {"kind", "data"},
                     {"added", outcome.added},
                     {"removed", outcome.removed},
                     {"inferred", outcome.inferred},
                     {"revision", outcome.revision},
                     {"parts", document->parts.size()}},
                    outcome.warnings);
    }
    std::cout << file << ": data, " << outcome.added << " added, " << outcome.removed << " removed, "
              << outcome.inferred << " inferred, revision " << outcome.revision << " ("
              << document->parts.size() << " parts, " << rate(document->bytes) << ")\n";
    return kExitOk;
  }

  // With IRIs named as elsewhere.
  ProtoDiagnostics Named(ProtoDiagnostics diagnostics) const {
    if (diagnostics.empty() || arguments_.client.full) return diagnostics;
    const IriNames names = ServerNames(arguments_.client);
    for (v1::Diagnostic& d : diagnostics) {
      d.set_message(names.InText(d.message()));
      d.set_hint(names.InText(d.hint()));
    }
    return diagnostics;
  }

  // As docent check --json writes them.
  static nlohmann::json Findings(const ProtoDiagnostics& diagnostics) {
    nlohmann::json findings = nlohmann::json::array();
    for (const v1::Diagnostic& d : diagnostics) {
      findings.push_back({{"file", d.file()},
                          {"line", d.line()},
                          {"column", d.column()},
                          {"severity", d.warning() ? "warning" : "error"},
                          {"rule", d.rule()},
                          {"message", d.message()},
                          {"hint", d.hint()}});
    }
    return findings;
  }

  static int Report(nlohmann::json object, const ProtoDiagnostics& diagnostics) {
    if (!diagnostics.empty()) object["findings"] = Findings(diagnostics);
    std::cout << PrintableJson(object.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)) << "\n";
    return kExitOk;
  }

  // What a reply says of facts.
  template <typename Reply>
  int ReportChange(const std::string& file, const std::string& kind, const Reply& reply, uint64_t revision,
                   const ProtoDiagnostics& diagnostics) const {
    if (arguments_.client.json) {
      return Report({{"file", file},
                     {"kind", kind},
                     {"added", reply.added()},
                     {"removed", reply.removed()},
                     {"inferred", reply.inferred()},
                     {"revision", revision}},
                    diagnostics);
    }
    PrintDiagnostics(Named(diagnostics));
    std::cout << (file == "-" ? NameOf(file) : file) << ": " << kind << ", " << reply.added() << " added, "
              << reply.removed() << " removed, " << reply.inferred() << " inferred, revision " << revision
              << "\n";
    return kExitOk;
  }

  static std::string NameOf(const std::string& file) {
    return file == "-" ? "stdin"
                       : std::string(NameWithoutGz(std::filesystem::path(file).filename().string()));
  }

  static std::string ProgressBar(size_t done, size_t all) {
    constexpr size_t kWidth = 30;
    const size_t filled = all == 0 ? kWidth : done * kWidth / all;
    return absl::StrCat("[", std::string(filled, '#'), std::string(kWidth - filled, '.'), "] ",
                        all == 0 ? 100 : done * 100 / all, " %");
  }

  // `rdf` is the text alone of rules.
  int LoadModule(const std::string& file, const std::string& kind, const RdfText& rdf) {
    v1::LoadRequest request;
    request.set_name(NameOf(file));
    request.set_kind(kind == "rules"      ? v1::LoadRequest::RULES
                     : kind == "ontology" ? v1::LoadRequest::ONTOLOGY
                                          : v1::LoadRequest::DATA);
    request.set_text(rdf.text);
    request.set_media_type(MediaTypeOf(rdf.format));
    request.set_base_iri(rdf.base_iri);
    request.set_graph(facts_.Iri(arguments_.graph));
    if (arguments_.replace) request.set_mode(v1::LoadRequest::REPLACE);
    v1::LoadReply reply;
    grpc::ClientContext context;
    grpc::Status status = v1::Ontologies::NewStub(channel_)->Load(&context, request, &reply);
    if (!status.ok()) return Fail(AtPath(status, NameOf(file), file), arguments_.client);
    return ReportChange(file, kind, reply, reply.revision(), AtPath(reply.diagnostics(), NameOf(file), file));
  }

  // The server knows a document by its name, which stands before the place of each mistake; here it is found by its path.
  static ProtoDiagnostics AtPath(ProtoDiagnostics diagnostics, const std::string& name,
                                 const std::string& file) {
    for (v1::Diagnostic& d : diagnostics)
      if (d.file() == name) d.set_file(file == "-" ? NameOf(file) : file);
    return diagnostics;
  }
  static grpc::Status AtPath(const grpc::Status& status, const std::string& known, const std::string& file) {
    const std::string name = absl::StrCat(known, ":");
    std::string message;
    for (const absl::string_view line : absl::StrSplit(status.error_message(), '\n')) {
      absl::StrAppend(&message, message.empty() ? "" : "\n");
      absl::StrAppend(&message, absl::StartsWith(line, name) ? absl::StrCat(file == "-" ? NameOf(file) : file,
                                                                            ":", line.substr(name.size()))
                                                             : std::string(line));
    }
    return grpc::Status(status.error_code(), message, status.error_details());
  }

  const LoadArguments& arguments_;
  std::shared_ptr<grpc::Channel> channel_;
  FactArguments facts_{[this] { return ServerNames(arguments_.client); }};
};

}  // namespace

void AddLoadCommand(CLI::App* app, int* exit_code) {
  auto arguments = std::make_shared<LoadArguments>();
  CLI::App* command = app->add_subcommand(
      "load", "Load RDF data, ontologies, rules, workflows and robot services from files");
  command->group(kDocumentsGroup);
  AddClientOptions(command, &arguments->client);
  command->add_option("files", arguments->files, "Files, loaded in this order; - is standard input")
      ->required();
  command
      ->add_option(
          "--as", arguments->as,
          "What the files are. By default the ending of the name tells: .rules, .cawl.xml, .rsel.xml, and "
          "data for RDF. facts are told as a robot or sensor tells them: a new value of a state property "
          "replaces the old one")
      ->check(CLI::IsMember({"data", "facts", "ontology", "rules", "cawl", "rsel"}));
  command
      ->add_option("--format", arguments->format,
                   "Syntax of RDF where the ending of the name does not tell it; with --as alone, and of "
                   "standard input, "
                   "Turtle")
      ->check(CLI::IsMember({"ttl", "trig", "nt", "nq", "rdf"}));
  AddBaseOption(command, &arguments->base);
  command->add_option("--graph", arguments->graph, "Named graph that data is loaded into")->type_name("IRI");
  command->add_flag(
      "--replace", arguments->replace,
      "Put the data of one file in the place of all that the graph of --graph holds, in one turn");
  command->add_option("--source", arguments->source, "Source that tells the facts (with --as facts)")
      ->type_name("IRI");
  command->footer(
      "Examples:\n"
      "  docent load hall.ttl guide.rules booth_guide.cawl.xml\n"
      "  docent load --graph https://example.org/hall --replace hall.ttl\n"
      "  docent load --as ontology place.ttl robot.ttl");
  command->callback([arguments, exit_code] {
    if (arguments->replace && (arguments->graph.empty() || arguments->files.size() != 1)) {
      *exit_code = Fail(absl::InvalidArgumentError(
          arguments->graph.empty() ? "--replace needs the graph that the data is for: --graph"
                                   : "--replace takes one file: each would replace the one before"));
      return;
    }
    Loader loader(*arguments);
    for (const std::string& file : arguments->files) {
      *exit_code = loader.Load(file);
      if (*exit_code != kExitOk) return;
    }
  });
}

}  // namespace docent::server
