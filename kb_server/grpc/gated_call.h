// One call at the gate, from its head until its service has it. Private to the gate.
#ifndef DOCENT_KB_SERVER_GRPC_GATED_CALL_H_
#define DOCENT_KB_SERVER_GRPC_GATED_CALL_H_

#include <grpc/grpc.h>
#include <grpcpp/grpcpp.h>

#include <functional>
#include <list>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "kb_server/grpc/message_gate.h"

namespace docent::server {

// Deletes itself when the service, or a refusal, has the call. gRPC's own functor is what it calls when the message is there.
class GatedCall : private grpc_completion_queue_functor {
 public:
  using Parameters = grpc::internal::MethodHandler::HandlerParameter;
  GatedCall(MessageGate* gate, const GatedMethod* method, const Parameters& parameters);
  GatedCall(const GatedCall&) = delete;
  GatedCall& operator=(const GatedCall&) = delete;

  void Read();
  void Refuse(const absl::Status& status);
  // Ends the reading: the message does not arrive. Any thread, while the gate holds the call.
  void Cancel(const char* reason);

  // Of the gate.
  size_t largest() const { return method_.largest_bytes; }
  const std::string& peer() const { return peer_; }
  bool over_network() const { return over_network_; }
  absl::Time since;
  bool admitted = false;  // and counted with largest()
  bool cancelled = false;
  std::list<GatedCall*>::iterator place;

 private:
  void Arrived();
  // The bytes of memory of the message, or what is wrong with it.
  absl::StatusOr<size_t> Measure() const;

  MessageGate& gate_;
  const GatedMethod& method_;
  grpc::internal::Call* const call_;
  grpc::ServerContextBase* const context_;
  const std::function<void()> requester_;
  const std::string peer_;
  const bool over_network_;
  grpc_byte_buffer* message_ = nullptr;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_GRPC_GATED_CALL_H_
