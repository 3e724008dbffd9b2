// The handlers of Fleet and Context.Query over gRPC in this process, without a server.
#include <gmock/gmock.h>
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include "kb_server/grpc/grpc_services.h"
#include "tests/kb_server/handler_world.h"

namespace docent::server {
namespace {

using ::testing::ElementsAre;

class HandlersTest : public ::testing::Test {
 protected:
  HandlersTest() {
    grpc::ServerBuilder builder;
    builder.RegisterService(&fleet_service_);
    builder.RegisterService(&context_service_);
    server_ = builder.BuildAndStart();
    const std::shared_ptr<grpc::Channel> channel = server_->InProcessChannel({});
    fleet_ = v1::Fleet::NewStub(channel);
    context_ = v1::Context::NewStub(channel);
  }
  ~HandlersTest() override { server_->Shutdown(); }

  grpc::Status Join(const std::string& robot, v1::JoinReply* reply) {
    v1::JoinRequest request;
    request.set_address("127.0.0.1:9");
    request.mutable_description()->set_robot(robot);
    request.mutable_description()->set_incarnation("i1");
    request.mutable_description()->add_operations()->set_name("speak");
    grpc::ClientContext context;
    return fleet_->Join(&context, request, reply);
  }

  test::HandlerWorld world_;
  FleetLeases leases_{&world_.clock};
  FleetService fleet_service_{world_.ports, &leases_};
  ContextService context_service_{world_.ports};
  std::unique_ptr<grpc::Server> server_;
  std::unique_ptr<v1::Fleet::Stub> fleet_;
  std::unique_ptr<v1::Context::Stub> context_;
};

TEST_F(HandlersTest, ARobotThatJoinsIsListed) {
  v1::JoinReply joined;
  ASSERT_TRUE(Join("urn:r1", &joined).ok());
  EXPECT_EQ(joined.lease_ms(), FleetLeases::kLeaseMs);
  EXPECT_EQ(joined.revision(), 1u);
  EXPECT_TRUE(joined.tell_states());
  ASSERT_TRUE(Join("urn:r1", &joined).ok());
  EXPECT_EQ(joined.revision(), 1u) << "a heartbeat is not written";

  grpc::ClientContext context;
  v1::ListRobotsReply robots;
  ASSERT_TRUE(fleet_->List(&context, {}, &robots).ok());
  ASSERT_EQ(robots.robots_size(), 1);
  EXPECT_EQ(robots.robots(0).robot(), "urn:r1");
  EXPECT_EQ(robots.robots(0).address(), "127.0.0.1:9");
  EXPECT_EQ(robots.robots(0).state(), "standby");
  EXPECT_THAT(robots.robots(0).operations(), ElementsAre("speak"));
}

TEST_F(HandlersTest, ARobotThatLeavesIsOfflineAtOnce) {
  const auto leave = [this](const std::string& incarnation, v1::LeaveReply* reply) {
    v1::LeaveRequest request;
    request.set_robot("urn:r1");
    request.set_incarnation(incarnation);
    grpc::ClientContext context;
    return fleet_->Leave(&context, request, reply);
  };
  const auto robot = [this] {
    grpc::ClientContext context;
    v1::ListRobotsReply robots;
    EXPECT_TRUE(fleet_->List(&context, {}, &robots).ok());
    return robots.robots_size() == 1 ? robots.robots(0) : v1::RobotStatus();
  };
  v1::JoinReply joined;
  v1::LeaveReply left;
  ASSERT_TRUE(Join("urn:r1", &joined).ok());
  ASSERT_TRUE(leave("an earlier one", &left).ok());
  EXPECT_EQ(robot().state(), "standby");
  EXPECT_EQ(left.revision(), 1u);
  ASSERT_TRUE(leave("i1", &left).ok());
  EXPECT_EQ(left.revision(), 2u);
  EXPECT_EQ(robot().state(), "offline");
  EXPECT_EQ(robot().last_seen_us(), world_.clock.Now());
  ASSERT_TRUE(leave("i1", &left).ok());
  EXPECT_EQ(left.revision(), 2u) << "it may be repeated";
  EXPECT_EQ(leave("", &left).error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  ASSERT_TRUE(Join("urn:r1", &joined).ok());
  EXPECT_EQ(robot().state(), "standby");
}

TEST_F(HandlersTest, AJoinWithoutAnIriIsRefused) {
  v1::JoinReply joined;
  EXPECT_EQ(Join("no IRI", &joined).error_code(), grpc::StatusCode::INVALID_ARGUMENT);
}

TEST_F(HandlersTest, AQuerySendsItsHeaderAndThenItsRows) {
  v1::JoinReply joined;
  ASSERT_TRUE(Join("urn:r1", &joined).ok());
  grpc::ClientContext context;
  v1::QueryRequest request;
  request.set_query("SELECT ?robot { ?robot a docent:Robot }");
  request.set_min_revision(1);
  const auto reader = context_->Query(&context, request);
  v1::QueryReply reply;
  ASSERT_TRUE(reader->Read(&reply));
  EXPECT_EQ(reply.header().revision(), 1u);
  EXPECT_THAT(reply.header().variables(), ElementsAre("robot"));
  ASSERT_TRUE(reader->Read(&reply));
  EXPECT_EQ(reply.row().values(0).iri(), "urn:r1");
  EXPECT_FALSE(reader->Read(&reply));
  EXPECT_TRUE(reader->Finish().ok());
}

}  // namespace
}  // namespace docent::server
