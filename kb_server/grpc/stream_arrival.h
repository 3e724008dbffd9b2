// Time for the messages of streams that gRPC's own services read: reflection. They pass no gate, and hold a thread each.
#ifndef DOCENT_KB_SERVER_GRPC_STREAM_ARRIVAL_H_
#define DOCENT_KB_SERVER_GRPC_STREAM_ARRIVAL_H_

#include <grpcpp/support/server_interceptor.h>

namespace docent::server {

// Ends a call of reflection when no message of it arrives for `arrival_ms`, whether the client has begun one or not. Thread-safe.
class StreamArrival final : public grpc::experimental::ServerInterceptorFactoryInterface {
 public:
  explicit StreamArrival(int arrival_ms) : arrival_ms_(arrival_ms) {}
  // Null for the calls of other services.
  grpc::experimental::Interceptor* CreateServerInterceptor(grpc::experimental::ServerRpcInfo* info) override;

 private:
  const int arrival_ms_;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_GRPC_STREAM_ARRIVAL_H_
