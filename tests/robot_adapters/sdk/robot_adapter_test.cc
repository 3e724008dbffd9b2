// The adapter's side of proto/docent/v1/robot_adapter.proto over loopback gRPC.
#include "robot_adapters/sdk/robot_adapter.h"

#include <grpcpp/grpcpp.h>
#include <spdlog/sinks/ringbuffer_sink.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <stdexcept>
#include <thread>

#include "absl/synchronization/notification.h"
#include "docent/v1/robot_adapter.grpc.pb.h"
#include "graph/rdf/vocabulary.h"
#include "gtest/gtest.h"
#include "robot_adapters/sdk/command_journal.h"
#include "tests/robot_adapters/sdk/fake_server.h"

namespace docent::robot {
namespace {

constexpr char kRobot[] = "http://example.org/r1";

class RobotAdapterTest : public testing::Test {
 protected:
  RobotAdapterTest() {
    folder_ = testing::TempDir() + "adapter_" + testing::UnitTest::GetInstance()->current_test_info()->name();
    std::filesystem::remove_all(folder_);
  }

  void StartAdapter() {
    AdapterOptions options;
    options.robot = kRobot;
    options.label = "R1";
    options.server = server_.address();
    options.journal_path = folder_ + "/r1.journal";
    options.commands_running = 3;
    auto adapter = RobotAdapter::Start(options, Operations());
    ASSERT_TRUE(adapter.ok()) << adapter.status();
    adapter_ = *std::move(adapter);
    stub_ = v1::RobotAdapter::NewStub(
        grpc::CreateChannel(adapter_->address(), grpc::InsecureChannelCredentials()));
  }

  void AwaitJoined() {
    while (!adapter_->joined()) absl::SleepFor(absl::Milliseconds(1));
  }

  std::vector<Operation> Operations() {
    Operation add;
    add.name = "add";
    add.input_parts = {{"a", "xsd:integer"}, {"b", "xsd:integer"}};  // the names count as inputs
    add.outputs = {"sum"};
    add.idempotent = true;
    add.run = [this](OperationContext& context) -> absl::StatusOr<NamedTerms> {
      ++runs_;
      int sum = std::stoi(context.Argument("a")->lexical) + std::stoi(context.Argument("b")->lexical);
      return NamedTerms{{"sum", Term::Integer(sum)}};
    };
    Operation fail;
    fail.name = "fail";
    fail.run = [](OperationContext&) -> absl::StatusOr<NamedTerms> {
      return absl::InternalError("the wheel is stuck");
    };
    Operation wait;
    wait.name = "wait";
    wait.run = [this](OperationContext& context) -> absl::StatusOr<NamedTerms> {
      ++runs_;
      context.ReportProgress(0.254, "waiting");
      while (context.SleepFor(std::chrono::milliseconds(5))) {
        if (release_.load()) return NamedTerms{};
      }
      return absl::CancelledError("told to stop");
    };
    Operation explode;
    explode.name = "explode";
    explode.run = [](OperationContext&) -> absl::StatusOr<NamedTerms> { throw std::runtime_error("bang"); };
    return {add, fail, wait, explode};
  }

  static v1::InvokeRequest Request(const std::string& id, const std::string& operation) {
    v1::InvokeRequest request;
    request.set_command_id(id);
    request.set_operation(operation);
    return request;
  }
  static v1::InvokeRequest AddRequest(const std::string& id) {
    v1::InvokeRequest request = Request(id, "add");
    for (const char* name : {"a", "b"}) {
      v1::NamedTerm* argument = request.add_arguments();
      argument->set_name(name);
      argument->mutable_value()->mutable_literal()->set_lexical("20");
    }
    return request;
  }

  struct Call {
    std::vector<v1::Feedback> feedback;
    grpc::Status status;
    v1::Feedback::State last() const {
      return feedback.empty() ? v1::Feedback::STATE_UNSPECIFIED : feedback.back().state();
    }
  };
  // Reads the whole stream, calling `on_running` at the first RUNNING message.
  Call Read(std::unique_ptr<grpc::ClientReader<v1::Feedback>> reader, std::function<void()> on_running) {
    Call call;
    for (v1::Feedback feedback; reader->Read(&feedback);) {
      if (feedback.state() == v1::Feedback::RUNNING && on_running) std::exchange(on_running, nullptr)();
      call.feedback.push_back(feedback);
    }
    call.status = reader->Finish();
    return call;
  }
  Call Invoke(const v1::InvokeRequest& request, std::function<void()> on_running = nullptr) {
    grpc::ClientContext context;
    return Read(stub_->Invoke(&context, request), std::move(on_running));
  }
  Call Attach(const std::string& id, std::function<void()> on_running = nullptr) {
    grpc::ClientContext context;
    v1::AttachRequest request;
    request.set_command_id(id);
    return Read(stub_->Attach(&context, request), std::move(on_running));
  }
  bool Cancel(const std::string& id) {
    grpc::ClientContext context;
    v1::CancelRequest request;
    v1::CancelReply reply;
    request.set_command_id(id);
    EXPECT_TRUE(stub_->Cancel(&context, request, &reply).ok());
    return reply.known();
  }

  std::string folder_;
  FakeServer server_;
  std::atomic<int> runs_ = 0;
  std::atomic<bool> release_ = false;
  std::unique_ptr<RobotAdapter> adapter_;
  std::unique_ptr<v1::RobotAdapter::Stub> stub_;
};

TEST_F(RobotAdapterTest, DescribesItself) {
  StartAdapter();
  grpc::ClientContext context;
  v1::RobotDescription description;
  ASSERT_TRUE(stub_->Describe(&context, {}, &description).ok());
  EXPECT_EQ(description.robot(), kRobot);
  EXPECT_EQ(description.incarnation(), adapter_->incarnation());
  ASSERT_EQ(description.operations_size(), 4);
  ASSERT_EQ(description.operations(0).inputs_size(), 2);
  EXPECT_EQ(description.operations(0).inputs(1), "b");
  ASSERT_EQ(description.operations(0).input_parts_size(), 2);
  EXPECT_EQ(description.operations(0).input_parts(1).name(), "b");
  EXPECT_EQ(description.operations(0).input_parts(1).type(), "xsd:integer");
  EXPECT_EQ(description.operations(0).output_parts_size(), 0) << "described without types";
  EXPECT_EQ(description.operations(0).outputs(0), "sum");
  EXPECT_TRUE(description.operations(0).idempotent());
}

TEST_F(RobotAdapterTest, RunsAnOperationAndGivesItsResults) {
  StartAdapter();
  Call call = Invoke(AddRequest("c/1"));
  ASSERT_TRUE(call.status.ok()) << call.status.error_message();
  ASSERT_EQ(call.last(), v1::Feedback::SUCCEEDED);
  EXPECT_EQ(call.feedback.back().results(0).name(), "sum");
  EXPECT_EQ(call.feedback.back().results(0).value().literal().lexical(), "40");
  EXPECT_EQ(call.feedback.back().incarnation(), adapter_->incarnation());
}

TEST_F(RobotAdapterTest, RepeatedIdGetsTheFirstAnswerAndRunsOnce) {
  StartAdapter();
  Invoke(AddRequest("c/1"));
  Call again = Invoke(AddRequest("c/1"));
  EXPECT_EQ(again.last(), v1::Feedback::SUCCEEDED);
  EXPECT_EQ(again.feedback.back().results(0).value().literal().lexical(), "40");
  EXPECT_EQ(runs_, 1);
}

TEST_F(RobotAdapterTest, TwoInvokesOfARunningIdShareIt) {
  StartAdapter();
  Call second;
  Call first = Invoke(Request("c/1", "wait"), [&] {
    std::thread other([&] { second = Invoke(Request("c/1", "wait"), [&] { release_ = true; }); });
    other.join();
  });
  EXPECT_EQ(first.last(), v1::Feedback::SUCCEEDED);
  EXPECT_EQ(second.last(), v1::Feedback::SUCCEEDED);
  EXPECT_EQ(runs_, 1);
}

TEST_F(RobotAdapterTest, FailureCarriesItsReason) {
  StartAdapter();
  Call call = Invoke(Request("c/1", "fail"));
  EXPECT_EQ(call.last(), v1::Feedback::FAILED);
  EXPECT_EQ(call.feedback.back().message(), "the wheel is stuck");
}

TEST_F(RobotAdapterTest, OperationThatThrowsFails) {
  StartAdapter();
  Call call = Invoke(Request("c/1", "explode"));
  EXPECT_EQ(call.last(), v1::Feedback::FAILED);
  EXPECT_NE(call.feedback.back().message().find("bang"), std::string::npos);
}

TEST_F(RobotAdapterTest, RefusesWhatItCannotDo) {
  StartAdapter();
  EXPECT_EQ(Invoke(Request("c/1", "fly")).status.error_code(), grpc::StatusCode::NOT_FOUND);
  EXPECT_EQ(Invoke(Request("c/2", "add")).status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(Invoke(Request("", "wait")).status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(Attach("c/3").status.error_code(), grpc::StatusCode::NOT_FOUND);
  v1::InvokeRequest stale = AddRequest("c/4");
  stale.set_expected_incarnation("0-dead");
  EXPECT_EQ(Invoke(stale).status.error_code(), grpc::StatusCode::FAILED_PRECONDITION);
  EXPECT_EQ(runs_, 0);
}

TEST_F(RobotAdapterTest, OneCommandBeyondTheLimitIsRefused) {
  StartAdapter();
  absl::Notification full;
  std::vector<std::thread> threads;
  std::atomic<int> running = 0;
  for (int i = 0; i < 3; ++i) {
    threads.emplace_back([&, i] {
      Invoke(Request("c/" + std::to_string(i), "wait"), [&] {
        if (++running == 3) full.Notify();
      });
    });
  }
  full.WaitForNotification();
  EXPECT_EQ(Invoke(Request("c/3", "wait")).status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  release_ = true;
  for (std::thread& thread : threads) thread.join();
}

TEST_F(RobotAdapterTest, EndingTheStreamDoesNotEndTheCommandAndAttachFindsIt) {
  StartAdapter();
  grpc::ClientContext context;
  auto reader = stub_->Invoke(&context, Request("c/1", "wait"));
  v1::Feedback feedback;
  while (reader->Read(&feedback) && feedback.state() != v1::Feedback::RUNNING) {
  }
  context.TryCancel();
  reader->Finish();
  Call call = Attach("c/1", [&] { release_ = true; });
  ASSERT_FALSE(call.feedback.empty());
  EXPECT_EQ(call.feedback.front().message(), "waiting");
  EXPECT_EQ(call.last(), v1::Feedback::SUCCEEDED);
  EXPECT_EQ(runs_, 1);
}

TEST_F(RobotAdapterTest, CancelEndsTheOperation) {
  StartAdapter();
  Call call = Invoke(Request("c/1", "wait"), [&] { EXPECT_TRUE(Cancel("c/1")); });
  EXPECT_EQ(call.last(), v1::Feedback::CANCELLED);
  EXPECT_TRUE(Cancel("c/unknown")) << "it does not begin any more";
  EXPECT_EQ(Attach("c/1").last(), v1::Feedback::CANCELLED);
}

TEST_F(RobotAdapterTest, DeadlineEndsTheOperation) {
  StartAdapter();
  v1::InvokeRequest request = Request("c/1", "wait");
  request.set_deadline_us(SystemClock().Now() + 50'000);
  Call call = Invoke(request);
  EXPECT_EQ(call.last(), v1::Feedback::FAILED);
  EXPECT_NE(call.feedback.back().message().find("deadline"), std::string::npos);
}

TEST_F(RobotAdapterTest, RestartKnowsFinishedCommands) {
  StartAdapter();
  const std::string first = adapter_->incarnation();
  Invoke(AddRequest("c/1"));
  adapter_.reset();
  StartAdapter();
  EXPECT_NE(adapter_->incarnation(), first);
  v1::InvokeRequest request = AddRequest("c/1");
  request.set_expected_incarnation(first);  // known here, so the incarnation does not matter
  Call call = Invoke(request);
  EXPECT_EQ(call.last(), v1::Feedback::SUCCEEDED);
  EXPECT_EQ(call.feedback.back().results(0).value().literal().lexical(), "40");
  EXPECT_EQ(runs_, 1);
}

TEST_F(RobotAdapterTest, CommandThatDiedWithTheAdapterIsOfUnknownOutcomeAndNeverRepeated) {
  {
    // The journal of a killed adapter: a command begun, not finished.
    SystemClock clock;
    auto journal = CommandJournal::Open(folder_ + "/r1.journal", &clock);
    ASSERT_TRUE(journal.ok()) << journal.status();
    ASSERT_TRUE((*journal)->Begin(CommandId("c/1"), "add").ok());
  }
  StartAdapter();
  EXPECT_EQ(Attach("c/1").status.error_code(), grpc::StatusCode::FAILED_PRECONDITION);
  v1::InvokeRequest request = AddRequest("c/1");
  request.set_expected_incarnation(adapter_->incarnation());
  EXPECT_EQ(Invoke(request).status.error_code(), grpc::StatusCode::FAILED_PRECONDITION);
  EXPECT_EQ(runs_, 0);
}

TEST_F(RobotAdapterTest, ShutdownEndsRunningCommandsAsFailed) {
  StartAdapter();
  Call call;
  std::thread reader([&] { call = Invoke(Request("c/1", "wait"), [&] {}); });
  ASSERT_TRUE(server_.AwaitValue(kRobot, DocentIri("progress"), "0.25"));
  adapter_.reset();
  reader.join();
  StartAdapter();
  Call again = Attach("c/1");
  EXPECT_EQ(again.last(), v1::Feedback::FAILED);
  EXPECT_EQ(again.feedback.back().message(), "the robot's adapter was shut down");
}

TEST_F(RobotAdapterTest, AtItsEndItLeavesBeforeItsCommandsEnd) {
  StartAdapter();
  const std::string incarnation = adapter_->incarnation();
  Call call;
  std::thread reader([&] { call = Invoke(Request("c/1", "wait"), [&] {}); });
  ASSERT_TRUE(server_.AwaitValue(kRobot, DocentIri("progress"), "0.25"));
  AwaitJoined();
  adapter_->SetState(DocentIri("battery"), Term::Integer(86));
  adapter_->Shutdown();
  reader.join();
  adapter_->Shutdown();  // once more: nothing
  ASSERT_EQ(server_.leaves().size(), 1u);
  const FakeServer::Left left = server_.leaves()[0];
  EXPECT_EQ(left.request.robot(), kRobot);
  EXPECT_EQ(left.request.incarnation(), incarnation);
  EXPECT_EQ(server_.Value(kRobot, DocentIri("battery")), "86") << "what waited is told before";
  EXPECT_EQ(server_.Value(kRobot, DocentIri("status")), DocentIri("Busy")) << "no state is told afterwards";
  EXPECT_EQ(server_.batches().size(), left.batches);
}

TEST_F(RobotAdapterTest, AServerThatDoesNotAnswerItsLeaveDoesNotKeepItFromEnding) {
  StartAdapter();
  ASSERT_TRUE(server_.AwaitValue(kRobot, DocentIri("status"), DocentIri("Standby")));
  AwaitJoined();
  server_.AnswerLeaves(false);
  adapter_.reset();  // the server would answer after half a minute
  EXPECT_EQ(server_.leaves().size(), 1u);
  server_.AnswerLeaves(true);
}

TEST_F(RobotAdapterTest, WithoutAServerItEndsWithoutALeave) {
  StartAdapter();
  AwaitJoined();
  server_.Stop();
  adapter_.reset();
  EXPECT_TRUE(server_.leaves().empty());
}

TEST_F(RobotAdapterTest, TellsWhatItDoes) {
  StartAdapter();
  ASSERT_TRUE(server_.AwaitValue(kRobot, DocentIri("status"), DocentIri("Standby")));
  Invoke(Request("c/1", "wait"), [&] {
    EXPECT_TRUE(server_.AwaitValue(kRobot, DocentIri("status"), DocentIri("Busy")));
    EXPECT_TRUE(server_.AwaitValue(kRobot, DocentIri("currentCommand"), "c/1"));
    EXPECT_TRUE(server_.AwaitValue(kRobot, DocentIri("progress"), "0.25")) << "in hundredths";
    release_ = true;
  });
  EXPECT_TRUE(server_.AwaitValue(kRobot, DocentIri("status"), DocentIri("Standby")));
  EXPECT_TRUE(server_.AwaitValue(kRobot, DocentIri("currentCommand"), ""));
}

TEST_F(RobotAdapterTest, RenewsItsLease) {
  server_.SetLease(60);
  StartAdapter();
  ASSERT_TRUE(server_.AwaitJoins(4));
  EXPECT_EQ(server_.joins()[0].address(), adapter_->address());
  EXPECT_EQ(server_.joins()[0].description().incarnation(), adapter_->incarnation());
}

TEST_F(RobotAdapterTest, ServerThatComesBackIsJoinedAndToldTheStatesAgain) {
  StartAdapter();
  ASSERT_TRUE(server_.AwaitJoins(1));
  ASSERT_TRUE(server_.AwaitValue(kRobot, DocentIri("status"), DocentIri("Standby")));
  const size_t joins = server_.joins().size();
  server_.SetLease(50);
  server_.Stop();
  adapter_->SetState(DocentIri("battery"), Term::Integer(80));
  adapter_->SetState(DocentIri("battery"), Term::Integer(79));
  server_.Start(server_.port());
  EXPECT_TRUE(server_.AwaitJoins(joins + 1));
  EXPECT_TRUE(server_.AwaitValue(kRobot, DocentIri("battery"), "79"));
}

TEST_F(RobotAdapterTest, ThatTheServerIsAwayIsSaidOnce) {
  const auto log = std::make_shared<spdlog::sinks::ringbuffer_sink_mt>(100);
  spdlog::default_logger()->sinks().push_back(log);
  const auto said = [&log] {
    const std::vector<std::string> lines = log->last_formatted();
    return std::count_if(lines.begin(), lines.end(), [](const std::string& line) {
      return line.find("cannot join the fleet") != std::string::npos;
    });
  };
  server_.SetLease(60);
  StartAdapter();
  AwaitJoined();
  server_.Stop();
  while (said() == 0) absl::SleepFor(absl::Milliseconds(1));
  absl::SleepFor(absl::Seconds(1));  // it tries on
  EXPECT_EQ(said(), 1);
  adapter_.reset();
  spdlog::default_logger()->sinks().pop_back();
}

TEST_F(RobotAdapterTest, WithdrawsWhatAnEarlierLifeLeftBehind) {
  server_.AnswerRow("VALUES ?p", {DocentIri("currentCommand"), "run/old"});
  StartAdapter();
  auto withdrawn = [this] {
    for (const v1::AssertRequest& batch : server_.batches()) {
      for (const v1::Quad& quad : batch.remove()) {
        if (quad.object().literal().lexical() == "run/old") return true;
      }
    }
    return false;
  };
  for (int i = 0; i < 3000 && !withdrawn(); ++i) absl::SleepFor(absl::Milliseconds(10));
  EXPECT_TRUE(withdrawn());
}

TEST_F(RobotAdapterTest, QueriesTheServer) {
  StartAdapter();
  server_.AnswerRow("?r ?n", {"http://example.org/b3", ""});
  auto answer = adapter_->server().Query("SELECT ?r ?n {}", absl::Seconds(20));
  ASSERT_TRUE(answer.ok()) << answer.status();
  EXPECT_EQ(answer->revision, 9u);
  ASSERT_EQ(answer->rows.size(), 1u);
  EXPECT_EQ(answer->rows[0][0], Term::Iri("http://example.org/b3"));
  EXPECT_EQ(answer->rows[0][1], std::nullopt);
}

TEST_F(RobotAdapterTest, AProxyOfTheEnvironmentIsNotAsked) {
  setenv("http_proxy", "http://127.0.0.1:1", 1);
  ServerLink link(server_.address());
  unsetenv("http_proxy");
  server_.AnswerRow("?r", {"http://example.org/b3"});
  EXPECT_TRUE(link.Query("SELECT ?r {}", absl::Seconds(20)).ok());
}

TEST_F(RobotAdapterTest, PortInUseIsOneClearError) {
  StartAdapter();
  AdapterOptions options;
  options.robot = "http://example.org/r2";
  options.server = server_.address();
  options.listen = adapter_->address();
  auto second = RobotAdapter::Start(options, Operations());
  EXPECT_TRUE(absl::IsUnavailable(second.status())) << second.status();
  options.robot = "r2";
  EXPECT_TRUE(absl::IsInvalidArgument(RobotAdapter::Start(options, Operations()).status()));
}

}  // namespace
}  // namespace docent::robot
