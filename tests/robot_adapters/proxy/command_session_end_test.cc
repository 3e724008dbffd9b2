// A session of a command that is called back, or whose time is over.
#include "robot_adapters/proxy/command_session.h"

#include <algorithm>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/robot_adapters/proxy/command_session_fixture.h"

namespace docent::proxy {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// The server was away when its time was over.
TEST_F(CommandSessionTest, WhatIsOverdueAndHasNotBegunNeverBegins) {
  Begin(Drive(), true, absl::Seconds(-1));
  End(grpc::StatusCode::NOT_FOUND);
  ASSERT_EQ(TellLife("life1"), Outcome::kFailed);
  EXPECT_THAT(host_.reports.back().message, HasSubstr("did not take drive before its deadline"));
  EXPECT_EQ(host_.calls.size(), 1u) << "it is not invoked";
}

TEST_F(CommandSessionTest, WhatBecomesOverdueBetweenTwoCallsNeverBegins) {
  Begin(Drive(), true, absl::Milliseconds(50));
  host_.connected = false;
  End(grpc::StatusCode::NOT_FOUND);  // it is to be invoked again, and there is no connection
  ASSERT_EQ(host_.probes.size(), 1u);
  host_.Go(absl::Milliseconds(60));
  host_.connected = true;
  session_->OnProbed(host_.probes.back().second, grpc::Status::OK, "life1");
  ASSERT_EQ(host_.calls.size(), 2u);
  EXPECT_TRUE(host_.calls.back().is_attach());
  End(grpc::StatusCode::NOT_FOUND);
  EXPECT_EQ(TellLife("life1"), Outcome::kFailed);
}

TEST_F(CommandSessionTest, WhatIsOverdueAndHasBegunIsWaitedFor) {
  Begin(Drive(), true, absl::Seconds(-1));
  Say(v1::Feedback::RUNNING);
  host_.Go(absl::Seconds(1));
  EXPECT_THAT(host_.cancels, ElementsAre("a:1"));
  Say(v1::Feedback::SUCCEEDED);
  EXPECT_EQ(host_.reports.back().outcome, Outcome::kSucceeded);
}

TEST_F(CommandSessionTest, WhatIsCalledBackDoesNotBeginAndWhatHasBegunGoesOn) {
  host_.connected = false;
  Begin().Recall();
  EXPECT_THAT(host_.Outcomes(), ElementsAre(Outcome::kNotBegun)) << "it was never sent";
  host_.connected = true;
  host_.reports.clear();
  Begin(Drive(), true).Recall();
  End(grpc::StatusCode::NOT_FOUND);
  EXPECT_THAT(host_.cancels, IsEmpty()) << "the robot may have begun it";
  TellLife("life1");
  EXPECT_THAT(host_.reports, IsEmpty());
  EXPECT_THAT(host_.cancels, ElementsAre("a:1")) << "it has not, and may have read it";
  EXPECT_EQ(RefuseToBegin(), Outcome::kNotBegun);
  host_.reports.clear();
  host_.cancels.clear();
  Begin(Drive(), true).Recall();
  Say(v1::Feedback::RUNNING);
  EXPECT_THAT(host_.cancels, IsEmpty());
  Say(v1::Feedback::SUCCEEDED);
  EXPECT_EQ(host_.reports.back().outcome, Outcome::kSucceeded);
}

// The adapter stands still, and the command lies in its socket.
TEST_F(CommandSessionTest, WhatIsCalledBackBeforeTheAdapterReadItEndsWhereItBegins) {
  Begin().Recall();
  EXPECT_THAT(host_.cancels, ElementsAre("a:1"));
  session_->OnCancelAnswered(host_.cancel_attempt, false);
  host_.Go(absl::Seconds(20));
  const size_t sent = host_.cancels.size();
  Say(v1::Feedback::RUNNING);
  EXPECT_EQ(host_.cancels.size(), sent + 1) << "as soon as the adapter answers";
  session_->OnCancelAnswered(host_.cancel_attempt, true);
  Say(v1::Feedback::RUNNING, 0.1);
  EXPECT_EQ(host_.cancels.size(), sent + 1);
  Say(v1::Feedback::CANCELLED);
  EXPECT_EQ(host_.reports.back().outcome, Outcome::kCancelled);
}

TEST_F(CommandSessionTest, WhatIsOverdueBeforeTheAdapterReadItEndsWhereItBegins) {
  Begin(Drive(), false, absl::Seconds(10));
  host_.Go(absl::Seconds(11));
  const size_t sent = host_.cancels.size();
  ASSERT_GT(sent, 0u);
  Say(v1::Feedback::ACCEPTED);
  EXPECT_EQ(host_.cancels.size(), sent + 1);
}

TEST_F(CommandSessionTest, WhatTheAdapterHasTakenIsNotEndedByARecall) {
  Begin();
  Say(v1::Feedback::ACCEPTED);
  session_->Recall();
  End(grpc::StatusCode::UNAVAILABLE);
  host_.Go(absl::Seconds(1));
  Say(v1::Feedback::RUNNING);
  EXPECT_THAT(host_.cancels, IsEmpty());
}

TEST_F(CommandSessionTest, WhatWasCalledBackWhileItWasOnItsWayDoesNotBeginAgain) {
  Begin().Recall();
  End(grpc::StatusCode::UNAVAILABLE);
  host_.Go(absl::Seconds(1));
  ASSERT_TRUE(host_.calls.back().is_attach());
  End(grpc::StatusCode::NOT_FOUND);
  TellLife("life1");
  EXPECT_EQ(RefuseToBegin(), Outcome::kNotBegun);
}

// The server began again meanwhile, and the adapter forgets what is cancelled before it begins.
TEST_F(CommandSessionTest, WhatAnAdapterReadAndBeginsAfterItWasStoppedIsCancelled) {
  for (const bool cancel : {true, false}) {
    Begin(Drive(), true);
    cancel ? session_->Cancel() : session_->Recall();
    for (int i = 0; i < 10; ++i) {
      ASSERT_TRUE(host_.calls.back().is_attach());
      End(grpc::StatusCode::NOT_FOUND);
      TellLife("life1");
      session_->OnCancelAnswered(host_.cancel_attempt, false);
      host_.Go(absl::Seconds(2));
    }
    EXPECT_THAT(host_.reports, IsEmpty());
    Say(v1::Feedback::RUNNING);
    const size_t sent = host_.cancels.size();
    session_->OnCancelAnswered(host_.cancel_attempt, false);
    host_.Go(absl::Seconds(2));
    EXPECT_EQ(host_.cancels.size(), sent + 1);
    Say(v1::Feedback::CANCELLED);
    EXPECT_EQ(host_.reports.back().outcome, Outcome::kCancelled);
    host_.reports.clear();
  }
}

TEST_F(CommandSessionTest, AnAdapterThatDoesNotSayThatItWillNotBeginHasATimeToBegin) {
  for (const int left : {300, 20}) {
    Begin(Drive(), true, absl::Seconds(left)).Cancel();
    const absl::Time begin = host_.now;
    while (host_.reports.empty() && host_.now < begin + absl::Minutes(1)) {
      End(grpc::StatusCode::NOT_FOUND);
      TellLife("life1");
      host_.Go(absl::Seconds(2));
    }
    EXPECT_THAT(host_.Outcomes(), ElementsAre(Outcome::kNotBegun));
    EXPECT_NEAR(absl::ToDoubleSeconds(host_.now - begin), std::min(left, 30), 3) << "or until its deadline";
    host_.reports.clear();
  }
}

// What it answered may be older than the Cancel.
TEST_F(CommandSessionTest, AnAnswerThatWasOnItsWayWhenTheAdapterHeardTheCancelIsNoProof) {
  Begin(Drive(), true).Cancel();
  session_->OnCancelAnswered(host_.cancel_attempt, true);
  End(grpc::StatusCode::NOT_FOUND);
  TellLife("life1");
  EXPECT_THAT(host_.reports, IsEmpty());
  EXPECT_FALSE(session_->done());
}

// It contradicts itself.
TEST_F(CommandSessionTest, WhatTheAdapterHadBegunAndDoesNotKnowAnyMoreIsUnknown) {
  Begin();
  Say(v1::Feedback::RUNNING);
  session_->Cancel();
  End(grpc::StatusCode::UNAVAILABLE);
  host_.Go(absl::Seconds(1));
  End(grpc::StatusCode::NOT_FOUND);
  EXPECT_EQ(host_.reports.back().outcome, Outcome::kUnknown);
}

TEST_F(CommandSessionTest, AtTheDeadlineItAsksForTheEndAndWaitsForIt) {
  Begin(Drive(), false, absl::Seconds(10));
  Say(v1::Feedback::RUNNING);
  host_.Go(absl::Milliseconds(10299));
  EXPECT_THAT(host_.cancels, IsEmpty()) << "the adapter has the grace to end by itself";
  host_.Go(absl::Milliseconds(1));
  EXPECT_THAT(host_.cancels, ElementsAre("a:1"));
  EXPECT_THAT(host_.overdue, ElementsAre("adapter at a:1 did not finish drive before its deadline"));
  EXPECT_FALSE(session_->done());
  Say(v1::Feedback::CANCELLED);
  EXPECT_TRUE(session_->done());
}

// A simulator may stop the clock.
class StoppedHost final : public FakeHost {
 public:
  absl::Time SteadyNow() const override { return stopped ? absl::UnixEpoch() : now; }
  bool stopped = true;
};

TEST(CommandSession, NoDeadlineIsReachedWhileTheClockStandsStill) {
  StoppedHost host;
  CommandSession session(&host, ProxySettings(), Drive(), absl::Seconds(10), false);
  session.UseAdapter("a:1", "life1");
  session.OnFeedback(1, Says(v1::Feedback::RUNNING));
  host.Go(absl::Hours(1));
  EXPECT_THAT(host.cancels, IsEmpty());
  host.stopped = false;
  host.Go(absl::Seconds(11));
  EXPECT_THAT(host.cancels, ElementsAre("a:1"));
}

TEST_F(CommandSessionTest, AtTheDeadlineOneThatNeverWentOutFails) {
  host_.connected = false;
  Begin(Drive(), false, absl::Seconds(10));
  session_->OnProbed(1, grpc::Status(grpc::StatusCode::UNAVAILABLE, "no"), "");
  host_.Go(absl::Milliseconds(10300));
  EXPECT_EQ(host_.reports.back().outcome, Outcome::kFailed);
  EXPECT_EQ(
      host_.reports.back().message,
      "adapter at a:1 did not take drive before its deadline; last: adapter at a:1 cannot be reached: no");
  EXPECT_THAT(host_.cancels, IsEmpty());
}

TEST_F(CommandSessionTest, TheTimeLeftIsToldAndACallOutlastsIt) {
  Begin(Drive(), false, absl::Seconds(10));
  EXPECT_EQ(host_.calls[0].invoke().time_left_us(), 10'000'000);
  EXPECT_EQ(host_.calls[0].timeout, absl::Seconds(70));
}

TEST_F(CommandSessionTest, WhatIsSentAfterItsTimeFailsAndIsNotInvoked) {
  Begin(Drive(), false, absl::Seconds(-5));
  EXPECT_THAT(host_.calls, IsEmpty());
  EXPECT_THAT(host_.Outcomes(), ElementsAre(Outcome::kFailed));
}

}  // namespace
}  // namespace docent::proxy
