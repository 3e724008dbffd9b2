// Context.Query: SPARQL on the newest version or a past one, rows as they are found.
#include "absl/strings/str_cat.h"
#include "graph/rdf/text_bytes.h"
#include "graph/sparql/run/describe.h"
#include "graph/sparql/run/federation.h"
#include "graph/sparql/syntax/parser.h"
#include "kb_server/door/history_port.h"
#include "kb_server/grpc/convert.h"
#include "kb_server/grpc/grpc_services.h"
#include "kb_server/grpc/stream_reactor.h"
#include "kb_server/work/remote_access.h"

namespace docent::server {
namespace {

// The answer's way to the client.
struct Output {
  std::shared_ptr<StreamHandle<v1::QueryReply>> stream;
  WorkerPool* workers;
  absl::Time deadline;

  // False: nobody takes more of it. A slow client is waited for, within limits, while others are served.
  bool Send(v1::QueryReply reply) const {
    if (stream->full()) {
      WorkerPool::Waiting waiting(workers, WorkerPool::Waiting::What::kClient);
      if (!stream->AwaitRoom(deadline, [&waiting] { return waiting.Crowded(); })) return false;
    }
    return stream->TryPush(std::move(reply));
  }
};

sparql::DefaultGraph DefaultGraphOf(const v1::QueryRequest& request, const ServicePorts& ports) {
  if (request.default_graph() == v1::QueryRequest::UNION) return sparql::DefaultGraph::kUnion;
  if (request.default_graph() == v1::QueryRequest::STRICT) return sparql::DefaultGraph::kStrict;
  return ports.default_graph;
}

// The header, then all rows or triples.
absl::Status Evaluate(const ServicePorts& ports, sparql::Query& query, const v1::QueryRequest& request,
                      const QueryGraph& graph, Cancellation* cancellation, const Output& out) {
  const GraphVersion& version = *graph.version;
  const Dictionary& dictionary = *graph.dictionary;
  sparql::PrepareOptions options;
  options.default_graph = DefaultGraphOf(request, ports);
  options.functions = ports.functions;
  options.memory_bytes = ports.limits.query_memory_bytes;
  options.all_memory = ports.query_memory;
  sparql::RunOptions run_options;
  run_options.version = &version;
  run_options.cancellation = cancellation;
  run_options.now_us = ports.clock->Now();
  run_options.seed = static_cast<uint64_t>(run_options.now_us);
  absl::Status resolved = sparql::ResolveServices(&query, ports.remote, dictionary, options, run_options);
  if (!resolved.ok()) return resolved;
  const WorkerPool::SharedWork shared(ports.workers, cancellation);
  auto prepared = sparql::PreparedQuery::Prepare(query, dictionary, options);
  if (!prepared.ok()) return prepared.status();
  sparql::PreparedQuery& run = **prepared;

  v1::QueryReply header;
  header.mutable_header()->set_revision(version.revision().value());
  if (request.explain()) {
    auto plan = run.ExplainRun(run_options);
    if (!plan.ok()) return plan.status();
    header.mutable_header()->set_plan(*std::move(plan));
    out.Send(std::move(header));
    return absl::OkStatus();
  }
  if (query.form == sparql::Query::Form::kAsk) {
    auto answer = run.Ask(run_options);
    if (!answer.ok()) return answer.status();
    header.mutable_header()->set_is_boolean(true);
    header.mutable_header()->set_boolean(*answer);
    out.Send(std::move(header));
    return absl::OkStatus();
  }
  if (query.form != sparql::Query::Form::kSelect) {
    auto triples = sparql::AnswerGraph(run, query, dictionary, options, run_options);
    if (!triples.ok()) return triples.status();
    out.Send(std::move(header));
    for (const TermQuad& triple : *triples) {
      v1::QueryReply reply;
      ToProto(triple.subject, reply.mutable_quad()->mutable_subject());
      ToProto(triple.predicate, reply.mutable_quad()->mutable_predicate());
      ToProto(triple.object, reply.mutable_quad()->mutable_object());
      if (!out.Send(std::move(reply))) break;
    }
    return absl::OkStatus();
  }
  for (const std::string& name : run.variables()) header.mutable_header()->add_variables(name);
  out.Send(std::move(header));
  Term term;
  bool too_long = false;
  const size_t limit = ports.limits.grpc_message_bytes;
  const absl::Status status = run.Select(run_options, {}, [&](absl::Span<const TermId> row) {
    v1::QueryReply reply;
    size_t bytes = 0;
    for (TermId id : row) {
      v1::Term* value = reply.mutable_row()->add_values();
      if (id.IsNone()) continue;
      run.DecodeTo(id, &term);
      bytes += TextBytes(term);
      too_long = bytes > limit;
      if (too_long) return false;
      ToProto(term, value);
    }
    return out.Send(std::move(reply));
  });
  if (!status.ok() || !too_long) return status;
  return absl::ResourceExhaustedError(
      absl::StrCat("a row of the answer is longer than the limit grpc_message_bytes = ", limit,
                   "; ask for fewer columns"));
}

absl::Status Answer(const ServicePorts& ports, const v1::QueryRequest& request, Cancellation* cancellation,
                    const Output& out) {
  if (request.query().size() > ports.limits.query_text_bytes) {
    return absl::ResourceExhaustedError(absl::StrCat("the query has ", request.query().size(),
                                                     " bytes; the limit query_text_bytes is ",
                                                     ports.limits.query_text_bytes));
  }
  if (!v1::QueryRequest::DefaultGraph_IsValid(request.default_graph())) {
    return absl::InvalidArgumentError(absl::StrCat("default_graph ",
                                                   static_cast<int>(request.default_graph()),
                                                   " is not known; give AS_STARTED, UNION or STRICT"));
  }
  sparql::ParseOptions options = sparql::ParseOptionsWith(ports.limits, ports.functions);
  sparql::ParsedQuery parsed = sparql::ParseQuery(request.query(), options);
  if (!parsed.ok()) return ToStatus(parsed.diagnostics, request.query());
  auto graph =
      GraphForQuery(ports, Revision(request.min_revision()), request.as_of(), out.deadline, cancellation);
  if (!graph.ok()) return graph.status();
  return Evaluate(ports, parsed.query, request, *graph, cancellation, out);
}

}  // namespace

grpc::ServerWriteReactor<v1::QueryReply>* ContextService::Query(grpc::CallbackServerContext* context,
                                                                const v1::QueryRequest* request) {
  auto* reactor = new StreamReactor<v1::QueryReply>(context, ports_.limits, ports_.send_budget);
  auto stream = reactor->handle();
  int timeout_ms = ports_.limits.query_timeout_ms;
  if (request->timeout_ms() > 0) timeout_ms = std::min<int64_t>(timeout_ms, request->timeout_ms());
  auto cancellation = std::make_shared<Cancellation>(std::chrono::milliseconds(timeout_ms));
  stream->OnGone([cancellation] { cancellation->Cancel(); });
  Output out{stream, ports_.workers, absl::Now() + absl::Milliseconds(timeout_ms)};
  const bool accepted = ports_.workers->Submit(
      [this, out, cancellation, request = *request] {
        out.stream->End(ToGrpc(Answer(ports_, request, cancellation.get(), out)));
      },
      {out.deadline, [stream, timeout_ms] { stream->End(ToGrpc(NotBegun(timeout_ms))); }});
  if (!accepted) {
    stream->End(grpc::Status(grpc::StatusCode::RESOURCE_EXHAUSTED,
                             absl::StrCat("too many queries wait: the limit queries_waiting is ",
                                          ports_.limits.queries_waiting, "; try again")));
  }
  return reactor;
}

}  // namespace docent::server
