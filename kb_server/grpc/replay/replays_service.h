// The gRPC service Replays. Each call works on a worker, beside the writer.
#ifndef DOCENT_KB_SERVER_GRPC_REPLAY_REPLAYS_SERVICE_H_
#define DOCENT_KB_SERVER_GRPC_REPLAY_REPLAYS_SERVICE_H_

#include <functional>
#include <memory>

#include "docent/v1/replays.grpc.pb.h"
#include "kb_server/door/ports.h"
#include "kb_server/replay/run_replays.h"

namespace docent::server {

class ReplaysService final : public v1::Replays::CallbackService {
 public:
  // All must outlive it. `workers`: of replays alone, one at a time.
  ReplaysService(const ReadPorts& ports, RunReplays* replays, WorkerPool* workers)
      : ports_(ports), replays_(*replays), workers_(*workers) {}
  grpc::ServerUnaryReactor* Replay(grpc::CallbackServerContext* context, const v1::ReplayRequest* request,
                                   v1::ReplayReply* reply) override;
  grpc::ServerUnaryReactor* TryNode(grpc::CallbackServerContext* context, const v1::TryNodeRequest* request,
                                    v1::TryNodeReply* reply) override;
  grpc::ServerUnaryReactor* Simulate(grpc::CallbackServerContext* context, const v1::SimulateRequest* request,
                                     v1::SimulateReply* reply) override;
  grpc::ServerUnaryReactor* Save(grpc::CallbackServerContext* context, const v1::SaveRunRequest* request,
                                 v1::SaveRunReply* reply) override;

 private:
  grpc::ServerUnaryReactor* Work(grpc::CallbackServerContext* context,
                                 std::function<absl::Status(Cancellation*)> work);

  const ReadPorts& ports_;
  RunReplays& replays_;
  WorkerPool& workers_;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_GRPC_REPLAY_REPLAYS_SERVICE_H_
