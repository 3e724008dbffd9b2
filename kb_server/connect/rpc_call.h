// Calls of this process's own gRPC services, by name and with binary messages: whatever a service has, a caller reaches, with
// its deadline, cancellation and back-pressure. What is not asked for is not made: the next message of a stream is read when
// the caller wants it, and a service that writes waits until then.
#ifndef DOCENT_KB_SERVER_CONNECT_RPC_CALL_H_
#define DOCENT_KB_SERVER_CONNECT_RPC_CALL_H_

#include <grpcpp/generic/generic_stub.h>
#include <grpcpp/grpcpp.h>

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"
#include "kb_server/door/client.h"

namespace docent::server {

class RpcCall;

// Who hears of a call: on gRPC's callback thread, one event after the other. It must not block.
class RpcSink {
 public:
  virtual ~RpcSink() = default;
  // The service has taken the call up.
  virtual void OnHead() {}
  // Its next message. The one after it is read when call->Next() is called, then or later, on any thread.
  virtual void OnMessage(std::string bytes, const std::shared_ptr<RpcCall>& call) = 0;
  // Last.
  virtual void OnEnd(const grpc::Status& status) = 0;
};

// All calls over one channel.
class RpcChannel {
 public:
  explicit RpcChannel(std::shared_ptr<grpc::Channel> channel);
  // Waits until its calls have ended: they have to be cancelled before.
  ~RpcChannel();
  RpcChannel(const RpcChannel&) = delete;
  RpcChannel& operator=(const RpcChannel&) = delete;

  // Calls "/docent.v1.Fleet/List" with `requests` and then no more. Until `deadline`; InfiniteFuture: as long as it takes. The
  // call counts as one of `client`. `trace`: the name of what notes the read (FollowedReads); empty: nothing does.
  std::shared_ptr<RpcCall> Start(const std::string& method, std::vector<std::string> requests,
                                 absl::Time deadline, std::shared_ptr<RpcSink> sink,
                                 const ClientPtr& client = nullptr, const std::string& trace = "");
  // Calls that have not ended.
  size_t open() const;

 private:
  friend class RpcCall;
  // Of a call, until its context is gone.
  class Place {
   public:
    explicit Place(RpcChannel* channel);
    ~Place();

   private:
    RpcChannel& channel_;
  };

  grpc::GenericStub stub_;
  mutable absl::Mutex mutex_;
  size_t open_ ABSL_GUARDED_BY(mutex_) = 0;
};

class RpcCall final : public grpc::ClientBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer>,
                      public std::enable_shared_from_this<RpcCall> {
 public:
  // Any thread, also when the call has ended.
  void Cancel();
  // After OnMessage: more calls than messages do nothing.
  void Next();

 private:
  friend class RpcChannel;
  RpcCall(RpcChannel* channel, std::vector<std::string> requests, std::shared_ptr<RpcSink> sink);
  void Begin(grpc::GenericStub* stub, const std::string& method, absl::Time deadline);
  void WriteOne();
  bool Passed(int what);
  void Deliver();

  void OnReadInitialMetadataDone(bool ok) override;
  void OnReadDone(bool ok) override;
  void OnWriteDone(bool ok) override;
  void OnDone(const grpc::Status& status) override;

  RpcChannel::Place place_;  // let go of last
  grpc::ClientContext context_;
  std::vector<std::string> requests_;
  size_t written_ = 0;
  grpc::ByteBuffer writing_;
  grpc::ByteBuffer read_;
  std::atomic<bool> paused_{false};  // no read is under way
  static constexpr int kHead = 1, kMessage = 2;
  std::atomic<int> arrived_{0};    // of the head and the first message
  std::shared_ptr<RpcSink> sink_;  // until the end
  std::shared_ptr<RpcCall> self_;  // likewise
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_CONNECT_RPC_CALL_H_
