#include "kb_server/imports/service_import.h"

#include <gmock/gmock.h>
#include <grpcpp/ext/proto_server_reflection_plugin.h>
#include <grpcpp/grpcpp.h>

#include "absl/strings/str_cat.h"
#include "docent/v1/robot_adapter.grpc.pb.h"
#include "kb_server/imports/import_target.h"

namespace docent::server {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class Adapter final : public v1::RobotAdapter::Service {
  grpc::Status Describe(grpc::ServerContext*, const v1::DescribeRequest*,
                        v1::RobotDescription* reply) override {
    reply->set_robot("urn:r7");
    reply->set_label("R7");
    v1::OperationDescription* wave = reply->add_operations();
    wave->set_name("wave");
    wave->set_description("Waves");
    v1::Part* times = wave->add_input_parts();
    times->set_name("times");
    times->set_type("xsd:integer");
    wave->add_outputs("seen");
    reply->add_operations()->set_name(" bad ");
    return grpc::Status::OK;
  }
};

class ServiceImport : public testing::Test {
 protected:
  // With server reflection, which the library adds by itself.
  std::string Serve() {
    grpc::ServerBuilder builder;
    int port = 0;
    builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port);
    builder.RegisterService(&adapter_);
    grpc::reflection::InitProtoReflectionServerBuilderPlugin();
    server_ = builder.BuildAndStart();
    return absl::StrCat("127.0.0.1:", port);
  }
  Adapter adapter_;
  std::unique_ptr<grpc::Server> server_;
};

TEST_F(ServiceImport, OperationsOfAnAdapterKeepTheirTypes) {
  const auto imported = ImportFromAdapter(Serve());
  ASSERT_TRUE(imported.ok()) << imported.status();
  ASSERT_EQ(imported->templates.size(), 1u);
  const templates::NodeTemplate& wave = imported->templates[0];
  EXPECT_EQ(wave.service, "R7");
  EXPECT_THAT(wave.inputs,
              ElementsAre(templates::TemplatePart{"times", "http://www.w3.org/2001/XMLSchema#integer"}));
  EXPECT_THAT(wave.outputs, ElementsAre(templates::TemplatePart{"seen", ""}));
  EXPECT_THAT(wave.cawl, HasSubstr("type=\"xsd:integer\""));
  EXPECT_EQ(imported->diagnostics.size(), 1u) << "a name that cannot stand in a document";
}

TEST_F(ServiceImport, MethodsAreFoundByReflection) {
  const auto imported = ImportFromGrpc(Serve());
  ASSERT_TRUE(imported.ok()) << imported.status();
  std::vector<std::string> names;
  for (const auto& one : imported->templates) names.push_back(one.operation);
  EXPECT_THAT(names, ElementsAre("Describe", "Cancel")) << "what streams is left out";
  EXPECT_EQ(imported->templates[1].service, "docent.v1.RobotAdapter");
  EXPECT_THAT(imported->templates[1].inputs,
              ElementsAre(templates::TemplatePart{"command_id", "http://www.w3.org/2001/XMLSchema#string"}));
  EXPECT_THAT(imported->templates[1].outputs,
              ElementsAre(templates::TemplatePart{"known", "http://www.w3.org/2001/XMLSchema#boolean"}));
  EXPECT_FALSE(imported->diagnostics.empty());
}

TEST(ImportTarget, ABadAddressIsSaidInOneLine) {
  for (const char* bad : {"", "127.0.0.1", "http://127.0.0.1:1", "unix:/tmp/x", "dns:///x:1", "a b:1", "x:0",
                          "x:70000", ":80", "[::1:80", "x:1/y"}) {
    EXPECT_EQ(ImportFromGrpc(bad).status().code(), absl::StatusCode::kInvalidArgument) << bad;
    EXPECT_EQ(CheckMayReach(bad, nullptr).code(), absl::StatusCode::kInvalidArgument) << bad;
  }
  const absl::Status absent = ImportFromGrpc("127.0.0.1:1").status();
  EXPECT_THAT(std::string(absent.message()), HasSubstr("no gRPC server answers at 127.0.0.1:1"));
  EXPECT_EQ(std::string(absent.message()).find('\n'), std::string::npos);
}

TEST(ImportTarget, OnlyThisMachineAndTheAllowListAreReached) {
  for (const char* here : {"localhost:1", "127.0.0.1:1", "127.9.9.9:1", "[::1]:1", "LOCALHOST:1"})
    EXPECT_TRUE(CheckMayReach(here, nullptr).ok()) << here;
  for (const char* there :
       {"10.0.0.1:1", "169.254.169.254:80", "[fe80::1]:1", "localhost.example.org:1", "0.0.0.0:1"})
    EXPECT_EQ(CheckMayReach(there, nullptr).code(), absl::StatusCode::kPermissionDenied) << there;
  const RemoteAccess remote({"http://10.0.0.1:50051"}, Limits());
  EXPECT_TRUE(CheckMayReach("10.0.0.1:50051", &remote).ok());
  EXPECT_THAT(std::string(CheckMayReach("10.0.0.1:50052", &remote).message()),
              HasSubstr("--allow http://10.0.0.1:50052"));
}

}  // namespace
}  // namespace docent::server
