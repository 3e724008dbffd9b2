#include "kb_server/service/http_sparql.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <utility>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "kb_server/base/text.h"
#include "kb_server/rdf/serializer.h"
#include "kb_server/sparql/evaluator.h"
#include "kb_server/sparql/parser.h"
#include "kb_server/sparql/results.h"

namespace docent {
namespace {

constexpr size_t kFlushBytes = 64u << 10;  // of rows, sent together

struct SparqlRequest {
  std::string query;
  std::vector<Term> default_graphs;
  std::vector<Term> named_graphs;
  int timeout_ms = 0;
  Revision min_revision;
};

// A refusal, or the request.
struct ReadRequest {
  std::optional<HttpResponse> refusal;
  SparqlRequest request;
};

ReadRequest Refused(int status, std::string text) {
  ReadRequest read;
  read.refusal = TextResponse(status, std::move(text));
  return read;
}

ReadRequest ReadParameters(const HttpFields& parameters, std::optional<std::string> body_query,
                           const Limits& limits) {
  ReadRequest read;
  read.request.timeout_ms = limits.query_timeout_ms;
  int queries = 0;
  if (body_query) {
    read.request.query = *std::move(body_query);
    ++queries;
  }
  for (const auto& [name, value] : parameters) {
    uint64_t number = 0;
    if (name == "query") {
      read.request.query = value;
      ++queries;
    } else if (name == "default-graph-uri" || name == "named-graph-uri") {
      if (value.find(':') == std::string::npos)
        return Refused(400, name + " must be an absolute IRI, not \"" + value + "\"");
      auto& graphs = name == "default-graph-uri" ? read.request.default_graphs : read.request.named_graphs;
      graphs.push_back(Term::Iri(value));
    } else if (name == "timeout") {
      if (!absl::SimpleAtoi(value, &number) || number == 0) {
        return Refused(400, "timeout must be a whole number of milliseconds, not \"" + value + "\"");
      }
      read.request.timeout_ms = static_cast<int>(std::min<uint64_t>(number, limits.query_timeout_ms));
    } else if (name == "min-revision") {
      if (!absl::SimpleAtoi(value, &number)) {
        return Refused(400, "min-revision must be a revision number, not \"" + value + "\"");
      }
      read.request.min_revision = Revision(number);
    } else if (name == "as-of") {
      return Refused(501, "as-of is not supported: only the newest version can be queried");
    } else if (name == "update") {
      return Refused(400, "this address answers queries; it does not take updates");
    }
  }
  if (queries == 0)
    return Refused(400, "give a query: GET /sparql?query=… or POST it as application/sparql-query");
  if (queries > 1) return Refused(400, "give one query, not several");
  if (read.request.query.size() > limits.query_text_bytes) {
    return Refused(413, absl::StrCat("the query has ", read.request.query.size(),
                                     " bytes; the limit query_text_bytes is ", limits.query_text_bytes));
  }
  return read;
}

ReadRequest Read(const HttpRequest& http, const Limits& limits) {
  if (http.method != "POST") return ReadParameters(http.parameters, std::nullopt, limits);
  const std::string type = MediaTypeOnly(http.Header("content-type"));
  if (type == "application/sparql-query") return ReadParameters(http.parameters, http.body, limits);
  if (type != "application/x-www-form-urlencoded") {
    return Refused(415, "POST a query as application/sparql-query or application/x-www-form-urlencoded" +
                            (type.empty() ? std::string() : ", not as " + type));
  }
  std::optional<HttpFields> form = ParseForm(http.body);
  if (!form) return Refused(400, "the form has a broken %-escape");
  form->insert(form->end(), http.parameters.begin(), http.parameters.end());
  return ReadParameters(*form, std::nullopt, limits);
}

struct RowType {
  std::string_view asked;  // in Accept
  std::string_view told;   // as Content-Type
  sparql::ResultFormat format;
};
constexpr std::array<RowType, 7> kRowTypes = {{
    {"application/sparql-results+json", "application/sparql-results+json", sparql::ResultFormat::kJson},
    {"application/json", "application/json", sparql::ResultFormat::kJson},
    {"application/sparql-results+xml", "application/sparql-results+xml", sparql::ResultFormat::kXml},
    {"text/csv", "text/csv; charset=utf-8", sparql::ResultFormat::kCsv},
    {"text/tab-separated-values", "text/tab-separated-values; charset=utf-8", sparql::ResultFormat::kTsv},
    {"application/xml", "application/xml", sparql::ResultFormat::kXml},
    {"text/xml", "text/xml; charset=utf-8", sparql::ResultFormat::kXml},
}};

struct GraphType {
  std::string_view asked;
  std::string_view told;
  RdfFormat format;
};
constexpr std::array<GraphType, 4> kGraphTypes = {{
    {"text/turtle", "text/turtle; charset=utf-8", RdfFormat::kTurtle},
    {"application/n-triples", "application/n-triples", RdfFormat::kNTriples},
    {"application/rdf+xml", "application/rdf+xml", RdfFormat::kRdfXml},
    {"text/plain", "text/plain; charset=utf-8", RdfFormat::kNTriples},
}};

// The entry of `types` that fits Accept; null if none.
template <typename Types>
const typename Types::value_type* Choose(const Types& types, const std::string& accept) {
  std::vector<std::string_view> offered;
  for (const auto& type : types) offered.push_back(type.asked);
  const std::optional<size_t> chosen = ChooseMediaType(accept, offered);
  return chosen ? &types[*chosen] : nullptr;
}

template <typename Types>
HttpResponse NotAcceptable(const Types& types) {
  std::string offered;
  for (const auto& type : types) offered.append(offered.empty() ? "" : ", ").append(type.asked);
  return TextResponse(406, "this answer can be had as " + offered);
}

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
    if (!status.ok() && begun_) {
      exchange_->Abort();
    } else if (!status.ok()) {
      Respond(ErrorResponse(status)).IgnoreError();
    }
    return status_;
  }

 private:
  absl::Status Evaluate() {
    sparql::ParseOptions parse_options;
    parse_options.prefixes = sparql::WellKnownPrefixes();
    parse_options.limits = ports_.limits;
    sparql::ParsedQuery parsed = sparql::ParseQuery(request_.query, parse_options);
    if (!parsed.ok()) return ToStatus(parsed.diagnostics, request_.query);
    if (!request_.default_graphs.empty() || !request_.named_graphs.empty()) {
      parsed.query.from = request_.default_graphs;
      parsed.query.from_named = request_.named_graphs;
    }
    if (absl::Status status = FindVersion(); !status.ok()) return status;

    sparql::PrepareOptions options;
    options.default_graph = ports_.default_graph;
    options.functions = ports_.functions;
    options.memory_bytes = ports_.limits.query_memory_bytes;
    auto prepared = sparql::PreparedQuery::Prepare(parsed.query, *ports_.dictionary, options);
    if (!prepared.ok()) return prepared.status();
    run_options_.version = version_.get();
    run_options_.cancellation = &cancellation_;
    run_options_.now_us = ports_.clock->Now();
    run_options_.seed = static_cast<uint64_t>(run_options_.now_us);
    switch (parsed.query.form) {
      case sparql::Query::Form::kAsk:
        return Ask(**prepared);
      case sparql::Query::Form::kSelect:
        return Select(**prepared);
      default:
        return Graph(**prepared, parsed.query.prefixes);
    }
  }

  // The newest version that is at least min-revision; others are served while it is not there.
  absl::Status FindVersion() {
    version_ = ports_.queries->Newest();
    if (version_->revision() >= request_.min_revision) return absl::OkStatus();
    WorkerPool::Waiting waiting(ports_.workers);
    auto version = ports_.queries->WaitForRevision(
        request_.min_revision, absl::Now() + absl::Milliseconds(request_.timeout_ms), &cancellation_);
    if (!version.ok()) return version.status();
    version_ = *std::move(version);
    return absl::OkStatus();
  }

  absl::Status Ask(sparql::PreparedQuery& query) {
    const RowType* type = Choose(kRowTypes, exchange_->request().Header("accept"));
    if (type == nullptr) return Respond(NotAcceptable(kRowTypes));
    const absl::StatusOr<bool> answer = query.Ask(run_options_);
    if (!answer.ok()) return answer.status();
    return Respond(Head(type->told, sparql::WriteBoolean(*answer, type->format)));
  }

  absl::Status Select(sparql::PreparedQuery& query) {
    const RowType* type = Choose(kRowTypes, exchange_->request().Header("accept"));
    if (type == nullptr) return Respond(NotAcceptable(kRowTypes));
    std::string rows;
    const std::unique_ptr<sparql::ResultWriter> writer = sparql::ResultWriter::Make(type->format, &rows);
    writer->Begin(query.variables());
    std::vector<std::optional<Term>> terms(query.variables().size());
    bool gone = false;
    const absl::Status status = query.Select(run_options_, {}, [&](absl::Span<const TermId> row) {
      for (size_t i = 0; i < terms.size(); ++i) {
        terms[i] = row[i].IsNone() ? std::nullopt : std::optional<Term>(query.Decode(row[i]));
      }
      writer->Row(terms);
      if (rows.size() >= kFlushBytes) {
        gone = !Flush(type->told, &rows);
      }
      return !gone;
    });
    if (!status.ok()) return status;
    if (gone) return absl::CancelledError("the client went away");
    writer->End();
    if (!begun_) return Respond(Head(type->told, std::move(rows)));
    Flush(type->told, &rows);
    exchange_->End();
    return absl::OkStatus();
  }

  absl::Status Graph(sparql::PreparedQuery& query,
                     const std::vector<std::pair<std::string, std::string>>& prefixes) {
    const GraphType* type = Choose(kGraphTypes, exchange_->request().Header("accept"));
    if (type == nullptr) return Respond(NotAcceptable(kGraphTypes));
    const absl::StatusOr<std::vector<TermQuad>> triples = query.Construct(run_options_);
    if (!triples.ok()) return triples.status();
    absl::StatusOr<std::string> text = SerializeRdf(*triples, type->format, prefixes);
    if (!text.ok()) return text.status();
    return Respond(Head(type->told, *std::move(text)));
  }

  HttpResponse Head(std::string_view content_type, std::string body) const {
    HttpResponse response;
    response.content_type = content_type;
    response.body = std::move(body);
    response.headers = {{"Docent-Revision", absl::StrCat(version_->revision().value())},
                        {"Cache-Control", "no-cache"}};
    return response;
  }

  absl::Status Respond(HttpResponse response) {
    status_ = response.status;
    exchange_->Respond(std::move(response));
    return absl::OkStatus();
  }

  // Sends the rows so far; false if the client has gone. Others are served while a slow client is waited for.
  bool Flush(std::string_view content_type, std::string* rows) {
    bool there = true;
    std::optional<WorkerPool::Waiting> waiting;
    if (exchange_->full()) waiting.emplace(ports_.workers);
    if (begun_) {
      there = exchange_->Write(*rows);
    } else {
      exchange_->Begin(Head(content_type, *rows));
      begun_ = true;
    }
    rows->clear();
    return there;
  }

  const ServicePorts& ports_;
  const SparqlRequest request_;
  const std::shared_ptr<HttpExchange> exchange_;
  Cancellation& cancellation_;
  GraphVersionPtr version_;
  sparql::RunOptions run_options_;
  bool begun_ = false;  // part of the answer is sent
  int status_ = 200;
};

struct SparqlMetrics {
  explicit SparqlMetrics(Metrics* metrics)
      : seconds(metrics->AddHistogram("docent_sparql_seconds",
                                      "Time from request to whole answer of HTTP queries.",
                                      Metrics::LatencyBounds())),
        ok(metrics->AddCounter("docent_sparql_requests_total", "HTTP queries by outcome.",
                               {{"outcome", "answered"}})),
        failed(metrics->AddCounter("docent_sparql_requests_total", "HTTP queries by outcome.",
                                   {{"outcome", "refused"}})) {}

  Histogram& seconds;
  Counter& ok;
  Counter& failed;
};

void Handle(const ServicePorts& ports, SparqlMetrics metrics, std::shared_ptr<HttpExchange> exchange) {
  const auto start = std::chrono::steady_clock::now();
  ReadRequest read = Read(exchange->request(), ports.limits);
  if (read.refusal) {
    metrics.failed.Add();
    exchange->Respond(*std::move(read.refusal));
    return;
  }
  auto cancellation = std::make_shared<Cancellation>(std::chrono::milliseconds(read.request.timeout_ms));
  exchange->OnGone([cancellation] { cancellation->Cancel(); });
  const bool accepted = ports.workers->Submit([&ports, metrics, start, exchange, cancellation,
                                               request = std::move(read.request)] {
    const int status = QueryAnswer(ports, request, exchange, cancellation.get()).Run();
    (status == 200 ? metrics.ok : metrics.failed).Add();
    metrics.seconds.Observe(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  });
  if (!accepted) {
    metrics.failed.Add();
    HttpResponse busy = TextResponse(503, "too many queries wait; try again");
    busy.headers.emplace_back("Retry-After", "1");
    exchange->Respond(std::move(busy));
  }
}

}  // namespace

void AddSparqlRoutes(HttpRoutes* routes, const ServicePorts* ports, Metrics* metrics) {
  const SparqlMetrics counts(metrics);
  for (const char* method : {"GET", "POST"}) {
    routes->Add(method, "/sparql", [ports, counts](std::shared_ptr<HttpExchange> exchange) {
      Handle(*ports, counts, std::move(exchange));
    });
  }
}

}  // namespace docent
