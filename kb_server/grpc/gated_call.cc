#include "kb_server/grpc/gated_call.h"

#include <google/protobuf/io/zero_copy_stream_impl.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>
#include <grpc/byte_buffer_reader.h>
#include <grpcpp/impl/codegen/server_callback_handlers.h>

#include <climits>
#include <memory>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "graph/wire/message_memory.h"
#include "kb_server/door/message_sizes.h"
#include "kb_server/grpc/client_of.h"
#include "kb_server/grpc/convert.h"

namespace docent::server {
namespace {

namespace io = google::protobuf::io;

class Refusal final : public grpc::ServerBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer> {
 public:
  explicit Refusal(const grpc::Status& status) { Finish(status); }
  void OnDone() override { delete this; }
};

// Of the pieces of `message`, which stays as it is.
std::optional<size_t> MemoryOf(const google::protobuf::Descriptor& type, grpc_byte_buffer* message,
                               size_t most) {
  grpc_byte_buffer_reader reader;
  if (grpc_byte_buffer_reader_init(&reader, message) == 0) return std::nullopt;
  std::vector<std::unique_ptr<io::ZeroCopyInputStream>> pieces;
  std::vector<io::ZeroCopyInputStream*> all;
  for (grpc_slice* piece = nullptr; grpc_byte_buffer_reader_peek(&reader, &piece) != 0;) {
    pieces.push_back(std::make_unique<io::ArrayInputStream>(GRPC_SLICE_START_PTR(*piece),
                                                            static_cast<int>(GRPC_SLICE_LENGTH(*piece))));
    all.push_back(pieces.back().get());
  }
  io::ConcatenatingInputStream bytes(all.data(), static_cast<int>(all.size()));
  const std::optional<size_t> memory = MemoryOfMessage(type, &bytes, most);
  grpc_byte_buffer_reader_destroy(&reader);
  return memory;
}

}  // namespace

GatedCall::GatedCall(MessageGate* gate, const GatedMethod* method, const Parameters& parameters)
    : grpc_completion_queue_functor{},
      since(absl::Now()),
      gate_(*gate),
      method_(*method),
      call_(parameters.call),
      context_(parameters.server_context),
      requester_(parameters.call_requester),
      peer_(context_->peer()),
      over_network_(IsOverNetwork(peer_)) {
  functor_run = [](grpc_completion_queue_functor* self, int) { static_cast<GatedCall*>(self)->Arrived(); };
}

void GatedCall::Read() {
  grpc_op read{};
  read.op = GRPC_OP_RECV_MESSAGE;
  read.data.recv_message.recv_message = &message_;
  grpc_completion_queue_functor* const done = this;
  grpc_call_start_batch(call_->call(), &read, 1, done, nullptr);
}

void GatedCall::Cancel(const char* reason) {
  grpc_call_cancel_with_status(call_->call(), GRPC_STATUS_DEADLINE_EXCEEDED, reason, nullptr);
}

void GatedCall::Refuse(const absl::Status& status) {
  const std::unique_ptr<GatedCall> self(this);
  if (message_ != nullptr) grpc_byte_buffer_destroy(std::exchange(message_, nullptr));
  grpc::internal::CallbackBidiHandler<grpc::ByteBuffer, grpc::ByteBuffer> refusal(
      [&status](grpc::CallbackServerContext*) { return new Refusal(ToGrpc(status)); });
  refusal.RunHandler({call_, context_, nullptr, grpc::Status::OK, nullptr, requester_});
}

absl::StatusOr<size_t> GatedCall::Measure() const {
  const std::string& type = method_.descriptor->input_type()->full_name();
  if (message_ == nullptr)
    return absl::InvalidArgumentError(absl::StrCat("the call ends without its message, a ", type));
  const size_t length = grpc_byte_buffer_length(message_);
  const absl::Status size =
      CheckMessageSize(method_.descriptor->full_name(), length, {method_.largest_bytes, method_.limit});
  if (!size.ok()) return size;
  const size_t most = gate_.network_.request_memory_bytes;
  const std::optional<size_t> memory = MemoryOf(*method_.descriptor->input_type(), message_, most);
  if (!memory) {
    return absl::InvalidArgumentError(absl::StrCat(
        "the request is not a ", type, ": its bytes are damaged or of another type; see the .proto files"));
  }
  if (*memory <= most) return length + *memory;
  return absl::ResourceExhaustedError(absl::StrCat(
      "a ", type, " of so many parts takes more memory than the limit request_memory_bytes = ", most,
      "; send it in several"));
}

void GatedCall::Arrived() {
  const absl::StatusOr<size_t> measured = Measure();
  const size_t bytes = measured.value_or(0);
  const absl::Status room = gate_.Leave(this, bytes);
  if (!measured.ok() || !room.ok()) return Refuse(measured.ok() ? room : measured.status());
  const std::unique_ptr<GatedCall> self(this);
  const size_t length = grpc_byte_buffer_length(message_);
  grpc::Status status;
  void* data = nullptr;
  void* const request =
      method_.handler->Deserialize(call_->call(), std::exchange(message_, nullptr), &status, &data);
  gate_.Release(length);
  const auto done = [gate = &gate_, held = bytes - length, requester = requester_] {
    gate->Release(held);
    requester();
  };
  method_.handler->RunHandler({call_, context_, request, status, data, done});
}

}  // namespace docent::server
