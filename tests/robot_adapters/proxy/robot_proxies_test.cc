// The proxies against real adapters over loopback: adapters made with the sdk, and scripted ones that
// misbehave.
#include "robot_adapters/proxy/robot_proxies.h"

#include <grpcpp/grpcpp.h>

#include <atomic>
#include <cmath>
#include <filesystem>

#include "absl/strings/str_cat.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"
#include "docent/v1/robot_adapter.grpc.pb.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "robot_adapters/sdk/robot_adapter.h"

namespace docent::proxy {
namespace {

using Outcome = CommandReport::Outcome;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr char kRobot[] = "http://example.org/r1";

bool IsFinalOutcome(Outcome outcome) {
  return outcome == Outcome::kSucceeded || outcome == Outcome::kFailed || outcome == Outcome::kCancelled ||
         outcome == Outcome::kUnknown;
}

// The reports of the proxies, with waiting.
class Reports {
 public:
  void Take(WriteBatch batch) {
    absl::MutexLock lock(&mutex_);
    for (CommandReport& report : batch.reports) reports_.push_back(std::move(report));
  }
  // The first report of this kind for the command; fails the test after half a minute.
  CommandReport Await(const std::string& command, Outcome outcome) {
    return AwaitMatching(command, [&](const CommandReport& report) { return report.outcome == outcome; });
  }
  CommandReport AwaitFinal(const std::string& command) {
    return AwaitMatching(command, [](const CommandReport& report) { return IsFinalOutcome(report.outcome); });
  }
  std::vector<Outcome> Outcomes(const std::string& command) {
    absl::MutexLock lock(&mutex_);
    std::vector<Outcome> outcomes;
    for (const CommandReport& report : reports_) {
      if (report.command.value() == command) outcomes.push_back(report.outcome);
    }
    return outcomes;
  }

 private:
  CommandReport AwaitMatching(const std::string& command,
                              const std::function<bool(const CommandReport&)>& matches) {
    absl::MutexLock lock(&mutex_);
    CommandReport found;
    auto there = [&]() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
      for (const CommandReport& report : reports_) {
        if (report.command.value() != command || !matches(report)) continue;
        found = report;
        return true;
      }
      return false;
    };
    EXPECT_TRUE(mutex_.AwaitWithTimeout(absl::Condition(&there), absl::Seconds(30)))
        << "no such report for " << command;
    return found;
  }

  absl::Mutex mutex_;
  std::vector<CommandReport> reports_;
};

ProxySettings FastSettings() {
  ProxySettings settings;
  settings.first_retry = std::chrono::milliseconds(10);
  settings.last_retry = std::chrono::milliseconds(50);
  settings.grace = std::chrono::milliseconds(100);
  return settings;
}

RobotCommand Command(const std::string& id, const std::string& operation, int deadline_ms = 20000) {
  RobotCommand command;
  command.id = CommandId(id);
  command.robot = RobotId(kRobot);
  command.operation = operation;
  command.arguments = {{"booth", Term::Iri("http://example.org/b3")}};
  command.deadline_us = SystemClock().Now() + deadline_ms * int64_t{1000};
  return command;
}

// An adapter made with the sdk, which can be stopped and started at the same address.
class RobotProxiesTest : public testing::Test {
 protected:
  RobotProxiesTest() {
    folder_ = testing::TempDir() + "proxies_" + testing::UnitTest::GetInstance()->current_test_info()->name();
    std::filesystem::remove_all(folder_);
  }
  ~RobotProxiesTest() override { release_ = true; }

  void StartAdapter(bool with_journal = true) {
    robot::AdapterOptions options;
    options.robot = kRobot;
    options.server = "127.0.0.1:1";  // no server: facts do not matter here
    options.listen = address_;
    options.linger = absl::ZeroDuration();
    if (with_journal) options.journal_path = folder_ + "/r1.journal";
    auto adapter = robot::RobotAdapter::Start(options, Operations());
    ASSERT_TRUE(adapter.ok()) << adapter.status();
    adapter_ = *std::move(adapter);
    address_ = adapter_->address();
    proxies_.SetAdapter(RobotId(kRobot), address_, "");
  }

  std::vector<robot::Operation> Operations() {
    robot::Operation quick;
    quick.name = "quick";
    quick.inputs = {"booth"};
    quick.run = [this](robot::OperationContext& context) -> absl::StatusOr<robot::NamedTerms> {
      ++runs_;
      return robot::NamedTerms{{"at", *context.Argument("booth")}};
    };
    robot::Operation wait;
    wait.name = "wait";
    wait.run = [this](robot::OperationContext& context) -> absl::StatusOr<robot::NamedTerms> {
      ++runs_;
      for (int i = 1;; ++i) {
        context.ReportProgress(i / 1000.0, "waiting");
        if (!context.SleepFor(std::chrono::milliseconds(2))) return absl::CancelledError("stopped");
        if (release_.load()) return robot::NamedTerms{};
      }
    };
    return {quick, wait};
  }

  // A command as the engine gives it: decided for the adapter that is connected now.
  RobotCommand Decided(const std::string& id, const std::string& operation, int deadline_ms = 20000) {
    RobotCommand command = Command(id, operation, deadline_ms);
    command.expected_incarnation = adapter_->incarnation();
    return command;
  }

  std::string folder_;
  std::string address_ = "127.0.0.1:0";
  std::atomic<int> runs_ = 0;
  std::atomic<bool> release_ = false;
  Reports reports_;
  std::unique_ptr<robot::RobotAdapter> adapter_;
  RobotProxies proxies_{[this](WriteBatch batch) { reports_.Take(std::move(batch)); }, FastSettings()};
};

TEST_F(RobotProxiesTest, CommandSucceedsWithItsResults) {
  StartAdapter();
  proxies_.Send(Decided("c/1", "quick"));
  CommandReport report = reports_.AwaitFinal("c/1");
  EXPECT_EQ(report.outcome, Outcome::kSucceeded);
  EXPECT_EQ(report.incarnation, adapter_->incarnation());
  ASSERT_EQ(report.results.size(), 1u);
  EXPECT_EQ(report.results[0].second, Term::Iri("http://example.org/b3"));
  EXPECT_EQ(runs_, 1);
}

TEST_F(RobotProxiesTest, SameIdTwiceIsDoneOnce) {
  StartAdapter();
  proxies_.Send(Decided("c/1", "wait"));
  proxies_.Send(Decided("c/1", "wait"));
  reports_.Await("c/1", Outcome::kAccepted);
  release_ = true;
  reports_.AwaitFinal("c/1");
  proxies_.Send(Decided("c/2", "quick"));
  reports_.AwaitFinal("c/2");
  EXPECT_EQ(runs_, 2);
}

TEST_F(RobotProxiesTest, ProgressIsReportedNowAndThenOnly) {
  StartAdapter();
  proxies_.Send(Decided("c/1", "wait"));
  reports_.Await("c/1", Outcome::kProgress);
  absl::SleepFor(absl::Milliseconds(100));  // some fifty progress messages
  release_ = true;
  reports_.AwaitFinal("c/1");
  auto outcomes = reports_.Outcomes("c/1");
  EXPECT_EQ(outcomes.front(), Outcome::kAccepted);
  EXPECT_LT(outcomes.size(), 20u);
}

// Nothing goes out before there is a connection, so it is known that the adapter does not have the command.
TEST_F(RobotProxiesTest, AbsentAdapterIsUnreachableOnceThenFailedNamingTheAddress) {
  proxies_.SetAdapter(RobotId(kRobot), "127.0.0.1:1", "");
  proxies_.Send(Command("c/1", "quick", 300));
  CommandReport report = reports_.AwaitFinal("c/1");
  EXPECT_EQ(report.outcome, Outcome::kFailed);
  EXPECT_THAT(report.message, HasSubstr("adapter at 127.0.0.1:1 did not take quick"));
  EXPECT_THAT(reports_.Outcomes("c/1"), ElementsAre(Outcome::kUnreachable, Outcome::kFailed));
  StartAdapter();
  proxies_.Send(Command("c/2", "quick"));
  EXPECT_EQ(reports_.AwaitFinal("c/2").outcome, Outcome::kSucceeded);
  EXPECT_EQ(runs_, 1);
}

TEST_F(RobotProxiesTest, ACommandThatNeverWentOutIsSentToAnAdapterThatComesInTime) {
  proxies_.SetAdapter(RobotId(kRobot), "127.0.0.1:1", "");
  proxies_.Send(Command("c/1", "quick"));  // not idempotent
  reports_.Await("c/1", Outcome::kUnreachable);
  StartAdapter();
  EXPECT_EQ(reports_.AwaitFinal("c/1").outcome, Outcome::kSucceeded);
  EXPECT_EQ(runs_, 1);
}

// A call over a connection that breaks may have reached the adapter: after the deadline, too, only an adapter can tell.
TEST_F(RobotProxiesTest, ACommandThatMayHaveGoneOutIsUnknownWhenItsAdapterComesBackWithoutIt) {
  StartAdapter();
  proxies_.Resume(Command("c/1", "quick", 300));
  adapter_.reset();
  absl::SleepFor(absl::Milliseconds(500));
  StartAdapter();
  EXPECT_EQ(reports_.AwaitFinal("c/1").outcome, Outcome::kUnknown);
  EXPECT_EQ(runs_, 0);
}

TEST_F(RobotProxiesTest, ACommandForARobotWithoutAddressFailsAtItsDeadline) {
  proxies_.Send(Command("c/1", "quick", 300));
  CommandReport report = reports_.AwaitFinal("c/1");
  EXPECT_EQ(report.outcome, Outcome::kFailed) << "it was never sent";
  EXPECT_THAT(report.message, HasSubstr("has no adapter"));
}

TEST_F(RobotProxiesTest, RobotWithoutAddressIsUnreachableUntilItJoins) {
  RobotCommand command = Command("c/1", "quick");
  command.idempotent = true;
  proxies_.Send(command);
  reports_.Await("c/1", Outcome::kUnreachable);
  StartAdapter();
  EXPECT_EQ(reports_.AwaitFinal("c/1").outcome, Outcome::kSucceeded);
  EXPECT_EQ(runs_, 1);
}

TEST_F(RobotProxiesTest, AdapterThatComesLateIsInvokedThen) {
  StartAdapter();
  adapter_.reset();
  RobotCommand command = Command("c/1", "quick");
  command.idempotent = true;  // the adapter died: it is unknown whether it received the Invoke
  proxies_.Send(command);
  reports_.Await("c/1", Outcome::kUnreachable);
  StartAdapter();
  EXPECT_EQ(reports_.AwaitFinal("c/1").outcome, Outcome::kSucceeded);
  EXPECT_EQ(runs_, 1);
}

TEST_F(RobotProxiesTest, RestartOfTheAdapterWithAJournalTellsTheOutcome) {
  StartAdapter();
  proxies_.Send(Decided("c/1", "wait"));
  reports_.Await("c/1", Outcome::kAccepted);
  adapter_.reset();  // ends the command as failed and remembers that
  StartAdapter();
  CommandReport report = reports_.AwaitFinal("c/1");
  EXPECT_EQ(report.outcome, Outcome::kFailed);
  EXPECT_EQ(report.message, "the robot's adapter was shut down");
  EXPECT_EQ(runs_, 1);
}

TEST_F(RobotProxiesTest, CommandForAnEarlierIncarnationIsUnknown) {
  StartAdapter(/*with_journal=*/false);
  RobotCommand command = Command("c/1", "quick");
  command.expected_incarnation = "1-before";
  proxies_.Send(command);
  EXPECT_EQ(reports_.AwaitFinal("c/1").outcome, Outcome::kUnknown);
  proxies_.Resume([&] {
    command.id = CommandId("c/2");
    return command;
  }());
  EXPECT_EQ(reports_.AwaitFinal("c/2").outcome, Outcome::kUnknown);
  EXPECT_EQ(runs_, 0);
}

TEST_F(RobotProxiesTest, ResumeOfACommandThatRunsAttachesToIt) {
  StartAdapter();
  RobotCommand command = Decided("c/1", "wait");
  {
    Reports earlier;
    RobotProxies before([&](WriteBatch batch) { earlier.Take(std::move(batch)); }, FastSettings());
    before.SetAdapter(RobotId(kRobot), address_, "");
    before.Send(command);
    earlier.Await("c/1", Outcome::kAccepted);
  }
  proxies_.Resume(command);
  reports_.Await("c/1", Outcome::kAccepted);
  release_ = true;
  EXPECT_EQ(reports_.AwaitFinal("c/1").outcome, Outcome::kSucceeded);
  EXPECT_EQ(runs_, 1);
}

TEST_F(RobotProxiesTest, ResumeOfACommandThatWasNeverSentInvokesIt) {
  StartAdapter();
  RobotCommand command = Decided("c/1", "quick");
  proxies_.Resume(command);
  EXPECT_EQ(reports_.AwaitFinal("c/1").outcome, Outcome::kSucceeded);
  EXPECT_EQ(runs_, 1);
}

TEST_F(RobotProxiesTest, ResumeOfAFinishedCommandTellsItsOutcomeEvenAfterItsDeadline) {
  StartAdapter();
  RobotCommand command = Decided("c/1", "quick");
  proxies_.Send(command);
  reports_.AwaitFinal("c/1");
  adapter_.reset();
  StartAdapter();
  Reports after;
  RobotProxies restarted([&](WriteBatch batch) { after.Take(std::move(batch)); }, FastSettings());
  restarted.SetAdapter(RobotId(kRobot), address_, "");
  command.deadline_us = 1;
  restarted.Resume(command);
  CommandReport report = after.AwaitFinal("c/1");
  EXPECT_EQ(report.outcome, Outcome::kSucceeded);
  EXPECT_EQ(report.results.size(), 1u);
  EXPECT_EQ(runs_, 1);
}

TEST_F(RobotProxiesTest, ResumeWithoutKnownIncarnationInvokesOnlyIdempotentOperations) {
  StartAdapter();
  proxies_.Resume(Command("c/1", "quick"));
  EXPECT_EQ(reports_.AwaitFinal("c/1").outcome, Outcome::kUnknown);
  RobotCommand idempotent = Command("c/2", "quick");
  idempotent.idempotent = true;
  proxies_.Resume(idempotent);
  EXPECT_EQ(reports_.AwaitFinal("c/2").outcome, Outcome::kSucceeded);
}

TEST_F(RobotProxiesTest, CancelReachesTheRobot) {
  StartAdapter();
  proxies_.Send(Decided("c/1", "wait"));
  reports_.Await("c/1", Outcome::kAccepted);
  proxies_.Cancel(CommandId("c/1"));
  EXPECT_EQ(reports_.AwaitFinal("c/1").outcome, Outcome::kCancelled);
}

TEST_F(RobotProxiesTest, CancelOfACommandThatWasNeverSentEndsItHere) {
  proxies_.Send(Command("c/1", "wait"));
  proxies_.Cancel(CommandId("c/1"));
  proxies_.Cancel(CommandId("c/other"));
  EXPECT_EQ(reports_.AwaitFinal("c/1").outcome, Outcome::kCancelled);
}

TEST_F(RobotProxiesTest, OperationThatIsNotOfferedFailsWithTheAdaptersWords) {
  StartAdapter();
  proxies_.Send(Decided("c/1", "fly"));
  CommandReport report = reports_.AwaitFinal("c/1");
  EXPECT_EQ(report.outcome, Outcome::kFailed);
  EXPECT_THAT(report.message, HasSubstr("no operation \"fly\""));
}

TEST_F(RobotProxiesTest, AdapterGivesUpAtTheDeadline) {
  StartAdapter();
  proxies_.Send(Decided("c/1", "wait", 200));
  CommandReport report = reports_.AwaitFinal("c/1");
  EXPECT_EQ(report.outcome, Outcome::kFailed);
  EXPECT_THAT(report.message, HasSubstr("deadline"));
}

TEST_F(RobotProxiesTest, ManyCommandsAtOnceEachEndOnce) {
  StartAdapter();
  for (int i = 0; i < 200; ++i) {
    proxies_.Send(Decided(absl::StrCat("c/", i), "quick"));
    reports_.AwaitFinal(absl::StrCat("c/", i));
  }
  for (int i = 0; i < 200; ++i) {
    auto outcomes = reports_.Outcomes(absl::StrCat("c/", i));
    EXPECT_EQ(std::count_if(outcomes.begin(), outcomes.end(), IsFinalOutcome), 1);
  }
  EXPECT_EQ(runs_, 200);
}

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
    proxies_.Send(Command(id, "drive", 200));
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
