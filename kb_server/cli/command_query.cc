// docent query 'SELECT …': a SPARQL query to a running server.
#include <iostream>
#include <optional>

#include "absl/strings/str_cat.h"
#include "docent/v1/context.grpc.pb.h"
#include "graph/rdf/text_input.h"
#include "graph/sparql/syntax/parser.h"
#include "kb_server/cli/answer_printer.h"
#include "kb_server/cli/client.h"
#include "kb_server/cli/commands.h"
#include "kb_server/cli/query_with_rasqal.h"
#include "kb_server/grpc/convert.h"
#include "nlohmann/json.hpp"

namespace docent {
namespace {

struct QueryArguments {
  ClientOptions client;
  std::string query;
  std::string file;
  std::string format;
  std::string as_of;
  uint32_t timeout_ms = 0;
  bool explain = false;
  std::string engine = "docent";
};

// Reads the stream and prints it in the asked form. The exit code.
int PrintAnswer(grpc::ClientReader<v1::QueryReply>* reader, const QueryArguments& arguments) {
  AnswerPrinter printer(arguments.format);
  v1::QueryReply reply;
  uint64_t revision = 0;
  while (reader->Read(&reply)) {
    if (reply.has_header()) {
      const v1::QueryHeader& header = reply.header();
      revision = header.revision();
      if (arguments.explain) {
        if (arguments.format == "json") {
          std::cout << nlohmann::json{{"revision", revision}, {"plan", header.plan()}}.dump() << "\n";
          continue;
        }
        std::cout << header.plan();
        std::cerr << "revision " << revision << "\n";
      } else if (header.is_boolean()) {
        printer.Boolean(header.boolean());
      } else {
        printer.Begin({header.variables().begin(), header.variables().end()});
      }
    } else if (reply.has_row()) {
      std::vector<std::optional<Term>> terms;
      for (const v1::Term& term : reply.row().values()) terms.push_back(FromProto(term));
      printer.Row(terms);
    } else if (reply.has_quad()) {
      if (auto quad = FromProto(reply.quad(), "triple"); quad.ok()) printer.Triple(*std::move(quad));
    }
  }
  const grpc::Status status = reader->Finish();
  if (status.ok()) return printer.End(revision);
  printer.BreakOff();
  return Fail(status, arguments.client);
}

// The formats hold rows and truth values. What does not parse is left to the server to say.
absl::Status CheckFormat(const std::string& query, const QueryArguments& arguments) {
  if (arguments.format.empty() || arguments.explain) return absl::OkStatus();
  sparql::ParseOptions options;
  options.prefixes = sparql::WellKnownPrefixes();
  const sparql::ParsedQuery parsed = sparql::ParseQuery(query, options);
  const sparql::Query::Form form = parsed.query.form;
  if (!parsed.ok() || (form != sparql::Query::Form::kConstruct && form != sparql::Query::Form::kDescribe))
    return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat("the answer is triples, which ", arguments.format,
                   " cannot hold; without --format and --json they are printed as Turtle"));
}

int RunQuery(const QueryArguments& arguments) {
  const auto query = GivenText("query", arguments.query, arguments.file);
  if (!query.ok()) return Fail(query.status());
  if (absl::Status status = CheckFormat(*query, arguments); !status.ok()) return Fail(status);
  if (arguments.explain && !arguments.format.empty() && arguments.format != "json")
    return Fail(absl::InvalidArgumentError(
        absl::StrCat("a plan is text, or json; leave --format ", arguments.format, " away")));
  if (arguments.engine == "rasqal") {
    if (arguments.explain)
      return Fail(absl::InvalidArgumentError("Rasqal explains no plans; leave --explain away"));
    if (!arguments.as_of.empty())
      return Fail(absl::InvalidArgumentError("Rasqal asks the newest graph; leave --as-of away"));
    return QueryWithRasqal(*query, arguments.client.server, arguments.format, arguments.timeout_ms);
  }
  auto stub = v1::Context::NewStub(Connect(arguments.client));
  grpc::ClientContext context;
  v1::QueryRequest request;
  request.set_query(*query);
  request.set_timeout_ms(arguments.timeout_ms);
  request.set_explain(arguments.explain);
  request.set_as_of(arguments.as_of);
  return PrintAnswer(stub->Query(&context, request).get(), arguments);
}

}  // namespace

void AddQueryCommand(CLI::App* app, int* exit_code) {
  auto arguments = std::make_shared<QueryArguments>();
  CLI::App* command =
      app->add_subcommand("query", "Ask the live graph in SPARQL (exit code 1: ASK is false)");
  AddClientOptions(command, &arguments->client);
  command->add_option("query", arguments->query,
                      "SPARQL SELECT, ASK or CONSTRUCT; well-known prefixes need no PREFIX");
  command->add_option("--file,-f", arguments->file, "Read the query from a file, - for standard input");
  command
      ->add_option("--format", arguments->format,
                   "json, csv, tsv or xml instead of a table (SELECT, ASK); triples are printed as Turtle")
      ->check(CLI::IsMember({"json", "csv", "tsv", "xml"}));
  command->add_option("--timeout-ms", arguments->timeout_ms,
                      "Give up after this time (default: the server's limit)");
  command
      ->add_option("--as-of", arguments->as_of,
                   "Ask a past version: a revision number, or a time like 2026-01-31T12:00:00Z")
      ->check(
          [](const std::string& text) { return text.empty() ? std::string("it is empty") : std::string(); });
  command->add_flag(
      "--explain", arguments->explain,
      "Run it and print its plan instead: estimated and real rows and the time of each operator");
  command
      ->add_option(
          "--engine", arguments->engine,
          "rasqal: copy the graph and ask Redland's engine, for comparing; what it cannot do it refuses")
      ->check(CLI::IsMember({"docent", "rasqal"}))
      ->capture_default_str();
  command->callback([arguments, exit_code] {
    if (arguments->client.json && arguments->format.empty()) arguments->format = "json";
    *exit_code = RunQuery(*arguments);
  });
}

}  // namespace docent
