// Connections to adapters, one an address, kept while the proxies live. Not thread-safe: the proxies' thread
// owns it.
#ifndef DOCENT_ROBOT_ADAPTERS_PROXY_ADAPTER_CHANNELS_H_
#define DOCENT_ROBOT_ADAPTERS_PROXY_ADAPTER_CHANNELS_H_

#include <map>
#include <memory>
#include <string>

#include "docent/v1/robot_adapter.grpc.pb.h"

namespace docent::proxy {

class AdapterChannels {
 public:
  // The stub for HOST:PORT. Connects by itself, again and again; an adapter that is away makes calls fail at
  // once.
  std::shared_ptr<v1::RobotAdapter::Stub> StubFor(const std::string& address);
  // Whether there is a connection now, over which a call goes out.
  bool IsConnected(const std::string& address);

 private:
  struct Adapter {
    std::shared_ptr<grpc::Channel> channel;
    std::shared_ptr<v1::RobotAdapter::Stub> stub;
  };
  Adapter& AdapterAt(const std::string& address);

  std::map<std::string, Adapter> adapters_;
};

}  // namespace docent::proxy

#endif  // DOCENT_ROBOT_ADAPTERS_PROXY_ADAPTER_CHANNELS_H_
