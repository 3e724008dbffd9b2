#include "kb_server/grpc/client_of.h"

#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include "tests/kb_server/connect/test_services.h"

namespace docent::server {
namespace {

class ClientOfTest : public ::testing::Test {
 protected:
  ClientOfTest() {
    fleet_.OnList(
        [this](const grpc::CallbackServerContext& context) { client_ = ClientOf(context, &clients_); });
    grpc::ServerBuilder builder;
    builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port_);
    builder.RegisterService(&fleet_);
    server_ = builder.BuildAndStart();
  }
  // The client of a call that says it is made for `name`.
  std::string Call(const std::shared_ptr<grpc::Channel>& channel, const std::string& name) {
    grpc::ClientContext context;
    context.AddMetadata(kClientKey, name);
    v1::ListRobotsReply reply;
    EXPECT_TRUE(v1::Fleet::NewStub(channel)->List(&context, {}, &reply).ok());
    return client_ == nullptr ? "" : client_->name();
  }

  TestFleet fleet_;
  Clients clients_;
  ClientPtr client_;
  int port_ = 0;
  std::unique_ptr<grpc::Server> server_;
};

TEST_F(ClientOfTest, ABridgeOfThisProcessCallsForItsClients) {
  const std::shared_ptr<grpc::Channel> channel = server_->InProcessChannel({});
  EXPECT_EQ(Call(channel, "http:17"), "http:17");
  EXPECT_EQ(Call(channel, "http:18"), "http:18");
}

TEST_F(ClientOfTest, WhatACallOverANetworkSaysCountsForNothing) {
  const auto channel =
      grpc::CreateChannel("127.0.0.1:" + std::to_string(port_), grpc::InsecureChannelCredentials());
  EXPECT_TRUE(Call(channel, "http:17").starts_with("ipv4:127.0.0.1:"));
}

}  // namespace
}  // namespace docent::server
