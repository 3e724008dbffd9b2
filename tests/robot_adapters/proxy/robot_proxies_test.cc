// The proxies against real adapters over loopback, made with the sdk.
#include "robot_adapters/proxy/robot_proxies.h"

#include <atomic>
#include <filesystem>

#include "absl/strings/str_cat.h"
#include "absl/time/time.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "robot_adapters/sdk/robot_adapter.h"
#include "tests/robot_adapters/proxy/proxy_reports.h"

namespace docent::proxy {
namespace {

using test::Command;
using test::FastSettings;
using test::IsFinalOutcome;
using test::kRobot;
using test::Outcome;
using test::Reports;
using testing::ElementsAre;
using testing::HasSubstr;

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

  // Until an operation has begun. Before that its command is accepted, and may end without being done.
  void AwaitRun() const {
    while (runs_ == 0) absl::SleepFor(absl::Milliseconds(1));
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
  proxies_.Send(Command("c/1", "quick", 3000));  // that nobody is there is known long before
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
  AwaitRun();
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
  EXPECT_EQ(reports_.AwaitFinal("c/1").outcome, Outcome::kNotBegun);
}

// As after a restart of the server, which has kept what was decided of its commands.
TEST_F(RobotProxiesTest, WhatIsResumedToEndIsCancelledAndIsNotBegun) {
  StartAdapter();
  proxies_.Resume(Decided("c/1", "quick"), CommandWish::kEnd);
  EXPECT_EQ(reports_.AwaitFinal("c/1").outcome, Outcome::kNotBegun);
  proxies_.Resume(Decided("c/2", "quick"), CommandWish::kNotBegin);
  EXPECT_EQ(reports_.AwaitFinal("c/2").outcome, Outcome::kNotBegun);
  RobotCommand overdue = Decided("c/3", "quick");
  overdue.deadline_us = 1;
  proxies_.Resume(overdue);
  EXPECT_EQ(reports_.AwaitFinal("c/3").outcome, Outcome::kFailed);
  EXPECT_EQ(runs_, 0);
}

TEST_F(RobotProxiesTest, WhatIsResumedToEndAndRunsEnds) {
  StartAdapter();
  RobotCommand command = Decided("c/1", "wait");
  {
    Reports earlier;
    RobotProxies before([&](WriteBatch batch) { earlier.Take(std::move(batch)); }, FastSettings());
    before.SetAdapter(RobotId(kRobot), address_, "");
    before.Send(command);
    earlier.Await("c/1", Outcome::kAccepted);
  }
  proxies_.Resume(command, CommandWish::kEnd);
  EXPECT_EQ(reports_.AwaitFinal("c/1").outcome, Outcome::kCancelled);
}

TEST_F(RobotProxiesTest, ACommandThatIsCalledBackDoesNotReachARobotThatComesLater) {
  proxies_.Send(Command("c/1", "quick"));
  reports_.Await("c/1", Outcome::kUnreachable);
  proxies_.Recall(CommandId("c/1"));
  EXPECT_EQ(reports_.AwaitFinal("c/1").outcome, Outcome::kNotBegun);
  StartAdapter();
  proxies_.Send(Decided("c/2", "quick"));
  reports_.AwaitFinal("c/2");
  EXPECT_EQ(runs_, 1);
}

TEST_F(RobotProxiesTest, OperationThatIsNotOfferedFailsWithTheAdaptersWords) {
  StartAdapter();
  proxies_.Send(Decided("c/1", "fly"));
  CommandReport report = reports_.AwaitFinal("c/1");
  EXPECT_EQ(report.outcome, Outcome::kFailed);
  EXPECT_THAT(report.message, HasSubstr("no operation \"fly\""));
}

// By itself: the proxies would ask it to a minute later.
TEST_F(RobotProxiesTest, AdapterGivesUpAtTheDeadline) {
  StartAdapter();
  ProxySettings patient = FastSettings();
  patient.grace = std::chrono::minutes(1);
  RobotProxies proxies([this](WriteBatch batch) { reports_.Take(std::move(batch)); }, patient);
  proxies.SetAdapter(RobotId(kRobot), address_, "");
  proxies.Send(Decided("c/1", "wait", 1500));
  AwaitRun();
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

}  // namespace
}  // namespace docent::proxy
