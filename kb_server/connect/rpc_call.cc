#include "kb_server/connect/rpc_call.h"

#include <utility>

#include "kb_server/door/followed_reads.h"

namespace docent::server {
namespace {

grpc::ByteBuffer BufferOf(const std::string& bytes) {
  const grpc::Slice slice(bytes);
  return grpc::ByteBuffer(&slice, 1);
}

std::string BytesOf(const grpc::ByteBuffer& buffer) {
  std::vector<grpc::Slice> slices;
  std::string bytes;
  if (!buffer.Valid() || !buffer.Dump(&slices).ok()) return bytes;
  bytes.reserve(buffer.Length());
  for (const grpc::Slice& slice : slices)
    bytes.append(reinterpret_cast<const char*>(slice.begin()), slice.size());
  return bytes;
}

}  // namespace

RpcChannel::RpcChannel(std::shared_ptr<grpc::Channel> channel) : stub_(std::move(channel)) {}

RpcChannel::~RpcChannel() {
  const auto none = [this]() ABSL_NO_THREAD_SAFETY_ANALYSIS { return open_ == 0; };
  absl::MutexLock lock(&mutex_);
  mutex_.Await(absl::Condition(&none));
}

size_t RpcChannel::open() const {
  absl::MutexLock lock(&mutex_);
  return open_;
}

RpcChannel::Place::Place(RpcChannel* channel) : channel_(*channel) {
  absl::MutexLock lock(&channel_.mutex_);
  ++channel_.open_;
}

RpcChannel::Place::~Place() {
  absl::MutexLock lock(&channel_.mutex_);
  --channel_.open_;
}

std::shared_ptr<RpcCall> RpcChannel::Start(const std::string& method, std::vector<std::string> requests,
                                           absl::Time deadline, std::shared_ptr<RpcSink> sink,
                                           const ClientPtr& client, const std::string& trace) {
  std::shared_ptr<RpcCall> call(new RpcCall(this, std::move(requests), std::move(sink)));
  if (client != nullptr) call->context_.AddMetadata(kClientKey, client->name());
  if (!trace.empty()) call->context_.AddMetadata(kTraceKey, trace);
  call->Begin(&stub_, method, deadline);
  return call;
}

RpcCall::RpcCall(RpcChannel* channel, std::vector<std::string> requests, std::shared_ptr<RpcSink> sink)
    : place_(channel), requests_(std::move(requests)), sink_(std::move(sink)) {}

void RpcCall::Begin(grpc::GenericStub* stub, const std::string& method, absl::Time deadline) {
  if (deadline != absl::InfiniteFuture()) context_.set_deadline(absl::ToChronoTime(deadline));
  self_ = shared_from_this();
  stub->PrepareBidiStreamingCall(&context_, method, grpc::StubOptions(), this);
  AddHold();  // while reads may be started from outside; until a read fails
  WriteOne();
  StartRead(&read_);
  StartCall();
}

void RpcCall::WriteOne() {
  if (written_ == requests_.size()) return StartWritesDone();
  writing_ = BufferOf(requests_[written_]);
  std::string().swap(requests_[written_]);
  ++written_;
  if (written_ == requests_.size()) {
    StartWriteLast(&writing_, grpc::WriteOptions());
  } else {
    StartWrite(&writing_);
  }
}

void RpcCall::Cancel() {
  context_.TryCancel();
  Next();
}

void RpcCall::Next() {
  if (paused_.exchange(false)) StartRead(&read_);
}

void RpcCall::OnReadInitialMetadataDone(bool ok) {
  if (ok) sink_->OnHead();
  if (Passed(kHead)) Deliver();
}

// gRPC may say of the first message on another thread before it has said of the head: the later of the two passes it on.
bool RpcCall::Passed(int what) {
  return (arrived_.fetch_or(what) | what) == (kHead | kMessage);
}

void RpcCall::Deliver() {
  std::string bytes = BytesOf(read_);
  read_.Clear();
  paused_ = true;
  sink_->OnMessage(std::move(bytes), self_);
}

void RpcCall::OnReadDone(bool ok) {
  if (!ok) return RemoveHold();
  if (Passed(kMessage)) Deliver();
}

void RpcCall::OnWriteDone(bool ok) {
  if (ok && written_ < requests_.size()) WriteOne();
}

void RpcCall::OnDone(const grpc::Status& status) {
  const std::shared_ptr<RpcCall> self = std::move(self_);
  const std::shared_ptr<RpcSink> sink = std::move(sink_);
  sink->OnEnd(status);
}

}  // namespace docent::server
