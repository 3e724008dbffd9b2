#include "kb_server/grpc/message_gate.h"

#include <grpcpp/impl/rpc_service_method.h>
#include <grpcpp/impl/service_type.h>
#include <pthread.h>

#include <deque>
#include <functional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "graph/base/overload.h"
#include "kb_server/door/message_sizes.h"
#include "kb_server/grpc/gated_call.h"

namespace docent::server {
namespace {

namespace pb = google::protobuf;
using grpc::internal::MethodHandler;
using grpc::internal::RpcMethod;
using grpc::internal::RpcServiceMethod;

constexpr absl::Duration kLook = absl::Milliseconds(200);  // for messages that are late
constexpr char kStopped[] = "the server is shutting down";
constexpr char kLate[] = "the message of the call did not arrive in time (grpc_arrival_ms)";

// Handlers of a service's methods, which are there for derived classes alone.
struct Handlers : grpc::Service {
  static MethodHandler* Of(grpc::Service* service, int method) {
    return (service->*&Handlers::GetHandler)(method);
  }
};

class GatedHandler final : public MethodHandler {
 public:
  explicit GatedHandler(std::function<void(const HandlerParameter&)> run) : run_(std::move(run)) {}
  void RunHandler(const HandlerParameter& parameters) override { run_(parameters); }

 private:
  const std::function<void(const HandlerParameter&)> run_;
};

// Stands in the place of another service. To gRPC all of its methods are streams of a client, whose messages it reads only
// when it is told to.
class GuardService final : public grpc::Service {
 public:
  void Add(const GatedMethod& method,
           std::function<void(const GatedMethod&, const MethodHandler::HandlerParameter&)> run) {
    const GatedMethod& kept = methods_.emplace_back(method);
    auto* const handler = new GatedHandler(
        [&kept, run = std::move(run)](const MethodHandler::HandlerParameter& call) { run(kept, call); });
    auto* const rpc = new RpcServiceMethod(kept.path.c_str(), RpcMethod::BIDI_STREAMING, handler);
    rpc->SetServerApiType(RpcServiceMethod::ApiType::CALL_BACK);
    AddMethod(rpc);
  }

 private:
  std::deque<GatedMethod> methods_;  // their places stay
};

}  // namespace

MessageGate::MessageGate(const Limits& limits, const NetworkLimits& network)
    : limits_(limits), network_(network), budget_("grpc_requests_bytes", network.grpc_requests_bytes) {
  thread_ = std::thread([this] {
    pthread_setname_np(pthread_self(), "grpc-gate");
    Watch();
  });
}

MessageGate::~MessageGate() {
  {
    absl::MutexLock lock(&mutex_);
    ending_ = true;
  }
  thread_.join();
}

grpc::Service* MessageGate::Guard(grpc::Service* service, const pb::ServiceDescriptor& descriptor) {
  auto guard = std::make_unique<GuardService>();
  for (int i = 0; i < descriptor.method_count(); ++i) {
    const pb::MethodDescriptor* method = descriptor.method(i);
    const MessageSize largest = LargestMessage(method->full_name(), limits_, network_);
    const GatedMethod gated = {absl::StrCat("/", descriptor.full_name(), "/", method->name()), method,
                               Handlers::Of(service, i), largest.bytes, largest.limit};
    if (method->client_streaming()) {
      guard->Add(gated, [](const GatedMethod& one, const MethodHandler::HandlerParameter& call) {
        one.handler->RunHandler(call);
      });
      continue;
    }
    paths_.insert(gated.path);
    guard->Add(gated, [this](const GatedMethod& one, const MethodHandler::HandlerParameter& call) {
      Enter(new GatedCall(this, &one, call));
    });
  }
  return guards_.emplace_back(std::move(guard)).get();
}

void MessageGate::Stop() {
  std::list<GatedCall*> waiting;
  {
    absl::MutexLock lock(&mutex_);
    stopped_ = true;
    waiting.swap(waiting_);
  }
  for (GatedCall* call : waiting) call->Refuse(absl::UnavailableError(kStopped));
}

size_t MessageGate::arriving() const {
  absl::MutexLock lock(&mutex_);
  return arriving_.size();
}

size_t MessageGate::waiting() const {
  absl::MutexLock lock(&mutex_);
  return waiting_.size();
}

// Of a connection that has a message on its way already, a share; a message of this process is there already.
bool MessageGate::Admit(GatedCall* call) {
  if (call->over_network()) {
    const auto peer = of_peers_.find(call->peer());
    if (peer != of_peers_.end() && peer->second + call->largest() > network_.grpc_connection_bytes)
      return false;
    if (!budget_.Take(call->largest())) return false;
    of_peers_[call->peer()] += call->largest();
    call->admitted = true;
  }
  call->since = absl::Now();
  call->place = arriving_.insert(arriving_.end(), call);
  return true;
}

void MessageGate::Enter(GatedCall* call) {
  bool admitted = false, waits = false, stopped = false;
  {
    absl::MutexLock lock(&mutex_);
    stopped = stopped_;
    admitted = !stopped && Admit(call);
    waits = !stopped && !admitted && waiting_.size() < network_.grpc_waiting;
    if (waits) call->place = waiting_.insert(waiting_.end(), call);
  }
  if (admitted) return call->Read();
  if (waits) return;
  if (stopped) return call->Refuse(absl::UnavailableError(kStopped));
  ++refused_;
  call->Refuse(OverloadError(absl::StrCat("too many messages wait for room: the limit grpc_waiting = ",
                                          network_.grpc_waiting, " is reached; try again later")));
}

absl::Status MessageGate::Leave(GatedCall* call, size_t bytes) {
  bool fits = false;
  {
    absl::MutexLock lock(&mutex_);
    arriving_.erase(call->place);
    if (call->admitted) {
      budget_.Give(call->largest());
      const auto peer = of_peers_.find(call->peer());
      peer->second -= call->largest();
      if (peer->second == 0) of_peers_.erase(peer);
    }
    fits = budget_.Take(bytes);
  }
  LetIn();
  if (fits) return absl::OkStatus();
  ++refused_;
  return budget_.Refusal();
}

void MessageGate::Release(size_t bytes) {
  budget_.Give(bytes);
  LetIn();
}

void MessageGate::LetIn() {
  std::vector<GatedCall*> admitted;
  {
    absl::MutexLock lock(&mutex_);
    for (auto next = waiting_.begin(); next != waiting_.end();) {
      GatedCall* const call = *next;
      const bool room = budget_.HasRoom(call->largest());
      if (room && Admit(call)) {
        admitted.push_back(call);
        next = waiting_.erase(next);
      } else if (room) {
        ++next;  // its connection has its share: others go first
      } else {
        break;  // the first has a right to the room that comes
      }
    }
  }
  for (GatedCall* call : admitted) call->Read();
}

void MessageGate::Watch() {
  const auto has_work = [this]() ABSL_NO_THREAD_SAFETY_ANALYSIS {
    return ending_ || !arriving_.empty() || !waiting_.empty();
  };
  while (true) {
    std::vector<GatedCall*> late;
    {
      absl::MutexLock lock(&mutex_);
      mutex_.Await(absl::Condition(&has_work));
      if (ending_) return;
      const absl::Time now = absl::Now();
      const absl::Time whole = now - absl::Milliseconds(network_.grpc_arrival_ms);
      const absl::Time crowded = now - absl::Milliseconds(network_.grpc_crowded_arrival_ms);
      for (GatedCall* call : arriving_) {
        const absl::Time begun = call->since;
        if (begun >= (waiting_.empty() ? whole : crowded)) break;
        if (!call->over_network() || call->cancelled) continue;
        call->cancelled = true;
        ++late_;
        call->Cancel(kLate);
      }
      while (!waiting_.empty() && waiting_.front()->since < whole) {
        late.push_back(waiting_.front());
        waiting_.pop_front();
      }
    }
    refused_ += late.size();
    for (GatedCall* call : late) call->Refuse(budget_.Refusal());
    absl::MutexLock lock(&mutex_);
    mutex_.AwaitWithTimeout(absl::Condition(&ending_), kLook);
  }
}

}  // namespace docent::server
