#include "kb_server/http/http_query.h"

#include <optional>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "graph/rdf/text_bytes.h"
#include "graph/sparql/results/results.h"
#include "graph/sparql/run/describe.h"
#include "graph/sparql/run/evaluator.h"
#include "graph/sparql/run/federation.h"
#include "graph/sparql/syntax/parser.h"
#include "kb_server/door/history_port.h"
#include "kb_server/http/http_formats.h"
#include "kb_server/http/long_answer.h"
#include "kb_server/work/remote_access.h"

namespace docent::server {
namespace {

constexpr size_t kCopies = 4;  // of a row on its way: as terms, as text, with its connection, as what is sent

// One query on a worker thread.
class QueryAnswer {
 public:
  QueryAnswer(const ServicePorts& ports, SparqlRequest request, std::shared_ptr<HttpExchange> exchange,
              Cancellation* cancellation)
      : ports_(ports),
        request_(std::move(request)),
        exchange_(std::move(exchange)),
        cancellation_(*cancellation) {}

  // Answers the exchange, whatever happens. The status that the answer has.
  int Run() {
    const absl::Status status = Evaluate();
    if (!status.ok() && exchange_->begun()) {
      exchange_->Abort();
    } else if (!status.ok()) {
      Respond(ErrorResponse(status)).IgnoreError();
    }
    return status_;
  }

 private:
  absl::Status Evaluate() {
    sparql::ParseOptions parse_options = sparql::ParseOptionsWith(ports_.limits, ports_.functions);
    parse_options.base_iri = request_.base_iri;
    sparql::ParsedQuery parsed = sparql::ParseQuery(request_.text, parse_options);
    if (!parsed.ok()) return ToStatus(parsed.diagnostics, request_.text);
    if (!request_.default_graphs.empty() || !request_.named_graphs.empty()) {
      parsed.query.from = request_.default_graphs;
      parsed.query.from_named = request_.named_graphs;
    }
    auto graph = GraphForQuery(ports_, request_.min_revision, request_.as_of,
                               absl::Now() + absl::Milliseconds(request_.timeout_ms), &cancellation_);
    if (!graph.ok()) return graph.status();
    graph_ = *std::move(graph);

    sparql::PrepareOptions options;
    options.default_graph = ports_.default_graph;
    options.functions = ports_.functions;
    options.memory_bytes = ports_.limits.query_memory_bytes;
    options.all_memory = ports_.query_memory;
    run_options_.version = graph_.version.get();
    run_options_.cancellation = &cancellation_;
    run_options_.now_us = ports_.clock->Now();
    run_options_.seed = static_cast<uint64_t>(run_options_.now_us);
    absl::Status resolved =
        sparql::ResolveServices(&parsed.query, ports_.remote, *graph_.dictionary, options, run_options_);
    if (!resolved.ok()) return resolved;
    const WorkerPool::SharedWork shared(ports_.workers, &cancellation_);
    auto prepared = sparql::PreparedQuery::Prepare(parsed.query, *graph_.dictionary, options);
    if (!prepared.ok()) return prepared.status();
    switch (parsed.query.form) {
      case sparql::Query::Form::kAsk:
        return Ask(**prepared);
      case sparql::Query::Form::kSelect:
        return Select(**prepared);
      default:
        return Graph(**prepared, parsed.query, options);
    }
  }

  absl::Status Ask(sparql::PreparedQuery& query) {
    const RowType* type = ChooseRowType(exchange_->request().Header("accept"));
    if (type == nullptr) return Respond(NoRowType());
    const absl::StatusOr<bool> answer = query.Ask(run_options_);
    if (!answer.ok()) return answer.status();
    return Respond(Head(type->told, sparql::WriteBoolean(*answer, type->format)));
  }

  absl::Status Select(sparql::PreparedQuery& query) {
    const RowType* type = ChooseRowType(exchange_->request().Header("accept"));
    if (type == nullptr) return Respond(NoRowType());
    LongAnswer answer(Head(type->told), exchange_.get(), ports_.workers);
    std::string rows;
    const std::unique_ptr<sparql::ResultWriter> writer = sparql::ResultWriter::Make(type->format, &rows);
    writer->Begin(query.variables());
    std::vector<std::optional<Term>> terms(query.variables().size());
    bool gone = false;
    size_t longest = 0;  // row, in bytes of text
    const absl::Status status = query.Select(run_options_, {}, [&](absl::Span<const TermId> row) {
      size_t bytes = 0;
      for (size_t i = 0; i < terms.size(); ++i) {
        if (row[i].IsNone()) {
          terms[i].reset();
        } else {
          query.DecodeTo(row[i], terms[i] ? &*terms[i] : &terms[i].emplace());
          bytes += TextBytes(*terms[i]);
        }
        if (bytes > longest && !query.Charge(kCopies * (bytes - std::exchange(longest, bytes)))) return false;
      }
      writer->Row(terms);
      gone = rows.size() >= LongAnswer::kPieceBytes && !answer.Send(&rows);
      return !gone;
    });
    if (!status.ok()) return status;
    if (gone) return absl::CancelledError("the client went away");
    writer->End();
    answer.End(std::move(rows));
    return absl::OkStatus();
  }

  absl::Status Graph(sparql::PreparedQuery& prepared, const sparql::Query& query,
                     const sparql::PrepareOptions& options) {
    const std::string accept = exchange_->request().Header("accept");
    if (ChooseGraphType(accept) == nullptr) return Respond(NoGraphType());
    absl::StatusOr<std::vector<TermQuad>> triples =
        sparql::AnswerGraph(prepared, query, *graph_.dictionary, options, run_options_);
    if (!triples.ok()) return triples.status();
    GraphText answer = WriteGraph(*std::move(triples), accept, query.prefixes);
    if (answer.refusal) return Respond(*std::move(answer.refusal));
    return LongAnswer(Head(answer.told), exchange_.get(), ports_.workers)
        .SendAll(std::move(answer.text), &cancellation_);
  }

  HttpResponse Head(std::string_view content_type, std::string body = "") const {
    HttpResponse response;
    response.content_type = content_type;
    response.body = std::move(body);
    response.headers = {{"Docent-Revision", absl::StrCat(graph_.version->revision().value())},
                        {"Cache-Control", "no-cache"},
                        {"Vary", "Accept"}};
    return response;
  }

  absl::Status Respond(HttpResponse response) {
    status_ = response.status;
    exchange_->Respond(std::move(response));
    return absl::OkStatus();
  }

  const ServicePorts& ports_;
  const SparqlRequest request_;
  const std::shared_ptr<HttpExchange> exchange_;
  Cancellation& cancellation_;
  QueryGraph graph_;
  sparql::RunOptions run_options_;
  int status_ = 200;
};

}  // namespace

int AnswerQuery(const ServicePorts& ports, const SparqlRequest& request,
                std::shared_ptr<HttpExchange> exchange, Cancellation* cancellation) {
  return QueryAnswer(ports, request, std::move(exchange), cancellation).Run();
}

}  // namespace docent::server
