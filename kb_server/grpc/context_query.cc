// Context.Query: SPARQL on the newest version or a past one, rows as they are found.
#include "absl/strings/str_cat.h"
#include "kb_server/door/await_version.h"
#include "kb_server/grpc/client_of.h"
#include "kb_server/grpc/convert.h"
#include "kb_server/grpc/grpc_services.h"
#include "kb_server/grpc/stream_reactor.h"
#include "kb_server/work/query_runner.h"

namespace docent::server {
namespace {

// The answer's way to the client.
struct Output {
  std::shared_ptr<StreamHandle<v1::QueryReply>> stream;
  absl::Time deadline;

  // False: nobody takes more of it. A slow client is waited for, within limits, while others are served.
  bool Send(v1::QueryReply reply) const {
    if (stream->full()) {
      WorkerPool::Waiting waiting(WorkerPool::Waiting::What::kClient);
      if (!stream->AwaitRoom(deadline, [&waiting] { return waiting.Crowded(); })) return false;
    }
    return stream->TryPush(std::move(reply));
  }
};

// Sends the header, then a message for each row or triple.
class GrpcSink final : public QuerySink {
 public:
  GrpcSink(const Output& out, size_t message_bytes) : out_(out), message_bytes_(message_bytes) {}

  bool OnBegin(sparql::Query::Form, Revision revision) override {
    header_.mutable_header()->set_revision(revision.value());
    return true;
  }
  void OnPlan(std::string plan) override {
    header_.mutable_header()->set_plan(std::move(plan));
    SendHeader().IgnoreError();
  }
  void OnBoolean(bool answer) override {
    header_.mutable_header()->set_is_boolean(true);
    header_.mutable_header()->set_boolean(answer);
    SendHeader().IgnoreError();
  }
  void OnHeader(const std::vector<std::string>& variables) override {
    for (const std::string& name : variables) header_.mutable_header()->add_variables(name);
    SendHeader().IgnoreError();
  }
  absl::Status CheckRow(size_t bytes) override {
    if (bytes <= message_bytes_) return absl::OkStatus();
    return absl::ResourceExhaustedError(
        absl::StrCat("a row of the answer is longer than the limit grpc_message_bytes = ", message_bytes_,
                     "; ask for fewer columns"));
  }
  absl::Status OnRow(const std::vector<std::optional<Term>>& row) override {
    v1::QueryReply reply;
    for (const std::optional<Term>& term : row) {
      v1::Term* value = reply.mutable_row()->add_values();
      if (term) ToProto(*term, value);
    }
    return Send(std::move(reply));
  }
  void OnEnd() override {}
  absl::Status OnGraph(std::vector<TermQuad> triples,
                       const std::vector<std::pair<std::string, std::string>>&) override {
    absl::Status status = SendHeader();
    for (const TermQuad& triple : triples) {
      if (!status.ok()) break;
      v1::QueryReply reply;
      ToProto(triple.subject, reply.mutable_quad()->mutable_subject());
      ToProto(triple.predicate, reply.mutable_quad()->mutable_predicate());
      ToProto(triple.object, reply.mutable_quad()->mutable_object());
      status = Send(std::move(reply));
    }
    return status;
  }

 private:
  absl::Status SendHeader() { return Send(std::move(header_)); }
  absl::Status Send(v1::QueryReply reply) {
    if (out_.Send(std::move(reply))) return absl::OkStatus();
    return absl::CancelledError("the client takes no more of the answer");
  }

  const Output& out_;
  const size_t message_bytes_;
  v1::QueryReply header_;
};

absl::Status Answer(const ReadPorts& ports, const v1::QueryRequest& request, Cancellation* cancellation,
                    const Output& out) {
  if (!v1::QueryRequest::DefaultGraph_IsValid(request.default_graph())) {
    return absl::InvalidArgumentError(absl::StrCat("default_graph ",
                                                   static_cast<int>(request.default_graph()),
                                                   " is not known; give AS_STARTED, UNION or STRICT"));
  }
  QueryRequest query;
  query.text = request.query();
  query.as_of = request.as_of();
  query.explain = request.explain();
  if (request.default_graph() == v1::QueryRequest::UNION) query.default_graph = sparql::DefaultGraph::kUnion;
  if (request.default_graph() == v1::QueryRequest::STRICT)
    query.default_graph = sparql::DefaultGraph::kStrict;
  GrpcSink sink(out, ports.limits.grpc_message_bytes);
  return QueryRunner(&ports).Run(query, cancellation, &sink);
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
  Output out{stream, absl::Now() + absl::Milliseconds(timeout_ms)};
  SubmitOnVersion(ports_, Revision(request->min_revision()),
                  {.run =
                       [this, out, cancellation, request = *request] {
                         out.stream->End(ToGrpc(Answer(ports_, request, cancellation.get(), out)));
                       },
                   .refuse = [stream](const absl::Status& why) { stream->End(ToGrpc(why)); },
                   .client = ClientOf(*context, ports_.clients),
                   .until = out.deadline,
                   .cancellation = cancellation});
  return reactor;
}

}  // namespace docent::server
