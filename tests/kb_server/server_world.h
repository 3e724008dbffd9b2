// A real server on free ports of loopback, and clients of it.
#ifndef DOCENT_TESTS_KB_SERVER_SERVER_WORLD_H_
#define DOCENT_TESTS_KB_SERVER_SERVER_WORLD_H_

#include <grpcpp/grpcpp.h>
#include <unistd.h>

#include <filesystem>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "absl/strings/str_cat.h"
#include "gtest/gtest.h"
#include "kb_server/server.h"
#include "tests/kb_server/test_world.h"

namespace docent::server::test {

// A folder of its own, gone with the object.
class TestFolder {
 public:
  TestFolder() {
    static int count = 0;
    path_ = std::filesystem::path(::testing::TempDir()) /
            absl::StrCat("docent_server_test_", getpid(), "_", count++);
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
  }
  ~TestFolder() { std::filesystem::remove_all(path_); }
  std::string operator/(const std::string& name) const { return (path_ / name).string(); }

 private:
  std::filesystem::path path_;
};

inline v1::AssertRequest Turtle(const std::string& text, const std::string& request_id = "") {
  v1::AssertRequest request;
  request.set_rdf("@prefix docent: <https://w3id.org/docent#> . @prefix : <urn:w:> .\n" + text);
  request.set_request_id(request_id);
  return request;
}

struct Rows {
  grpc::Status status;
  v1::QueryHeader header;
  std::vector<std::string>
      rows;  // of SELECT: values as N-Triples or "-", with blanks between; of CONSTRUCT: triples
};

class ServerTest : public ::testing::Test {
 protected:
  ServerTest() {
    settings_.data_folder = folder_ / "data";
    settings_.grpc_address = "127.0.0.1:0";
    settings_.http_address = "127.0.0.1:0";
  }

  void StartServer() {
    auto server = Server::Start(settings_, nullptr);
    ASSERT_TRUE(server.ok()) << server.status();
    server_ = *std::move(server);
    grpc::ChannelArguments arguments;
    arguments.SetMaxReceiveMessageSize(64 << 20);
    arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
    channel_ =
        grpc::CreateCustomChannel(server_->grpc_address(), grpc::InsecureChannelCredentials(), arguments);
    context_ = v1::Context::NewStub(channel_);
    ontologies_ = v1::Ontologies::NewStub(channel_);
    workflows_ = v1::Workflows::NewStub(channel_);
    services_ = v1::RobotServices::NewStub(channel_);
    fleet_ = v1::Fleet::NewStub(channel_);
  }
  void StopServer() { server_.reset(); }
  uint16_t http_port() const { return PortOf(*server_); }
  static uint16_t PortOf(const Server& server) {
    const std::string& address = server.http_address();
    return static_cast<uint16_t>(std::stoi(address.substr(address.rfind(':') + 1)));
  }

  // Every call has a deadline, so that a mistake fails a test and does not hang it.
  static void Limit(grpc::ClientContext* context) {
    context->set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(60));
  }

  template <typename Stub, typename Request, typename Reply>
  grpc::Status Call(const std::unique_ptr<Stub>& stub,
                    grpc::Status (Stub::*method)(grpc::ClientContext*, const Request&, Reply*),
                    const Request& request, Reply* reply) {
    grpc::ClientContext context;
    Limit(&context);
    return ((*stub).*method)(&context, request, reply);
  }
  grpc::Status Assert(const v1::AssertRequest& request, v1::AssertReply* reply = nullptr) {
    v1::AssertReply unused;
    return Call(context_, &v1::Context::Stub::Assert, request, reply == nullptr ? &unused : reply);
  }
  void MustTell(const std::string& turtle) {
    grpc::Status status = Assert(Turtle(turtle));
    ASSERT_TRUE(status.ok()) << status.error_message();
  }
  Rows Query(const std::string& text, uint64_t min_revision = 0, uint32_t timeout_ms = 0) {
    v1::QueryRequest request;
    request.set_query(text);
    request.set_min_revision(min_revision);
    request.set_timeout_ms(timeout_ms);
    grpc::ClientContext context;
    Limit(&context);
    auto reader = context_->Query(&context, request);
    Rows rows;
    v1::QueryReply reply;
    while (reader->Read(&reply)) {
      if (reply.has_header()) rows.header = reply.header();
      if (reply.has_row()) rows.rows.push_back(Show(reply.row()));
      if (reply.has_quad()) {
        rows.rows.push_back(absl::StrCat(Show(reply.quad().subject()), " ", Show(reply.quad().predicate()),
                                         " ", Show(reply.quad().object())));
      }
    }
    rows.status = reader->Finish();
    return rows;
  }
  bool Ask(const std::string& pattern, uint64_t min_revision = 0) {
    Rows rows = Query("PREFIX : <urn:w:> ASK { " + pattern + " }", min_revision);
    EXPECT_TRUE(rows.status.ok()) << rows.status.error_message();
    return rows.header.boolean();
  }
  uint64_t Revision() { return Query("ASK {}").header.revision(); }

  grpc::Status Load(v1::LoadRequest::Kind kind, const std::string& name, const std::string& text,
                    v1::LoadReply* reply = nullptr) {
    v1::LoadRequest request;
    request.set_kind(kind);
    request.set_name(name);
    request.set_text(text);
    v1::LoadReply unused;
    return Call(ontologies_, &v1::Ontologies::Stub::Load, request, reply == nullptr ? &unused : reply);
  }
  grpc::Status Deploy(const std::string& name, const std::string& cawl, v1::DeployReply* reply = nullptr) {
    v1::DeployRequest request;
    request.set_name(name);
    request.set_cawl(cawl);
    v1::DeployReply unused;
    return Call(workflows_, &v1::Workflows::Stub::Deploy, request, reply == nullptr ? &unused : reply);
  }
  grpc::Status StartRun(const std::string& workflow, v1::StartReply* reply,
                        const std::string& request_id = "") {
    v1::StartRequest request;
    request.set_workflow(workflow);
    request.set_request_id(request_id);
    return Call(workflows_, &v1::Workflows::Stub::Start, request, reply);
  }
  v1::Run GetRun(const std::string& id) {
    v1::GetRunRequest request;
    request.set_run(id);
    v1::Run run;
    grpc::Status status = Call(workflows_, &v1::Workflows::Stub::Get, request, &run);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return run;
  }
  // Announces a robot that offers "greet".
  grpc::Status Join(const std::string& robot, const std::string& address, const std::string& type = "") {
    v1::JoinRequest request;
    request.set_address(address);
    request.mutable_description()->set_robot(robot);
    request.mutable_description()->set_label("a robot");
    request.mutable_description()->set_incarnation("i1");
    request.mutable_description()->set_type(type);
    request.mutable_description()->add_operations()->set_name("greet");
    v1::JoinReply reply;
    return Call(fleet_, &v1::Fleet::Stub::Join, request, &reply);
  }
  std::vector<v1::RobotStatus> Robots() {
    v1::ListRobotsReply reply;
    grpc::Status status = Call(fleet_, &v1::Fleet::Stub::List, v1::ListRobotsRequest(), &reply);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return {reply.robots().begin(), reply.robots().end()};
  }

  static std::string Show(const v1::Term& term) {
    if (term.kind_case() == v1::Term::kIri) return "<" + term.iri() + ">";
    if (term.kind_case() == v1::Term::kBlank) return "_:" + term.blank();
    if (term.kind_case() == v1::Term::kLiteral) return "\"" + term.literal().lexical() + "\"";
    return "-";
  }
  static std::string Show(const v1::Row& row) {
    std::string text;
    for (const v1::Term& value : row.values()) absl::StrAppend(&text, text.empty() ? "" : " ", Show(value));
    return text;
  }

  TestFolder folder_;
  ManualClock clock_{SystemClock().Now()};  // of no use unless settings_.clock points to it
  ServerSettings settings_;
  std::unique_ptr<Server> server_;
  std::shared_ptr<grpc::Channel> channel_;
  std::unique_ptr<v1::Context::Stub> context_;
  std::unique_ptr<v1::Ontologies::Stub> ontologies_;
  std::unique_ptr<v1::Workflows::Stub> workflows_;
  std::unique_ptr<v1::RobotServices::Stub> services_;
  std::unique_ptr<v1::Fleet::Stub> fleet_;
};

inline constexpr char kStates[] =
    "docent:isAt a docent:StateProperty . docent:status a docent:StateProperty .";

class ServerWorkflowTest : public ServerTest {
 protected:
  // Polls until the run reaches the state; fails after a long time.
  v1::Run WaitForRun(const std::string& id, const std::string& state) {
    v1::Run run = GetRun(id);
    for (int i = 0; i < 2000 && run.state() != state; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
      run = GetRun(id);
    }
    EXPECT_EQ(run.state(), state) << run.DebugString();
    return run;
  }
  static const v1::Node* FindNode(const v1::Run& run, const std::string& name) {
    for (const v1::Node& node : run.nodes()) {
      if (node.name() == name) return &node;
    }
    ADD_FAILURE() << "no node " << name;
    static const v1::Node* none = new v1::Node;
    return none;
  }
  void SetUpGreeting(const std::string& adapter = "127.0.0.1:1") {
    MustTell(kStates);
    ASSERT_TRUE(Join("urn:w:R1", adapter).ok());
    ASSERT_TRUE(Load(v1::LoadRequest::RULES, "near.rules", kRules).ok());
    grpc::Status status = Deploy("greeting.xml", kGreeting);
    ASSERT_TRUE(status.ok()) << status.error_message();
  }
  grpc::Status Register(const std::string& rsel, v1::RegisterReply* reply = nullptr) {
    v1::RegisterRequest request;
    request.set_name("services.xml");
    request.set_rsel(rsel);
    v1::RegisterReply unused;
    return Call(services_, &v1::RobotServices::Stub::Register, request, reply == nullptr ? &unused : reply);
  }
  std::vector<v1::InvokeServiceReply> Invoke(const std::string& name, grpc::Status* status,
                                             const std::string& request_id = "") {
    v1::InvokeServiceRequest request;
    request.set_name(name);
    request.set_request_id(request_id);
    grpc::ClientContext context;
    Limit(&context);
    auto reader = services_->Invoke(&context, request);
    std::vector<v1::InvokeServiceReply> replies;
    v1::InvokeServiceReply reply;
    while (reader->Read(&reply)) replies.push_back(reply);
    *status = reader->Finish();
    return replies;
  }
};

}  // namespace docent::server::test

#endif  // DOCENT_TESTS_KB_SERVER_SERVER_WORLD_H_
