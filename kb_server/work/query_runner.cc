#include "kb_server/work/query_runner.h"

#include <memory>

#include "absl/strings/str_cat.h"
#include "graph/base/diagnostic.h"
#include "graph/rdf/text_bytes.h"
#include "graph/sparql/run/describe.h"
#include "graph/sparql/run/federation.h"
#include "graph/sparql/syntax/parser.h"
#include "kb_server/door/history_port.h"
#include "kb_server/door/ports.h"
#include "kb_server/door/query_memory.h"
#include "kb_server/work/known_prefixes.h"
#include "kb_server/work/remote_access.h"

namespace docent::server {
namespace {

using sparql::Query;

constexpr size_t kCopies = 4;  // of a row on its way: as terms, as text, with its connection, as what is sent

// The query, with the data set that the request gives.
absl::StatusOr<Query> Parse(const ReadPorts& ports, const QueryRequest& request, MemoryUse* memory,
                            Cancellation* cancellation) {
  const size_t limit = ports.limits.query_text_bytes;
  if (request.text.size() > limit) {
    return absl::ResourceExhaustedError(
        absl::StrCat("the query has ", request.text.size(), " bytes; the limit query_text_bytes is ", limit));
  }
  const auto known = KnownNames(ports);
  sparql::ParseOptions options = sparql::ParseOptionsWith(ports.limits, ports.functions);
  options.known = known.get();
  options.base_iri = request.base_iri;
  options.memory = memory;
  options.cancellation = cancellation;
  const WorkerPool::SharedWork shared(ports.workers, cancellation);
  sparql::ParsedQuery parsed = sparql::ParseQuery(request.text, options);
  if (!parsed.ok()) return ToStatus(parsed, request.text);
  if (!request.default_graphs.empty() || !request.named_graphs.empty()) {
    parsed.query.from = request.default_graphs;
    parsed.query.from_named = request.named_graphs;
  }
  return std::move(parsed.query);
}

// Each row as terms. What the longest keeps until it is sent counts as memory of the run.
absl::Status Select(sparql::PreparedQuery& query, const sparql::RunOptions& run, QuerySink* sink) {
  sink->OnHeader(query.variables());
  std::vector<std::optional<Term>> terms(query.variables().size());
  size_t longest = 0;  // row, in bytes of text
  absl::Status refusal;
  const absl::Status status = query.Select(run, {}, [&](absl::Span<const TermId> row) {
    size_t bytes = 0;
    for (size_t i = 0; i < terms.size(); ++i) {
      if (row[i].IsNone()) {
        terms[i].reset();
        continue;
      }
      query.DecodeTo(row[i], terms[i] ? &*terms[i] : &terms[i].emplace());
      bytes += TextBytes(*terms[i]);
      refusal = sink->CheckRow(bytes);
      if (!refusal.ok()) return false;
      if (bytes > longest && !query.Charge(kCopies * (bytes - std::exchange(longest, bytes)))) return false;
    }
    refusal = sink->OnRow(terms);
    return refusal.ok();
  });
  if (!status.ok()) return status;
  if (refusal.ok()) sink->OnEnd();
  return refusal;
}

}  // namespace

absl::Status QueryRunner::Run(const QueryRequest& request, Cancellation* cancellation,
                              QuerySink* sink) const {
  const std::shared_ptr<MemoryUse> memory = MemoryOfRequest(ports_);
  absl::StatusOr<Query> query = Parse(ports_, request, memory.get(), cancellation);
  if (!query.ok()) return query.status();
  absl::StatusOr<QueryGraph> graph = GraphForQuery(ports_, request.as_of, cancellation);
  if (!graph.ok()) return graph.status();
  const Dictionary& dictionary = *graph->dictionary;

  sparql::PrepareOptions options;
  options.default_graph = request.default_graph.value_or(ports_.default_graph);
  options.functions = ports_.functions;
  options.memory_bytes = ports_.limits.query_memory_bytes;
  options.memory = memory.get();
  options.cancellation = cancellation;
  sparql::RunOptions run;
  run.version = graph->version.get();
  run.cancellation = cancellation;
  run.now_us = ports_.clock->Now();
  run.seed = static_cast<uint64_t>(run.now_us);
  const WorkerPool::SharedWork shared(ports_.workers, cancellation);
  absl::Status resolved = sparql::ResolveServices(&*query, ports_.remote, dictionary, options, run);
  if (!resolved.ok()) return resolved;
  absl::StatusOr<std::unique_ptr<sparql::PreparedQuery>> prepared =
      sparql::PreparedQuery::Prepare(*std::move(query), dictionary, options);
  if (!prepared.ok()) return prepared.status();
  const Query::Form form = (*prepared)->form();
  if (!sink->OnBegin(form, graph->version->revision())) return absl::OkStatus();

  if (request.explain) {
    absl::StatusOr<std::string> plan = (*prepared)->ExplainRun(run);
    if (plan.ok()) sink->OnPlan(*std::move(plan));
    return plan.status();
  }
  if (form == Query::Form::kSelect) return Select(**prepared, run, sink);
  if (form == Query::Form::kAsk) {
    const absl::StatusOr<bool> answer = (*prepared)->Ask(run);
    if (answer.ok()) sink->OnBoolean(*answer);
    return answer.status();
  }
  absl::StatusOr<std::vector<TermQuad>> triples =
      sparql::AnswerGraph(**prepared, (*prepared)->query(), dictionary, options, run);
  if (!triples.ok()) return triples.status();
  return sink->OnGraph(*std::move(triples), (*prepared)->query().prefixes);
}

}  // namespace docent::server
