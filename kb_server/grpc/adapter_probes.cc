#include "kb_server/grpc/adapter_probes.h"

#include <grpcpp/grpcpp.h>

#include <chrono>
#include <utility>
#include <vector>

#include "docent/v1/robot_adapter.grpc.pb.h"

namespace docent::server {
namespace {

constexpr std::chrono::milliseconds kProbe{1000};

}  // namespace

struct AdapterProbes::Probe {
  std::unique_ptr<v1::RobotAdapter::Stub> stub;
  grpc::ClientContext context;
  v1::DescribeRequest request;
  v1::RobotDescription description;
  std::vector<Then> asked;
};

AdapterProbes::AdapterProbes() = default;

AdapterProbes::~AdapterProbes() {
  const auto none = [this]() ABSL_NO_THREAD_SAFETY_ANALYSIS { return probes_.empty(); };
  absl::MutexLock lock(&mutex_);
  for (const auto& [address, probe] : probes_) probe->context.TryCancel();
  mutex_.Await(absl::Condition(&none));
}

void AdapterProbes::Ask(const std::string& address, Then then) {
  Probe* begun = nullptr;
  {
    absl::MutexLock lock(&mutex_);
    std::unique_ptr<Probe>& probe = probes_[address];
    if (probe == nullptr) {
      probe = std::make_unique<Probe>();
      begun = probe.get();
    }
    probe->asked.push_back(std::move(then));
  }
  if (begun == nullptr) return;
  grpc::ChannelArguments arguments;
  arguments.SetInt(GRPC_ARG_ENABLE_HTTP_PROXY, 0);
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
  begun->stub = v1::RobotAdapter::NewStub(
      grpc::CreateCustomChannel(address, grpc::InsecureChannelCredentials(), arguments));
  begun->context.set_deadline(std::chrono::system_clock::now() + kProbe);
  begun->stub->async()->Describe(&begun->context, &begun->request, &begun->description,
                                 [this, address](const grpc::Status& status) {
                                   End(address, status.error_code() == grpc::StatusCode::UNAVAILABLE);
                                 });
}

// What came of it is told first: the destructor waits for that, too.
void AdapterProbes::End(const std::string& address, bool gone) {
  std::vector<Then> asked;
  while (true) {
    for (const Then& then : asked) then(gone);
    asked.clear();
    std::unique_ptr<Probe> ended;  // goes after the lock
    absl::MutexLock lock(&mutex_);
    const auto found = probes_.find(address);
    asked.swap(found->second->asked);
    if (!asked.empty()) continue;
    ended = std::move(found->second);
    probes_.erase(found);
    return;
  }
}

}  // namespace docent::server
