// Robots of a benchmark, whose commands are done at once, and what fills a server with them.
#ifndef DOCENT_BENCH_INSTANT_ROBOTS_H_
#define DOCENT_BENCH_INSTANT_ROBOTS_H_

#include <grpcpp/grpcpp.h>

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "docent/v1/robot_adapter.grpc.pb.h"
#include "graph/rdf/term.h"

namespace docent::bench {

// Adapter of all robots, in this process, on a free port of 127.0.0.1.
class InstantAdapter final : public v1::RobotAdapter::CallbackService {
 public:
  // `invoked` is called for each command, on gRPC's threads; then the command is done.
  explicit InstantAdapter(std::function<void(const v1::InvokeRequest&)> invoked);
  ~InstantAdapter() override;
  const std::string& address() const { return address_; }

  grpc::ServerWriteReactor<v1::Feedback>* Invoke(grpc::CallbackServerContext* context,
                                                 const v1::InvokeRequest* request) override;

 private:
  const std::function<void(const v1::InvokeRequest&)> invoked_;
  std::string address_;
  std::unique_ptr<grpc::Server> server_;
};

// The facts of robots urn:mix:robot0, …1, which offer operations with one input each: (name, input).
std::vector<TermQuad> InstantRobots(int count, const std::string& adapter,
                                    const std::vector<std::pair<std::string, std::string>>& operations);

// In parts that are no larger than a message may be.
grpc::Status LoadQuads(const std::shared_ptr<grpc::Channel>& channel, const std::vector<TermQuad>& quads);
grpc::Status Deploy(const std::shared_ptr<grpc::Channel>& channel, const std::string& name,
                    const std::string& cawl);

}  // namespace docent::bench

#endif  // DOCENT_BENCH_INSTANT_ROBOTS_H_
