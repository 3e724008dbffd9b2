// docent query 'SELECT …': a SPARQL query to a running server.
#include <algorithm>
#include <iostream>
#include <optional>

#include "docent/v1/context.grpc.pb.h"
#include "kb_server/app/client.h"
#include "kb_server/app/commands.h"
#include "kb_server/base/diagnostic.h"
#include "kb_server/rdf/serializer.h"
#include "kb_server/rdf/vocabulary.h"
#include "kb_server/service/convert.h"
#include "kb_server/sparql/results.h"

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
};

// Rows as an aligned table, printed when all are known.
class Table {
 public:
  explicit Table(std::vector<std::string> header) { rows_.push_back(std::move(header)); }
  void Add(std::vector<std::string> row) { rows_.push_back(std::move(row)); }

  void Print() const {
    std::vector<size_t> widths(rows_[0].size(), 0);
    for (const auto& row : rows_) {
      for (size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], Width(row[i]));
    }
    for (size_t r = 0; r < rows_.size(); ++r) {
      std::string line;
      for (size_t i = 0; i < rows_[r].size(); ++i) {
        line += rows_[r][i];
        if (i + 1 < rows_[r].size()) line += std::string(widths[i] - Width(rows_[r][i]) + 2, ' ');
      }
      std::cout << line << "\n";
      if (r > 0) continue;
      std::string rule;
      for (size_t i = 0; i < widths.size(); ++i) {
        rule += std::string(widths[i], '-') + (i + 1 < widths.size() ? "  " : "");
      }
      std::cout << rule << "\n";
    }
  }

 private:
  static size_t Width(const std::string& text) {
    return std::count_if(text.begin(), text.end(),
                         [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; });
  }
  std::vector<std::vector<std::string>> rows_;
};

std::optional<Term> Optional(const v1::Term& term) {
  if (term.kind_case() == v1::Term::KIND_NOT_SET) return std::nullopt;
  auto result = FromProto(term, "row");
  if (!result.ok()) return std::nullopt;
  return *result;
}

// Reads the stream and prints it in the asked form.
int PrintAnswer(grpc::ClientReader<v1::QueryReply>* reader, const QueryArguments& arguments) {
  auto format = sparql::ResultFormatOfName(arguments.format);
  v1::QueryReply reply;
  v1::QueryHeader header;
  std::optional<Table> table;
  std::string text;
  std::unique_ptr<sparql::ResultWriter> writer;
  std::vector<TermQuad> quads;
  size_t rows = 0;
  while (reader->Read(&reply)) {
    if (reply.has_header()) {
      header = reply.header();
      if (arguments.explain) {
        std::cout << header.plan();
        std::cerr << "revision " << header.revision() << "\n";
        continue;
      }
      std::vector<std::string> names(header.variables().begin(), header.variables().end());
      if (header.is_boolean()) continue;
      if (format) {
        writer = sparql::ResultWriter::Make(*format, &text);
        writer->Begin(names);
      } else {
        for (std::string& name : names) name.insert(0, "?");
        table.emplace(std::move(names));
      }
    } else if (reply.has_row()) {
      ++rows;
      std::vector<std::optional<Term>> terms;
      for (const v1::Term& term : reply.row().values()) terms.push_back(Optional(term));
      if (writer) {
        writer->Row(terms);
        std::cout << text;
        text.clear();
      } else {
        std::vector<std::string> cells;
        for (const auto& term : terms) cells.push_back(term ? OneLine(ToDisplay(*term), 120) : "");
        table->Add(std::move(cells));
      }
    } else if (reply.has_quad()) {
      if (auto quad = FromProto(reply.quad(), "triple"); quad.ok()) quads.push_back(*std::move(quad));
    }
  }
  if (header.is_boolean()) {
    std::cout << (format             ? sparql::WriteBoolean(header.boolean(), *format)
                  : header.boolean() ? "yes\n"
                                     : "no\n");
    return header.boolean() ? kExitOk : kExitNegative;
  }
  if (writer && header.variables_size() > 0) {
    writer->End();
    std::cout << text;
  } else if (!quads.empty()) {
    std::vector<std::pair<std::string, std::string>> prefixes(kWellKnownPrefixes.begin(),
                                                              kWellKnownPrefixes.end());
    auto turtle = SerializeRdf(quads, RdfFormat::kTurtle, prefixes);
    if (!turtle.ok()) return Fail(turtle.status());
    std::cout << *turtle;
  } else if (table && header.variables_size() > 0) {
    table->Print();
    std::cerr << rows << (rows == 1 ? " row" : " rows") << ", revision " << header.revision() << "\n";
  }
  return kExitOk;
}

int RunQuery(const QueryArguments& arguments) {
  std::string query = arguments.query;
  if (!arguments.file.empty()) {
    auto text = ReadText(arguments.file);
    if (!text.ok()) return Fail(text.status());
    query = *text;
  }
  if (query.empty())
    return Fail(absl::InvalidArgumentError("no query given; pass it as an argument or with --file"));
  auto stub = v1::Context::NewStub(Connect(arguments.client));
  grpc::ClientContext context;
  v1::QueryRequest request;
  request.set_query(query);
  request.set_timeout_ms(arguments.timeout_ms);
  request.set_explain(arguments.explain);
  request.set_as_of(arguments.as_of);
  auto reader = stub->Query(&context, request);
  int code = PrintAnswer(reader.get(), arguments);
  grpc::Status status = reader->Finish();
  return status.ok() ? code : Fail(status, arguments.client);
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
  command->add_option("--format", arguments->format, "json, csv, tsv or xml instead of a table")
      ->check(CLI::IsMember({"json", "csv", "tsv", "xml"}));
  command->add_option("--timeout-ms", arguments->timeout_ms,
                      "Give up after this time (default: the server's limit)");
  command->add_option("--as-of", arguments->as_of,
                      "Ask a past version: a revision number, or a time like 2026-01-31T12:00:00Z");
  command->add_flag("--explain", arguments->explain,
                    "Run it and print its plan instead: estimated and real rows and the time of each operator");
  command->callback([arguments, exit_code] {
    if (arguments->client.json && arguments->format.empty()) arguments->format = "json";
    *exit_code = RunQuery(*arguments);
  });
}

}  // namespace docent
