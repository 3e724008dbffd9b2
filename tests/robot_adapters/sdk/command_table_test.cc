// The commands of an adapter, without a network.
#include "robot_adapters/sdk/command_table.h"

#include <atomic>

#include "absl/synchronization/notification.h"
#include "gtest/gtest.h"

namespace docent::robot {
namespace {

TEST(CommandTable, WhatRunsIsStoppedWithIt) {
  const SystemClock clock;
  auto journal = CommandJournal::Open("", &clock);
  ASSERT_TRUE(journal.ok());
  absl::Notification begun;
  std::atomic<bool> stopped = false;
  Operation wait;
  wait.name = "wait";
  wait.run = [&](OperationContext& context) -> absl::StatusOr<NamedTerms> {
    begun.Notify();
    for (int i = 0; i < 2000; ++i) {
      if (context.SleepFor(std::chrono::milliseconds(10))) continue;
      stopped = true;
      return absl::CancelledError("stopped");
    }
    return NamedTerms{};
  };
  {
    auto table = CommandTable::Create({wait}, journal->get(), &clock, 4, nullptr);
    ASSERT_TRUE(table.ok()) << table.status();
    v1::InvokeRequest request;
    request.set_command_id("c/1");
    request.set_operation("wait");
    ASSERT_TRUE((*table)->Begin(request).ok());
    begun.WaitForNotification();  // before that it would not begin at all
  }
  EXPECT_TRUE(stopped) << "it ran to its own end";
}

// A Cancel may overtake its command, which lies unread in a socket.
TEST(CommandTable, WhatIsCancelledBeforeItComesDoesNotBegin) {
  const SystemClock clock;
  auto journal = CommandJournal::Open("", &clock);
  ASSERT_TRUE(journal.ok());
  std::atomic<int> begun = 0;
  Operation go;
  go.name = "go";
  go.run = [&](OperationContext&) -> absl::StatusOr<NamedTerms> {
    ++begun;
    return NamedTerms{};
  };
  auto table = CommandTable::Create({go}, journal->get(), &clock, 4, nullptr);
  ASSERT_TRUE(table.ok()) << table.status();
  (*table)->Cancel(CommandId("c/1"));
  EXPECT_TRUE(absl::IsNotFound((*table)->Find(CommandId("c/1")).status())) << "it has not come";
  v1::InvokeRequest request;
  request.set_operation("go");
  class Ends : public FeedbackWatcher {
   public:
    void OnFeedback(const v1::Feedback& feedback) override {
      if (feedback.state() == v1::Feedback::CANCELLED) cancelled.Notify();
      if (feedback.state() == v1::Feedback::SUCCEEDED) succeeded.Notify();
    }
    absl::Notification cancelled, succeeded;
  };
  Ends first, second;
  request.set_command_id("c/1");
  auto early = (*table)->Begin(request);
  ASSERT_TRUE(early.ok());
  (*early)->Watch(&first);
  first.cancelled.WaitForNotification();
  request.set_command_id("c/2");
  auto other = (*table)->Begin(request);
  ASSERT_TRUE(other.ok());
  (*other)->Watch(&second);
  second.succeeded.WaitForNotification();
  EXPECT_EQ(begun, 1);
  (*other)->Unwatch(&second);
}

class LastFeedback : public FeedbackWatcher {
 public:
  void OnFeedback(const v1::Feedback& feedback) override {
    absl::MutexLock lock(&mutex_);
    last_ = feedback;
  }
  v1::Feedback End() {
    absl::MutexLock lock(&mutex_);
    auto ended = [this]() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
      return last_.state() == v1::Feedback::SUCCEEDED || last_.state() == v1::Feedback::FAILED;
    };
    EXPECT_TRUE(mutex_.AwaitWithTimeout(absl::Condition(&ended), absl::Seconds(30)));
    return last_;
  }

 private:
  absl::Mutex mutex_;
  v1::Feedback last_ ABSL_GUARDED_BY(mutex_);
};

TEST(CommandTable, WhatTheJournalCannotKeepIsSaidBesideWhatTheOperationSays) {
  const SystemClock clock;
  auto opened = CommandJournal::Open("", &clock);
  ASSERT_TRUE(opened.ok());
  CommandJournal* journal = opened->get();
  for (const std::string said : {"", "stuck"}) {
    Operation odd;
    odd.name = "odd";
    odd.run = [journal, said](OperationContext& context) -> absl::StatusOr<NamedTerms> {
      EXPECT_TRUE(journal->Finish(context.command(), CommandOutcome::kSucceeded, "", {}).ok());
      if (said.empty()) return NamedTerms{};
      return absl::InternalError(said);
    };
    LastFeedback last;
    const std::string id = "c/" + said + "1";
    auto table = CommandTable::Create({odd}, journal, &clock, 4, &last);
    ASSERT_TRUE(table.ok()) << table.status();
    v1::InvokeRequest request;
    request.set_command_id(id);
    request.set_operation("odd");
    ASSERT_TRUE((*table)->Begin(request).ok());
    EXPECT_EQ(last.End().message(), (said.empty() ? "" : said + "; ") + "command " + id + " is not running");
  }
}

}  // namespace
}  // namespace docent::robot
