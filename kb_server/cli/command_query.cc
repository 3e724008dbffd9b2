// docent query 'SELECT …': a SPARQL query to a running server.
#include <iostream>
#include <optional>

#include "absl/strings/str_cat.h"
#include "docent/v1/context.grpc.pb.h"
#include "graph/rdf/formats/text_input.h"
#include "graph/sparql/syntax/parser.h"
#include "kb_server/cli/answer_printer.h"
#include "kb_server/cli/client.h"
#include "kb_server/cli/commands.h"
#include "kb_server/cli/display_width.h"
#include "kb_server/cli/presenter.h"
#include "kb_server/cli/query_with_rasqal.h"
#include "kb_server/grpc/convert.h"
#include "nlohmann/json.hpp"

namespace docent::server {
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
int PrintAnswer(grpc::ClientReader<v1::QueryReply>* reader, const QueryArguments& arguments,
                const Presenter& presenter) {
  AnswerPrinter printer(arguments.format, presenter);
  v1::QueryReply reply;
  uint64_t revision = 0;
  while (reader->Read(&reply)) {
    if (reply.has_header()) {
      const v1::QueryHeader& header = reply.header();
      revision = header.revision();
      if (arguments.explain) {
        if (arguments.format == "json") {
          std::cout << PrintableJson(nlohmann::json{{"revision", revision}, {"plan", header.plan()}}.dump())
                    << "\n";
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
      if (auto quad = FromProto(reply.quad(), "triple", Limits()); quad.ok())
        printer.Triple(*std::move(quad));
    }
  }
  const grpc::Status status = reader->Finish();
  if (status.ok()) return printer.End(revision);
  printer.BreakOff();
  return Fail(status, arguments.client);
}

sparql::ParsedQuery Parse(const std::string& query) {
  sparql::ParseOptions options;
  options.prefixes = sparql::WellKnownPrefixes();
  return sparql::ParseQuery(query, options);
}

// The formats hold rows and truth values. What does not parse is left to the server to say.
absl::Status CheckFormat(const sparql::ParsedQuery& parsed, const QueryArguments& arguments) {
  if (arguments.format.empty() || arguments.explain) return absl::OkStatus();
  const sparql::Query::Form form = parsed.query.form;
  if (!parsed.ok() || (form != sparql::Query::Form::kConstruct && form != sparql::Query::Form::kDescribe))
    return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat("the answer is triples, which ", arguments.format,
                   " cannot hold; without --format and --json they are printed as Turtle"));
}

// For a table or Turtle: the query's prefixes in front of the server's. The other formats hold whole IRIs.
Presenter PresenterFor(const sparql::ParsedQuery& parsed, const QueryArguments& arguments) {
  ClientOptions options = arguments.client;
  options.json = !arguments.format.empty() || arguments.explain;
  return Presenter(options, parsed.query.prefixes);
}

int RunQuery(const QueryArguments& arguments) {
  const auto query = GivenText("query", arguments.query, arguments.file, kQueryText);
  if (!query.ok()) return Fail(query.status());
  const sparql::ParsedQuery parsed = Parse(*query);
  if (absl::Status status = CheckFormat(parsed, arguments); !status.ok()) return Fail(status);
  if (arguments.explain && !arguments.format.empty() && arguments.format != "json")
    return Fail(absl::InvalidArgumentError(
        absl::StrCat("a plan is text, or json; leave --format ", arguments.format, " away")));
  if (arguments.engine == "rasqal") {
    if (arguments.explain)
      return Fail(absl::InvalidArgumentError("Rasqal explains no plans; leave --explain away"));
    if (!arguments.as_of.empty())
      return Fail(absl::InvalidArgumentError("Rasqal asks the newest graph; leave --as-of away"));
    return QueryWithRasqal(*query, arguments.client.server, arguments.format, PresenterFor(parsed, arguments),
                           arguments.timeout_ms);
  }
  auto stub = v1::Context::NewStub(Connect(arguments.client));
  grpc::ClientContext context;
  v1::QueryRequest request;
  request.set_query(*query);
  request.set_timeout_ms(arguments.timeout_ms);
  request.set_explain(arguments.explain);
  request.set_as_of(arguments.as_of);
  const auto reader = stub->Query(&context, request);
  return PrintAnswer(reader.get(), arguments, PresenterFor(parsed, arguments));
}

}  // namespace

void AddQueryCommand(CLI::App* app, int* exit_code) {
  auto arguments = std::make_shared<QueryArguments>();
  CLI::App* command = app->add_subcommand("query", "Query the graph in SPARQL");
  command->group(kGraphGroup);
  AddClientOptions(command, &arguments->client);
  AddShowOptions(command, &arguments->client);
  command->add_option(
      "query", arguments->query,
      "SPARQL SELECT, ASK, CONSTRUCT or DESCRIBE; prefixes that the server knows need no PREFIX");
  command->add_option("--file,-f", arguments->file, "Read the query from a file; - is standard input")
      ->type_name("FILE");
  command
      ->add_option(
          "--format", arguments->format,
          "Print a SPARQL result format instead of a table (SELECT, ASK). Triples are printed as Turtle")
      ->check(CLI::IsMember({"json", "csv", "tsv", "xml"}));
  command
      ->add_option("--timeout-ms", arguments->timeout_ms,
                   "Give up after this time; by default the server's limit")
      ->type_name("MS");
  command
      ->add_option(
          "--as-of", arguments->as_of,
          "Query a past version of the graph: a revision number, or a time such as 2026-01-31T12:00:00Z")
      ->check(
          [](const std::string& text) { return text.empty() ? std::string("it is empty") : std::string(); })
      ->type_name("REVISION|TIME");
  command->add_flag(
      "--explain", arguments->explain,
      "Run the query and print its plan: estimated and real rows and the time of each operator");
  command
      ->add_option(
          "--engine", arguments->engine,
          "Query engine. rasqal copies the graph and runs Redland's engine on it, for comparison; it refuses "
          "what that engine is known to get wrong")
      ->check(CLI::IsMember({"docent", "rasqal"}))
      ->capture_default_str();
  command->footer(
      "Exit code 1: the answer to ASK is no.\n"
      "Examples:\n"
      "  docent query 'SELECT ?robot ?place { ?robot a docent:Robot ; docent:isAt ?place }'\n"
      "  docent query --format csv -f report.rq --as-of 2026-01-31T12:00:00Z");
  command->callback([arguments, exit_code] {
    if (arguments->client.json && arguments->format.empty()) arguments->format = "json";
    *exit_code = RunQuery(*arguments);
  });
}

}  // namespace docent::server
