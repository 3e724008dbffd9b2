#include "robot_adapters/proxy/adapter_channels.h"

#include <grpcpp/grpcpp.h>

#include "graph/base/limits.h"

namespace docent::proxy {

std::shared_ptr<v1::RobotAdapter::Stub> AdapterChannels::StubFor(const std::string& address) {
  return AdapterAt(address).stub;
}

bool AdapterChannels::IsConnected(const std::string& address) {
  return AdapterAt(address).channel->GetState(/*try_to_connect=*/false) == GRPC_CHANNEL_READY;
}

AdapterChannels::Adapter& AdapterChannels::AdapterAt(const std::string& address) {
  Adapter& adapter = adapters_[address];
  if (adapter.stub == nullptr) {
    grpc::ChannelArguments arguments;
    arguments.SetInt(GRPC_ARG_INITIAL_RECONNECT_BACKOFF_MS, 100);
    arguments.SetInt(GRPC_ARG_MIN_RECONNECT_BACKOFF_MS, 5000);  // this long one attempt to connect may take
    arguments.SetInt(GRPC_ARG_MAX_RECONNECT_BACKOFF_MS, 1000);
    // A robot that lost its radio link sends no goodbye: a quiet stream is probed.
    arguments.SetInt(GRPC_ARG_KEEPALIVE_TIME_MS, 20000);
    arguments.SetInt(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, 5000);
    arguments.SetInt(GRPC_ARG_HTTP2_MAX_PINGS_WITHOUT_DATA, 0);
    arguments.SetInt(GRPC_ARG_ENABLE_HTTP_PROXY, 0);
    arguments.SetMaxReceiveMessageSize(static_cast<int>(Limits().grpc_message_bytes));
    adapter.channel = grpc::CreateCustomChannel(address, grpc::InsecureChannelCredentials(), arguments);
    adapter.stub = v1::RobotAdapter::NewStub(adapter.channel);
  }
  return adapter;
}

}  // namespace docent::proxy
