#include "kb_server/http/http_sparql.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "graph/base/diagnostic.h"
#include "graph/rdf/text_bytes.h"
#include "graph/sparql/syntax/parser.h"
#include "kb_server/door/await_version.h"
#include "kb_server/door/query_memory.h"
#include "kb_server/door/request_memory.h"
#include "kb_server/http/http_guard.h"
#include "kb_server/http/http_query.h"
#include "kb_server/http/http_sparql_request.h"
#include "kb_server/http/service_description.h"
#include "kb_server/work/known_prefixes.h"
#include "kb_server/work/outcome_json.h"
#include "kb_server/work/update_runner.h"

namespace docent::server {
namespace {

using Kind = SparqlRequest::Kind;

struct SparqlMetrics {
  explicit SparqlMetrics(Metrics* metrics)
      : seconds(metrics->AddHistogram("docent_sparql_seconds",
                                      "Time from request to whole answer of HTTP queries and updates.",
                                      Metrics::LatencyBounds())),
        ok(metrics->AddCounter("docent_sparql_requests_total", "HTTP queries and updates by outcome.",
                               {{"outcome", "answered"}})),
        failed(metrics->AddCounter("docent_sparql_requests_total", "HTTP queries and updates by outcome.",
                                   {{"outcome", "refused"}})) {}

  Histogram& seconds;
  Counter& ok;
  Counter& failed;
};

// Counts one request when it is answered.
class Measured {
 public:
  explicit Measured(const SparqlMetrics& metrics) : metrics_(metrics) {}
  void Answered(int status) const {
    (status < 300 ? metrics_.ok : metrics_.failed).Add();
    metrics_.seconds.Observe(
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count());
  }

 private:
  SparqlMetrics metrics_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

void Respond(const std::shared_ptr<HttpExchange>& exchange, const Measured& measured, HttpResponse response) {
  measured.Answered(response.status);
  exchange->Respond(std::move(response));
}

// The data set that the protocol's parameters give (protocol, section 2.2.3).
absl::Status SetUsing(const SparqlRequest& request, sparql::Update* update, MemoryUse* memory) {
  if (request.default_graphs.empty() && request.named_graphs.empty()) return absl::OkStatus();
  size_t bytes = 0;
  for (const Term& graph : request.default_graphs) bytes += sizeof(Term) + TextBytes(graph);
  for (const Term& graph : request.named_graphs) bytes += sizeof(Term) + TextBytes(graph);
  for (sparql::UpdateOperation& operation : update->operations) {
    if (operation.with || !operation.from.empty() || !operation.from_named.empty()) {
      return absl::InvalidArgumentError(
          "using-graph-uri and using-named-graph-uri do not go with USING or WITH in the update; leave one "
          "out");
    }
    if (!memory->Add(bytes)) {
      return memory->Refusal(
          absl::ResourceExhaustedError("the graphs of using-graph-uri and using-named-graph-uri, for each "
                                       "operation, are more than fit into the limit "
                                       "query_memory_bytes; write USING into the operations that need it"));
    }
    operation.from = request.default_graphs;
    operation.from_named = request.named_graphs;
  }
  return absl::OkStatus();
}

// The same as Context.Update has of the same text, where that is all.
uint64_t DigestOf(const SparqlRequest& request) {
  std::vector<std::string_view> parts = {request.text};
  for (const Term& graph : request.default_graphs) parts.push_back(graph.lexical);
  if (!request.named_graphs.empty()) parts.push_back("named");
  for (const Term& graph : request.named_graphs) parts.push_back(graph.lexical);
  return RequestDigest("update", parts);
}

// On a worker: parsing may take long.
void Update(const WritePorts& ports, const Measured& measured, const SparqlRequest& request,
            std::shared_ptr<HttpExchange> exchange, std::shared_ptr<Cancellation> cancellation,
            absl::Time until) {
  const auto known = KnownNames(ports);
  sparql::ParseOptions options = sparql::ParseOptionsWith(ports.limits, ports.functions);
  options.known = known.get();
  options.base_iri = request.base_iri;
  const std::shared_ptr<MemoryUse> memory = MemoryOfRequest(ports);
  options.memory = memory.get();
  options.cancellation = cancellation.get();
  sparql::ParsedUpdate parsed;
  {
    const WorkerPool::SharedWork shared(ports.workers, cancellation.get());
    parsed = sparql::ParseUpdate(request.text, options);
  }
  absl::Status status = ToStatus(parsed, request.text);
  if (status.ok()) status = SetUsing(request, &parsed.update, memory.get());
  if (!status.ok()) return Respond(exchange, measured, ErrorResponse(status));
  UpdateRequest update;
  update.update = std::move(parsed.update);
  update.memory = memory;
  update.request_id = request.request_id;
  update.request_digest = DigestOf(request);
  update.min_revision = request.min_revision;
  update.client = exchange->client();
  update.cancellation = std::move(cancellation);
  update.timeout = std::max(absl::ZeroDuration(), until - absl::Now());
  ports.updates->Submit(std::move(update), [measured, exchange](const absl::StatusOr<BatchOutcome>& outcome) {
    Respond(exchange, measured,
            outcome.ok() ? OutcomeResponse(200, *outcome) : ErrorResponse(outcome.status()));
  });
}

// Ends what is done for the request at its time limit and when the client leaves.
std::shared_ptr<Cancellation> CancellationOf(const SparqlRequest& request,
                                             const std::shared_ptr<HttpExchange>& exchange) {
  auto cancellation = std::make_shared<Cancellation>(std::chrono::milliseconds(request.timeout_ms));
  exchange->OnGone([cancellation] { cancellation->Cancel(); });
  return cancellation;
}

// On a worker.
void Answer(const WritePorts& ports, const Measured& measured, const SparqlRequest& request,
            const std::shared_ptr<HttpExchange>& exchange, std::shared_ptr<Cancellation> cancellation,
            absl::Time until) {
  switch (request.kind) {
    case Kind::kQuery:
      return measured.Answered(AnswerQuery(ports, request, exchange, cancellation.get()));
    case Kind::kUpdate:
      return Update(ports, measured, request, exchange, std::move(cancellation), until);
    case Kind::kDescription:
      return Respond(exchange, measured,
                     DescribeService(ports, request.base_iri, exchange->request().Header("accept")));
  }
}

// Has a worker answer, a query as soon as there is the version that it needs.
void Begin(const WritePorts& ports, const Measured& measured, SparqlRequest request,
           const std::shared_ptr<HttpExchange>& exchange) {
  const auto cancellation = CancellationOf(request, exchange);
  const absl::Time until = absl::Now() + absl::Milliseconds(request.timeout_ms);
  // An update is read before it waits for its revision.
  const Revision revision = request.kind == Kind::kQuery ? request.min_revision : Revision();
  SubmitOnVersion(
      ports, revision,
      {.run = [&ports, measured, exchange, cancellation, until,
               request =
                   std::move(request)] { Answer(ports, measured, request, exchange, cancellation, until); },
       .refuse = [measured,
                  exchange](const absl::Status& why) { Respond(exchange, measured, ErrorResponse(why)); },
       .client = exchange->client(),
       .until = until,
       .cancellation = cancellation});
}

// A large or packed body is read by a worker: the network's threads serve others meanwhile.
void ReadAndAnswer(const WritePorts& ports, const Measured& measured,
                   const std::shared_ptr<HttpExchange>& exchange) {
  Cancellation cancellation(std::chrono::milliseconds(ports.limits.query_timeout_ms));
  ReadSparqlRequest read;
  {
    const WorkerPool::SharedWork shared(ports.workers, &cancellation);
    read = ReadSparql(exchange->request(), ports.limits, exchange->memory(), &cancellation);
  }
  if (read.refusal) return Respond(exchange, measured, *std::move(read.refusal));
  Begin(ports, measured, std::move(read.request), exchange);
}

void Handle(const WritePorts& ports, const SparqlMetrics& metrics, std::shared_ptr<HttpExchange> exchange) {
  const Measured measured(metrics);
  std::optional<HttpResponse> refusal = RefuseAnotherSite(exchange->request());
  if (refusal) return Respond(exchange, measured, *std::move(refusal));
  if (IsQuicklyRead(exchange->request())) {
    ReadSparqlRequest read = ReadSparql(exchange->request(), ports.limits);
    if (read.refusal) return Respond(exchange, measured, *std::move(read.refusal));
    return Begin(ports, measured, std::move(read.request), exchange);
  }
  ports.workers->Submit(
      {.run = [&ports, measured, exchange] { ReadAndAnswer(ports, measured, exchange); },
       .refuse = [measured,
                  exchange](const absl::Status& why) { Respond(exchange, measured, ErrorResponse(why)); },
       .client = exchange->client(),
       .until = absl::Now() + absl::Milliseconds(ports.limits.query_timeout_ms)});
}

}  // namespace

HttpResponse OutcomeResponse(int status, const BatchOutcome& outcome) {
  HttpResponse response;
  response.status = status;
  response.content_type = "application/json";
  response.body = OutcomeJson(outcome);
  response.headers.emplace_back("Docent-Revision", absl::StrCat(outcome.offset));
  return response;
}

void AddSparqlRoutes(HttpRoutes* routes, const WritePorts* ports, Metrics* metrics) {
  const SparqlMetrics counts(metrics);
  for (const char* method : {"GET", "POST"}) {
    for (const char* path : {"/sparql", "/sparql/"}) {
      routes->Add(method, path, [ports, counts](std::shared_ptr<HttpExchange> exchange) {
        Handle(*ports, counts, std::move(exchange));
      });
    }
  }
}

}  // namespace docent::server
