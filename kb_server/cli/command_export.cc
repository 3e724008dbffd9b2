// docent export: the graphs of a running server as RDF, in one revision, written as it comes.
#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <optional>

#include "absl/strings/str_cat.h"
#include "docent/v1/context.grpc.pb.h"
#include "graph/base/limits.h"
#include "graph/base/text.h"
#include "graph/rdf/formats/serializer.h"
#include "graph/rdf/vocabulary.h"
#include "graph/store/server_graphs.h"
#include "kb_server/cli/client.h"
#include "kb_server/cli/commands.h"
#include "kb_server/cli/fact_arguments.h"
#include "kb_server/cli/presenter.h"
#include "kb_server/grpc/convert.h"

namespace docent::server {
namespace {

struct ExportArguments {
  ClientOptions client;
  std::string graph;
  std::string format = "trig";
  bool inferred = false;
};

// Quads of Turtle and TriG that are sorted and written together.
constexpr size_t kPiece = 10000;

RdfFormat FormatOf(const std::string& name) {
  return name == "nq"    ? RdfFormat::kNQuads
         : name == "nt"  ? RdfFormat::kNTriples
         : name == "ttl" ? RdfFormat::kTurtle
                         : RdfFormat::kTriG;
}

// The graphs to which clients may add, and with `inferred` that of the rules.
std::string QueryText(const ExportArguments& arguments, const std::string& graph) {
  if (!graph.empty())
    return Concat("SELECT ?g ?s ?p ?o { VALUES ?g { ", ToNTriples(Term::Iri(graph)),
                  " } GRAPH ?g { ?s ?p ?o } }");
  std::string left_out = Concat(ToNTriples(Term::Iri(std::string(kRunsGraph))), ", ",
                                ToNTriples(Term::Iri(std::string(kDocumentsGraph))), ", ",
                                ToNTriples(Term::Iri(std::string(kClockGraph))), ", ",
                                ToNTriples(Term::Iri(std::string(kOperatorGraph))));
  if (!arguments.inferred) left_out += ", " + ToNTriples(Term::Iri(std::string(kInferredGraph)));
  return Concat("SELECT ?g ?s ?p ?o { GRAPH ?g { ?s ?p ?o } FILTER(?g NOT IN (", left_out,
                ") && !STRSTARTS(STR(?g), \"", kRunGraphs, "\")) }");
}

class Export {
 public:
  Export(RdfFormat format, PrefixList prefixes) : format_(format), prefixes_(std::move(prefixes)) {}

  void Add(const v1::Row& row) {
    TermQuad quad;
    Term* const parts[] = {&quad.graph, &quad.subject, &quad.predicate, &quad.object};
    for (int i = 0; i < 4 && i < row.values_size(); ++i)
      *parts[i] = FromProto(row.values(i)).value_or(Term());
    if (format_ == RdfFormat::kTurtle || format_ == RdfFormat::kNTriples) quad.graph = Term();
    piece_.push_back(std::move(quad));
    ++quads_;
    if (piece_.size() == kPiece) Write();
  }
  // Also where there was nothing to write.
  void End() { Write(); }
  size_t quads() const { return quads_; }

 private:
  void Write() {
    if (format_ == RdfFormat::kNTriples || format_ == RdfFormat::kNQuads) {
      std::cout << *SerializeRdf(std::move(piece_), format_);  // it has a form for every quad
    } else {
      if (!begun_) std::cout << DeclarePrefixesInTurtle(prefixes_);
      if (!piece_.empty()) std::cout << "\n" << SerializeTurtlePiece(std::move(piece_), prefixes_);
    }
    begun_ = true;
    piece_.clear();
  }

  const RdfFormat format_;
  const PrefixList prefixes_;
  std::vector<TermQuad> piece_;
  bool begun_ = false;
  size_t quads_ = 0;
};

int RunExport(const ExportArguments& arguments) {
  const RdfFormat format = FormatOf(arguments.format);
  if (arguments.graph.empty() && (format == RdfFormat::kTurtle || format == RdfFormat::kNTriples)) {
    return Fail(absl::InvalidArgumentError(
        absl::StrCat(arguments.format, " has no graphs; write trig or nq, or name one graph with --graph")));
  }
  FactArguments names([&] { return ServerNames(arguments.client); });
  const std::string graph = names.Iri(arguments.graph);
  grpc::ClientContext context;
  v1::QueryRequest request;
  request.set_query(QueryText(arguments, graph));
  request.set_default_graph(v1::QueryRequest::UNION);
  const auto stub = v1::Context::NewStub(Connect(arguments.client));
  const auto reader = stub->Query(&context, request);
  Export out(format, ServerNames(arguments.client).prefixes());
  v1::QueryReply reply;
  uint64_t revision = 0;
  while (reader->Read(&reply) && std::cout) {
    if (reply.has_header()) revision = reply.header().revision();
    if (reply.has_row()) out.Add(reply.row());
  }
  if (!std::cout) context.TryCancel();
  const grpc::Status status = reader->Finish();
  if (!std::cout) return kExitBad;  // said at the end of the program
  if (!status.ok()) {
    if (out.quads() > 0) std::cerr << "docent: the export ends too early: what is written is not whole\n";
    return Fail(status, arguments.client);
  }
  if (!graph.empty() && out.quads() == 0 && graph != kDefaultGraph) {
    return Fail(grpc::Status(grpc::StatusCode::NOT_FOUND,
                             absl::StrCat("there is no graph ", ToNTriples(Term::Iri(graph)),
                                          "; the graphs are: docent query "
                                          "'SELECT DISTINCT ?g { GRAPH ?g { ?s ?p ?o } }'")),
                arguments.client);
  }
  out.End();
  std::cerr << out.quads() << (out.quads() == 1 ? " fact" : " facts") << ", revision " << revision << "\n";
  return kExitOk;
}

}  // namespace

void AddExportCommand(CLI::App* app, int* exit_code) {
  auto arguments = std::make_shared<ExportArguments>();
  CLI::App* command =
      app->add_subcommand("export", "Write the graphs of the server as RDF, which docent load takes again");
  command->group(kDocumentsGroup);
  AddClientOptions(command, &arguments->client, /*json=*/false);
  command->add_option("--graph", arguments->graph, "One graph alone")->type_name("IRI");
  command
      ->add_option(
          "--format", arguments->format,
          "Syntax; ttl and nt hold one graph, and need --graph. trig and ttl use the prefixes that the "
          "server knows")
      ->check(CLI::IsMember({"trig", "nq", "ttl", "nt"}))
      ->capture_default_str();
  command->add_flag(
      "--inferred", arguments->inferred,
      "Also the facts that rules derive, in their graph docent:inferred, which docent load does not take");
  command->footer(
      "Left out are the graphs that only the server writes: inferred facts, runs and what they told, what "
      "operators say of robots, documents and times; --graph writes one of them. Lifetimes of facts are not "
      "kept. A backup (docent "
      "backup) has all.\n"
      "Examples:\n"
      "  docent export > all.trig\n"
      "  docent export --graph https://example.org/hall --format ttl > hall.ttl");
  command->callback([arguments, exit_code] { *exit_code = RunExport(*arguments); });
}

}  // namespace docent::server
