// The proxies against scripted adapters that misbehave: they hang, drop the stream, die, or say what cannot be.
#include <grpcpp/grpcpp.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include <atomic>
#include <cmath>
#include <sstream>

#include "absl/strings/str_cat.h"
#include "docent/v1/robot_adapter.grpc.pb.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "robot_adapters/proxy/robot_proxies.h"
#include "tests/robot_adapters/proxy/proxy_reports.h"

namespace docent::proxy {
namespace {

using test::Command;
using test::FastSettings;
using test::kRobot;
using test::Outcome;
using test::Reports;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// An adapter that a test controls: it hangs, drops the stream, or dies.
class ScriptedAdapter final : public v1::RobotAdapter::Service {
 public:
  enum class Behaviour { kHang, kAcceptAndHang, kAcceptAndDrop, kEndWithoutFinal, kSucceed, kScript };

  ScriptedAdapter() { Start(0); }
  ~ScriptedAdapter() override { Stop(); }
  void Start(int port) {
    stopping_ = false;
    grpc::ServerBuilder builder;
    builder.AddListeningPort(absl::StrCat("127.0.0.1:", port), grpc::InsecureServerCredentials(), &port_);
    builder.RegisterService(this);
    server_ = builder.BuildAndStart();
  }
  void Stop() {
    stopping_ = true;
    if (server_ != nullptr) server_->Shutdown(std::chrono::system_clock::now());
    server_.reset();
  }
  std::string address() const { return absl::StrCat("127.0.0.1:", port_); }
  int port() const { return port_; }

  grpc::Status Invoke(grpc::ServerContext* context, const v1::InvokeRequest* request,
                      grpc::ServerWriter<v1::Feedback>* writer) override {
    ++invokes;
    if (++in_flight > 1) overlapped = true;
    grpc::Status status = Act(context, request->command_id(), on_invoke, writer);
    --in_flight;
    return status;
  }
  grpc::Status Attach(grpc::ServerContext* context, const v1::AttachRequest* request,
                      grpc::ServerWriter<v1::Feedback>* writer) override {
    ++attaches;
    if (attach_not_found) return grpc::Status(grpc::StatusCode::NOT_FOUND, "never begun");
    if (attach_lost) return grpc::Status(grpc::StatusCode::FAILED_PRECONDITION, "died with incarnation 1");
    return Act(context, request->command_id(), on_attach, writer);
  }
  grpc::Status Cancel(grpc::ServerContext*, const v1::CancelRequest*, v1::CancelReply*) override {
    ++cancels;
    return grpc::Status::OK;
  }

  // kScript: sends these, each with the command's id and incarnation where it has none.
  std::vector<v1::Feedback> script;
  std::atomic<Behaviour> on_invoke = Behaviour::kSucceed;
  std::atomic<Behaviour> on_attach = Behaviour::kSucceed;
  std::atomic<bool> attach_not_found = false;
  std::atomic<bool> attach_lost = false;
  std::atomic<int> invokes = 0;
  std::atomic<int> attaches = 0;
  std::atomic<int> cancels = 0;
  std::atomic<int> in_flight = 0;
  std::atomic<bool> overlapped = false;

 private:
  grpc::Status Act(grpc::ServerContext* context, const std::string& command, Behaviour behaviour,
                   grpc::ServerWriter<v1::Feedback>* writer) {
    if (behaviour == Behaviour::kScript) {
      for (v1::Feedback message : script) {
        if (message.command_id().empty()) message.set_command_id(command);
        if (message.incarnation().empty()) message.set_incarnation("1-script");
        writer->Write(message);
      }
      return grpc::Status::OK;
    }
    v1::Feedback feedback;
    feedback.set_command_id(command);
    feedback.set_incarnation("1-script");
    feedback.set_state(v1::Feedback::ACCEPTED);
    if (behaviour != Behaviour::kHang) writer->Write(feedback);
    if (behaviour == Behaviour::kAcceptAndDrop)
      return grpc::Status(grpc::StatusCode::UNAVAILABLE, "going down");
    if (behaviour == Behaviour::kEndWithoutFinal) return grpc::Status::OK;
    if (behaviour == Behaviour::kSucceed) {
      feedback.set_state(v1::Feedback::SUCCEEDED);
      writer->Write(feedback);
      return grpc::Status::OK;
    }
    while (!context->IsCancelled() && !stopping_) absl::SleepFor(absl::Milliseconds(2));
    return grpc::Status::CANCELLED;
  }

  int port_ = 0;
  std::atomic<bool> stopping_ = false;
  std::unique_ptr<grpc::Server> server_;
};

class MisbehavingAdapterTest : public testing::Test {
 protected:
  MisbehavingAdapterTest() { proxies_.SetAdapter(RobotId(kRobot), adapter_.address(), ""); }

  ScriptedAdapter adapter_;
  Reports reports_;
  RobotProxies proxies_{[this](WriteBatch batch) { reports_.Take(std::move(batch)); }, FastSettings()};
};

TEST_F(MisbehavingAdapterTest, ACommandThatOvertakesItsDeadlineIsCancelledAndItsEndAwaited) {
  for (const auto behaviour :
       {ScriptedAdapter::Behaviour::kHang, ScriptedAdapter::Behaviour::kAcceptAndHang}) {
    const std::string id = behaviour == ScriptedAdapter::Behaviour::kHang ? "c/1" : "c/2";
    adapter_.on_invoke = ScriptedAdapter::Behaviour::kSucceed;
    proxies_.SetAdapter(RobotId(kRobot), adapter_.address(), "");
    proxies_.Send(Command("before " + id, "drive"));
    reports_.AwaitFinal("before " + id);  // there is a connection: the next one goes out before its deadline
    adapter_.on_invoke = behaviour;
    adapter_.cancels = 0;
    proxies_.Send(Command(id, "drive", 1500));
    while (adapter_.cancels == 0) absl::SleepFor(absl::Milliseconds(1));
    absl::SleepFor(absl::Milliseconds(100));
    for (const Outcome outcome : reports_.Outcomes(id))
      EXPECT_EQ(outcome, Outcome::kAccepted) << "not the end";
    ScriptedAdapter moved;
    moved.on_attach = ScriptedAdapter::Behaviour::kSucceed;
    proxies_.SetAdapter(RobotId(kRobot), moved.address(), "");
    EXPECT_EQ(reports_.AwaitFinal(id).outcome, Outcome::kSucceeded) << "the truth, however late";
  }
}

TEST_F(MisbehavingAdapterTest, LostStreamIsAttachedToAgain) {
  adapter_.on_invoke = ScriptedAdapter::Behaviour::kAcceptAndDrop;
  proxies_.Send(Command("c/1", "drive"));
  EXPECT_EQ(reports_.AwaitFinal("c/1").outcome, Outcome::kSucceeded);
  EXPECT_THAT(reports_.Outcomes("c/1"),
              ElementsAre(Outcome::kAccepted, Outcome::kUnreachable, Outcome::kSucceeded));
  EXPECT_EQ(adapter_.invokes, 1);
  EXPECT_EQ(adapter_.attaches, 1);
}

TEST_F(MisbehavingAdapterTest, StreamThatEndsWithoutAFinalStateIsAttachedToAgain) {
  adapter_.on_invoke = ScriptedAdapter::Behaviour::kEndWithoutFinal;
  proxies_.Send(Command("c/1", "drive"));
  EXPECT_EQ(reports_.AwaitFinal("c/1").outcome, Outcome::kSucceeded);
  EXPECT_EQ(adapter_.invokes, 1);
}

TEST_F(MisbehavingAdapterTest, DeathMidCommandAndOutcomeUnknownAfterwards) {
  adapter_.on_invoke = ScriptedAdapter::Behaviour::kAcceptAndHang;
  proxies_.Send(Command("c/1", "drive"));
  reports_.Await("c/1", Outcome::kAccepted);
  adapter_.Stop();
  reports_.Await("c/1", Outcome::kUnreachable);
  adapter_.attach_lost = true;
  adapter_.Start(adapter_.port());
  CommandReport report = reports_.AwaitFinal("c/1");
  EXPECT_EQ(report.outcome, Outcome::kUnknown);
  EXPECT_EQ(report.message, "died with incarnation 1");
  EXPECT_EQ(adapter_.invokes, 1);
  EXPECT_THAT(reports_.Outcomes("c/1"),
              ElementsAre(Outcome::kAccepted, Outcome::kUnreachable, Outcome::kUnknown));
}

TEST_F(MisbehavingAdapterTest, DeathBeforeTheInvokeArrivedIsInvokedAgainWithoutOverlap) {
  adapter_.Stop();
  RobotCommand command = Command("c/1", "drive");
  command.expected_incarnation = "1-script";
  proxies_.Send(command);
  reports_.Await("c/1", Outcome::kUnreachable);
  adapter_.attach_not_found = true;
  adapter_.Start(adapter_.port());
  EXPECT_EQ(reports_.AwaitFinal("c/1").outcome, Outcome::kSucceeded);
  EXPECT_EQ(adapter_.invokes, 1);
  EXPECT_FALSE(adapter_.overlapped);
}

v1::Feedback Message(v1::Feedback::State state, const std::string& command = "",
                     const std::string& incarnation = "") {
  v1::Feedback feedback;
  feedback.set_state(state);
  feedback.set_command_id(command);
  feedback.set_incarnation(incarnation);
  return feedback;
}

TEST_F(MisbehavingAdapterTest, FeedbackOfAnotherCommandIsRefusedAndRecorded) {
  adapter_.on_invoke = ScriptedAdapter::Behaviour::kScript;
  adapter_.script = {Message(v1::Feedback::ACCEPTED), Message(v1::Feedback::SUCCEEDED, "somebody/else"),
                     Message(v1::Feedback::FAILED, "c/2"), Message(v1::Feedback::SUCCEEDED)};
  proxies_.Send(Command("c/1", "drive"));
  EXPECT_EQ(reports_.AwaitFinal("c/1").outcome, Outcome::kSucceeded);
  EXPECT_THAT(reports_.Outcomes("c/1"),
              ElementsAre(Outcome::kAccepted, Outcome::kRefused, Outcome::kSucceeded));
  EXPECT_THAT(reports_.Await("c/1", Outcome::kRefused).message,
              HasSubstr("is refused: it is about command somebody/else"));
  EXPECT_EQ(proxies_.refused_feedback(), 2u);
  EXPECT_THAT(reports_.Outcomes("somebody/else"), IsEmpty());
}

// What is wrong is said once of each command; the others are counted.
TEST_F(MisbehavingAdapterTest, AFloodOfWrongFeedbackDoesNotFloodTheLog) {
  std::ostringstream log;
  const auto before = spdlog::default_logger();
  spdlog::set_default_logger(
      std::make_shared<spdlog::logger>("test", std::make_shared<spdlog::sinks::ostream_sink_mt>(log)));
  adapter_.on_invoke = ScriptedAdapter::Behaviour::kScript;
  adapter_.script.assign(70, Message(v1::Feedback::RUNNING, "x\n12:00:00 error forged"));
  adapter_.script.push_back(Message(v1::Feedback::SUCCEEDED));
  proxies_.Send(Command("c/1", "drive"));
  reports_.AwaitFinal("c/1");
  while (proxies_.open() > 0) absl::SleepFor(absl::Milliseconds(1));
  spdlog::set_default_logger(before);
  EXPECT_EQ(proxies_.refused_feedback(), 70u);
  const std::string text = log.str();
  size_t refusals = 0;
  for (size_t at = text.find("refused"); at != std::string::npos; at = text.find("refused", at + 1))
    ++refusals;
  EXPECT_EQ(refusals, 2u) << text;
  EXPECT_THAT(text, HasSubstr("feedback about command c/1 was refused 70 times"));
}

TEST_F(MisbehavingAdapterTest, FeedbackThatCannotFollowIsRefused) {
  v1::Feedback nan = Message(v1::Feedback::RUNNING);
  nan.set_progress(std::nan(""));
  adapter_.on_invoke = ScriptedAdapter::Behaviour::kScript;
  adapter_.script = {Message(v1::Feedback::RUNNING),
                     Message(v1::Feedback::ACCEPTED),
                     nan,
                     Message(v1::Feedback::STATE_UNSPECIFIED),
                     Message(static_cast<v1::Feedback::State>(17)),
                     Message(v1::Feedback::RUNNING, "", "2-other"),
                     Message(v1::Feedback::SUCCEEDED)};
  proxies_.Send(Command("c/1", "drive"));
  EXPECT_EQ(reports_.AwaitFinal("c/1").outcome, Outcome::kSucceeded);
  EXPECT_EQ(proxies_.refused_feedback(), 5u);
  EXPECT_THAT(reports_.Await("c/1", Outcome::kRefused).message, HasSubstr("it says ACCEPTED after RUNNING"));
}

TEST_F(MisbehavingAdapterTest, FeedbackAfterTheEndIsRefused) {
  adapter_.on_invoke = ScriptedAdapter::Behaviour::kScript;
  adapter_.script = {Message(v1::Feedback::FAILED), Message(v1::Feedback::SUCCEEDED),
                     Message(v1::Feedback::SUCCEEDED)};
  proxies_.Send(Command("c/1", "drive"));
  EXPECT_EQ(reports_.AwaitFinal("c/1").outcome, Outcome::kFailed);
  for (int i = 0; i < 5000 && proxies_.refused_feedback() < 2; ++i) absl::SleepFor(absl::Milliseconds(1));
  EXPECT_EQ(proxies_.refused_feedback(), 2u);
  EXPECT_THAT(reports_.Outcomes("c/1"), ElementsAre(Outcome::kFailed));
}

TEST_F(MisbehavingAdapterTest, AnotherIncarnationThatAnswersAnInvokeMakesTheOutcomeUnknown) {
  adapter_.on_invoke = ScriptedAdapter::Behaviour::kScript;
  adapter_.script = {Message(v1::Feedback::ACCEPTED, "", "2-other"),
                     Message(v1::Feedback::SUCCEEDED, "", "2-other")};
  RobotCommand command = Command("c/1", "drive");
  command.expected_incarnation = "1-script";
  proxies_.Send(command);
  const CommandReport report = reports_.AwaitFinal("c/1");
  EXPECT_EQ(report.outcome, Outcome::kUnknown);
  EXPECT_EQ(report.incarnation, "2-other");
  EXPECT_THAT(report.message,
              HasSubstr("meant for incarnation 1-script of the adapter, and 2-other answers"));
  EXPECT_GE(proxies_.refused_feedback(), 1u);
}

TEST_F(MisbehavingAdapterTest, ResultsThatCannotBeValuesAreLeftOut) {
  v1::Feedback done = Message(v1::Feedback::SUCCEEDED);
  const auto add = [&done](const std::string& name) -> v1::Term* {
    v1::NamedTerm* result = done.add_results();
    result->set_name(name);
    return result->mutable_value();
  };
  add("good")->set_iri("urn:b7");
  add("unset");
  add("relative")->set_iri("not an iri");
  add("a\nb")->set_iri("urn:b7");
  add("")->set_iri("urn:b7");
  v1::Literal* nan = add("nan")->mutable_literal();
  nan->set_lexical("NaN");
  nan->set_datatype("http://www.w3.org/2001/XMLSchema#double");
  adapter_.on_invoke = ScriptedAdapter::Behaviour::kScript;
  adapter_.script = {done};
  proxies_.Send(Command("c/1", "drive"));
  const CommandReport report = reports_.AwaitFinal("c/1");
  EXPECT_EQ(report.outcome, Outcome::kSucceeded);
  ASSERT_EQ(report.results.size(), 1u);
  EXPECT_EQ(report.results[0].first, "good");
  const std::string why = reports_.Await("c/1", Outcome::kRefused).message;
  EXPECT_THAT(why, HasSubstr("its result unset has no value"));
  EXPECT_THAT(why, HasSubstr("its result relative has a value that cannot be taken"));
  EXPECT_THAT(why, HasSubstr("U+000A"));
  EXPECT_THAT(why, HasSubstr("has no name"));
  EXPECT_THAT(why, HasSubstr("its result nan is"));
}

TEST_F(MisbehavingAdapterTest, RobotThatMovedToAnotherAddressIsFollowed) {
  adapter_.on_invoke = ScriptedAdapter::Behaviour::kAcceptAndHang;
  proxies_.Send(Command("c/1", "drive"));
  reports_.Await("c/1", Outcome::kAccepted);
  ScriptedAdapter other;
  proxies_.SetAdapter(RobotId(kRobot), other.address(), "");
  EXPECT_EQ(reports_.AwaitFinal("c/1").outcome, Outcome::kSucceeded);
  EXPECT_EQ(other.attaches, 1);
  EXPECT_EQ(other.invokes, 0);
}

TEST_F(MisbehavingAdapterTest, DestructionWithCommandsUnderWayEndsAtOnce) {
  adapter_.on_invoke = ScriptedAdapter::Behaviour::kAcceptAndHang;
  Reports reports;
  auto proxies = std::make_unique<RobotProxies>([&](WriteBatch batch) { reports.Take(std::move(batch)); });
  proxies->SetAdapter(RobotId(kRobot), adapter_.address(), "");
  proxies->Send(Command("c/1", "drive"));
  reports.Await("c/1", Outcome::kAccepted);
  proxies.reset();
  EXPECT_THAT(reports.Outcomes("c/1"), ElementsAre(Outcome::kAccepted));
}

}  // namespace
}  // namespace docent::proxy
