// The state machine of one command, step by step, without a network: what it asks of its host, and when.
#include "robot_adapters/proxy/command_session.h"

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/robot_adapters/proxy/command_session_fixture.h"

namespace docent::proxy {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST_F(CommandSessionTest, ACancelDoesNotWaitForAWordOfTheAdapter) {
  Begin().Cancel();
  EXPECT_THAT(host_.cancels, ElementsAre("a:1"));
}

// It may have overtaken the command, or be lost.
TEST_F(CommandSessionTest, ACancelIsSentAgainUntilTheAdapterHasTheCommand) {
  Begin().Cancel();
  for (const int pause_ms : {100, 200, 400, 800, 1600, 2000, 2000}) {
    const size_t sent = host_.cancels.size();
    session_->OnCancelAnswered(host_.cancel_attempt, false);
    host_.Go(absl::Milliseconds(pause_ms - 1));
    EXPECT_EQ(host_.cancels.size(), sent) << pause_ms;
    host_.Go(absl::Milliseconds(1));
    EXPECT_EQ(host_.cancels.size(), sent + 1) << pause_ms;
  }
  const size_t sent = host_.cancels.size();
  session_->OnCancelAnswered(host_.cancel_attempt - 1, false);  // of an earlier one
  session_->OnCancelAnswered(host_.cancel_attempt, true);
  Say(v1::Feedback::RUNNING);
  host_.Go(absl::Seconds(10));
  EXPECT_EQ(host_.cancels.size(), sent) << "it has it, and may take its time";
}

TEST_F(CommandSessionTest, ACancelIsNotSentAgainAfterTheEnd) {
  Begin().Cancel();
  session_->OnCancelAnswered(host_.cancel_attempt, false);
  Say(v1::Feedback::SUCCEEDED);
  session_->OnCancelAnswered(host_.cancel_attempt, false);
  host_.Go(absl::Seconds(10));
  EXPECT_EQ(host_.cancels.size(), 1u);
}

TEST_F(CommandSessionTest, ACancelIsSentAgainWithEachCall) {
  Begin();
  Say(v1::Feedback::ACCEPTED);
  session_->Cancel();
  session_->OnCancelAnswered(host_.cancel_attempt, true);
  EXPECT_EQ(host_.cancels.size(), 1u);
  session_->Cancel();
  EXPECT_EQ(host_.cancels.size(), 1u) << "a second request asks for nothing new";
  End(grpc::StatusCode::UNAVAILABLE);
  host_.Go(absl::Seconds(1));
  ASSERT_TRUE(host_.calls.back().is_attach());
  EXPECT_EQ(host_.cancels.size(), 2u);
  Say(v1::Feedback::RUNNING);
  Say(v1::Feedback::CANCELLED);
  EXPECT_EQ(host_.cancels.size(), 2u) << "it has ended";
  EXPECT_EQ(host_.reports.back().outcome, Outcome::kCancelled);
  EXPECT_TRUE(session_->done());
}

TEST_F(CommandSessionTest, ACancelDoesNotWaitForTheNextCall) {
  Begin();
  Say(v1::Feedback::ACCEPTED);
  End(grpc::StatusCode::OK);
  session_->Cancel();
  EXPECT_THAT(host_.cancels, ElementsAre("a:1")) << "while the feedback is broken off";
  session_->OnCancelAnswered(host_.cancel_attempt, false);
  host_.Go(absl::Milliseconds(100));
  EXPECT_GE(host_.cancels.size(), 2u) << "the adapter did not know it: it is sent again";
}

TEST_F(CommandSessionTest, ACancelBeforeItIsSentEndsIt) {
  host_.connected = false;
  Begin().Cancel();
  EXPECT_THAT(host_.calls, IsEmpty());
  EXPECT_THAT(host_.Outcomes(), ElementsAre(Outcome::kNotBegun));
  EXPECT_EQ(host_.reports[0].message, "cancelled before the robot began it");
  host_.connected = true;
  session_->OnProbed(1, grpc::Status::OK, "life1");
  EXPECT_THAT(host_.calls, IsEmpty()) << "it is sent though it was cancelled";
}

TEST_F(CommandSessionTest, PausesBetweenAttemptsDoubleUpToTheLast) {
  Begin();
  host_.delays.clear();
  for (int i = 0; i < 7; ++i) {
    End(grpc::StatusCode::UNAVAILABLE);
    host_.Go(host_.delays.back() - absl::Milliseconds(1));
    const size_t before = host_.calls.size();
    host_.Go(absl::Milliseconds(1));
    EXPECT_EQ(host_.calls.size(), before + 1);
  }
  EXPECT_THAT(host_.delays, ElementsAre(absl::Milliseconds(100), absl::Milliseconds(200),
                                        absl::Milliseconds(400), absl::Milliseconds(800),
                                        absl::Milliseconds(1600), absl::Seconds(2), absl::Seconds(2)));
  Say(v1::Feedback::RUNNING);
  End(grpc::StatusCode::UNAVAILABLE);
  EXPECT_EQ(host_.delays.back(), absl::Milliseconds(100)) << "after a sign of life it begins again";
}

// An adapter that answers each Attach with the same state, and ends the stream.
TEST_F(CommandSessionTest, PausesDoubleWhileTheAdapterSaysNothingNew) {
  Begin();
  Say(v1::Feedback::ACCEPTED);
  host_.delays.clear();
  for (int i = 0; i < 4; ++i) {
    End(grpc::StatusCode::OK);
    host_.Go(host_.delays.back());
    Say(v1::Feedback::ACCEPTED);
  }
  EXPECT_THAT(host_.delays, ElementsAre(absl::Milliseconds(100), absl::Milliseconds(200),
                                        absl::Milliseconds(400), absl::Milliseconds(800)));
  Say(v1::Feedback::RUNNING, 0.5);
  End(grpc::StatusCode::OK);
  EXPECT_EQ(host_.delays.back(), absl::Milliseconds(100));
}

TEST_F(CommandSessionTest, ALossIsReportedOnceUntilTheAdapterIsSeenAgain) {
  Begin();
  for (int i = 0; i < 2; ++i) {
    End(grpc::StatusCode::UNAVAILABLE);
    host_.Go(absl::Seconds(1));
  }
  EXPECT_THAT(host_.Outcomes(), ElementsAre(Outcome::kUnreachable));
  EXPECT_THAT(host_.reports[0].message, HasSubstr("adapter at a:1 cannot be reached"));
  Say(v1::Feedback::ACCEPTED);
  End(grpc::StatusCode::OK);
  EXPECT_THAT(host_.Outcomes(),
              ElementsAre(Outcome::kUnreachable, Outcome::kAccepted, Outcome::kUnreachable));
  EXPECT_THAT(host_.reports[2].message, HasSubstr("ended the feedback of a command that has not ended"));
}

TEST_F(CommandSessionTest, WhatGrpcSaysOfAConnectionIsNoEndOfTheCommand) {
  using Code = grpc::StatusCode;
  for (const Code code : {Code::UNAVAILABLE, Code::CANCELLED, Code::UNKNOWN, Code::INTERNAL,
                          Code::DEADLINE_EXCEEDED, Code::ABORTED}) {
    host_.reports.clear();
    Begin();
    End(code);
    EXPECT_THAT(host_.Outcomes(), ElementsAre(Outcome::kUnreachable)) << code;
    EXPECT_FALSE(session_->done()) << code;
  }
}

TEST_F(CommandSessionTest, WhatAnAdapterRefusesFails) {
  using Code = grpc::StatusCode;
  for (const Code code :
       {Code::INVALID_ARGUMENT, Code::RESOURCE_EXHAUSTED, Code::UNIMPLEMENTED, Code::NOT_FOUND}) {
    host_.reports.clear();
    Begin();
    End(code);
    ASSERT_THAT(host_.Outcomes(), ElementsAre(Outcome::kFailed)) << code;
    EXPECT_EQ(host_.reports[0].message, "adapter at a:1 refused drive: why");
    EXPECT_TRUE(session_->done());
  }
  Begin();
  End(Code::FAILED_PRECONDITION);
  EXPECT_EQ(host_.reports.back().outcome, Outcome::kUnknown);
}

// A message that is too large, a proxy between: the robot may go on all the same.
TEST(CommandSession, NothingThatEndsTheStreamOfACommandThatTheAdapterHasIsItsEnd) {
  using Code = grpc::StatusCode;
  for (int number = 0; number <= 16; ++number) {
    const auto code = static_cast<Code>(number);
    FakeHost host;
    CommandSession session(&host, ProxySettings(), Drive(), absl::Seconds(60), false);
    session.UseAdapter("a:1", "life1");
    session.OnFeedback(1, Says(v1::Feedback::ACCEPTED));
    session.OnCallEnded(1, grpc::Status(code, "why"));
    EXPECT_THAT(host.Outcomes(), ElementsAre(Outcome::kAccepted, Outcome::kUnreachable)) << number;
    host.Go(absl::Seconds(1));
    ASSERT_EQ(host.calls.size(), 2u) << number;
    EXPECT_TRUE(host.calls.back().is_attach()) << number;
    if (code == Code::NOT_FOUND || code == Code::FAILED_PRECONDITION || code == Code::UNIMPLEMENTED) continue;
    session.OnCallEnded(2, grpc::Status(code, "why"));
    EXPECT_FALSE(session.done()) << number << " answers an Attach";
  }
}

TEST_F(CommandSessionTest, WhereThereIsNoAttachTheOutcomeIsUnknown) {
  Begin();
  Say(v1::Feedback::ACCEPTED);
  End(grpc::StatusCode::UNAVAILABLE);
  host_.Go(absl::Seconds(1));
  End(grpc::StatusCode::UNIMPLEMENTED);
  EXPECT_EQ(host_.reports.back().outcome, Outcome::kUnknown);
  EXPECT_EQ(host_.reports.back().message, "adapter at a:1 cannot tell what became of it: it has no Attach");
}

TEST_F(CommandSessionTest, ACommandThatTheAdapterDoesNotKnowIsInvokedAgainForTheSameLifeOnly) {
  Begin();
  End(grpc::StatusCode::UNAVAILABLE);
  host_.Go(absl::Seconds(1));
  ASSERT_TRUE(host_.calls.back().is_attach());
  End(grpc::StatusCode::NOT_FOUND);
  ASSERT_FALSE(host_.calls.back().is_attach());
  EXPECT_EQ(host_.calls.back().invoke().expected_incarnation(), "life1");
  EXPECT_FALSE(session_->done());
}

TEST_F(CommandSessionTest, WithoutAKnownLifeOnlyAnIdempotentOneIsInvokedAgain) {
  RobotCommand command = Drive();
  command.expected_incarnation = "";
  Begin(command, true);
  End(grpc::StatusCode::NOT_FOUND);
  EXPECT_THAT(host_.Outcomes(), ElementsAre(Outcome::kUnknown));
  EXPECT_THAT(host_.reports[0].message, HasSubstr("may have forgotten it"));
  command.idempotent = true;
  Begin(command, true);
  End(grpc::StatusCode::NOT_FOUND);
  EXPECT_FALSE(session_->done());
  EXPECT_FALSE(host_.calls.back().is_attach());
}

TEST_F(CommandSessionTest, ACancelledOneThatTheAdapterDoesNotKnowIsNotInvokedAgain) {
  Begin(Drive(), true).Cancel();
  EXPECT_THAT(host_.reports, IsEmpty()) << "it may have been sent";
  End(grpc::StatusCode::NOT_FOUND);
  EXPECT_THAT(host_.reports, IsEmpty()) << "it may have begun it, and have forgotten";
  TellLife("life1");
  EXPECT_THAT(host_.reports, IsEmpty()) << "it may have read it, and begin it yet";
  EXPECT_EQ(RefuseToBegin(), Outcome::kNotBegun);
  for (const auto& call : host_.calls) EXPECT_TRUE(call.is_attach());
}

TEST_F(CommandSessionTest, WhatAnotherLifeDoesNotKnowMayHaveBegun) {
  for (const char* life : {"life2", ""}) {
    Begin(Drive(), true).Cancel();
    End(grpc::StatusCode::NOT_FOUND);
    EXPECT_EQ(TellLife(life), Outcome::kUnknown) << life;
  }
  RobotCommand command = Drive();
  command.expected_incarnation = "";
  command.idempotent = true;
  Begin(command, true).Cancel();
  End(grpc::StatusCode::NOT_FOUND);
  EXPECT_EQ(host_.reports.back().outcome, Outcome::kUnknown);
}

TEST_F(CommandSessionTest, AnAdapterThatIsLostBeforeItTellsItsLifeIsAskedAgain) {
  Begin(Drive(), true).Cancel();
  End(grpc::StatusCode::NOT_FOUND);
  session_->OnProbed(host_.probes.back().second, grpc::Status(grpc::StatusCode::UNAVAILABLE, "no"), "");
  EXPECT_THAT(host_.Outcomes(), ElementsAre(Outcome::kUnreachable));
  host_.Go(absl::Seconds(1));
  ASSERT_EQ(host_.calls.size(), 2u);
  EXPECT_TRUE(host_.calls.back().is_attach());
  EXPECT_FALSE(session_->done());
}

// It is known that nobody has it.
TEST_F(CommandSessionTest, WhatWasNotSentBeforeAnotherLifeJoinedIsNotBegun) {
  host_.connected = false;
  Begin();
  session_->UseAdapter("a:1", "life1");
  EXPECT_FALSE(session_->done());
  session_->UseAdapter("b:2", "life2");
  ASSERT_THAT(host_.Outcomes(), ElementsAre(Outcome::kNotBegun));
  EXPECT_EQ(host_.reports[0].message,
            "incarnation life1 of the adapter was replaced by life2 before it was sent");
  EXPECT_THAT(host_.calls, IsEmpty());
}

TEST_F(CommandSessionTest, ProgressIsReportedOnceAnInterval) {
  Begin();
  Say(v1::Feedback::RUNNING, 0.1);
  host_.Go(absl::Milliseconds(199));
  Say(v1::Feedback::RUNNING, 0.2);
  host_.Go(absl::Milliseconds(1));
  Say(v1::Feedback::RUNNING, 0.3);
  std::vector<double> told;
  for (const CommandReport& report : host_.reports) {
    if (report.outcome == Outcome::kProgress) told.push_back(report.progress);
  }
  EXPECT_THAT(told, ElementsAre(0.1, 0.3));
  Say(v1::Feedback::SUCCEEDED, 1);
  EXPECT_EQ(host_.reports.back().outcome, Outcome::kSucceeded) << "the end is always reported";
}

TEST_F(CommandSessionTest, AcceptedIsReportedOnceWithTheLifeThatSaysSo) {
  RobotCommand command = Drive();
  command.expected_incarnation = "";
  Begin(command);
  Say(v1::Feedback::ACCEPTED);
  Say(v1::Feedback::ACCEPTED);
  ASSERT_THAT(host_.Outcomes(), ElementsAre(Outcome::kAccepted));
  EXPECT_EQ(host_.reports[0].incarnation, "life1");
}

TEST_F(CommandSessionTest, AnAdapterThatMovedIsAskedAtOnce) {
  Begin();
  Say(v1::Feedback::ACCEPTED);
  session_->UseAdapter("b:2", "life1");
  EXPECT_EQ(host_.calls.size(), 1u) << "one call at a time";
  End(grpc::StatusCode::CANCELLED);
  EXPECT_EQ(host_.delays.back(), absl::ZeroDuration());
  host_.Go(absl::ZeroDuration());
  ASSERT_EQ(host_.calls.size(), 2u);
  EXPECT_EQ(host_.calls[1].address, "b:2");
  EXPECT_TRUE(host_.calls[1].is_attach());
  EXPECT_THAT(host_.Outcomes(), ElementsAre(Outcome::kAccepted)) << "no loss is reported of what was left";
  End(grpc::StatusCode::UNAVAILABLE);
  EXPECT_GT(host_.delays.back(), absl::ZeroDuration()) << "at once, but once";
}

TEST_F(CommandSessionTest, TheSameAddressAgainLeavesTheCallAlone) {
  Begin();
  session_->UseAdapter("a:1", "life1");
  End(grpc::StatusCode::UNAVAILABLE);
  EXPECT_THAT(host_.Outcomes(), ElementsAre(Outcome::kUnreachable));
  session_->UseAdapter("a:1", "life1");
  EXPECT_EQ(host_.calls.size(), 2u) << "one that waits tries at once";
  host_.Go(absl::Seconds(1));
  EXPECT_EQ(host_.calls.size(), 2u) << "the pause that it had is over";
}

// An adapter that serves several robots restarts one of them and keeps its streams open.
TEST_F(CommandSessionTest, WhenAnotherLifeHasJoinedItIsAskedAndWhatItDoesNotKnowIsUnknown) {
  Begin();
  Say(v1::Feedback::RUNNING);
  session_->UseAdapter("a:1", "life1");
  End(grpc::StatusCode::UNAVAILABLE);
  EXPECT_GT(host_.delays.back(), absl::ZeroDuration()) << "the same life leaves the call alone";
  host_.Go(absl::Seconds(1));
  session_->UseAdapter("a:1", "life2");
  End(grpc::StatusCode::CANCELLED);
  EXPECT_EQ(host_.delays.back(), absl::ZeroDuration());
  host_.Go(absl::ZeroDuration());
  ASSERT_EQ(host_.calls.size(), 3u);
  ASSERT_TRUE(host_.calls.back().is_attach());
  EXPECT_FALSE(session_->done());
  End(grpc::StatusCode::NOT_FOUND);
  ASSERT_EQ(host_.reports.back().outcome, Outcome::kUnknown);
  EXPECT_EQ(
      host_.reports.back().message,
      "the command was begun by incarnation life1 of the adapter, and incarnation life2 does not know it");
}

TEST_F(CommandSessionTest, AnotherLifeThatRemembersTheCommandTellsItsEnd) {
  Begin();
  session_->UseAdapter("a:1", "life2");  // before the first word
  End(grpc::StatusCode::CANCELLED);
  host_.Go(absl::ZeroDuration());
  ASSERT_TRUE(host_.calls.back().is_attach());
  v1::Feedback remembered = Says(v1::Feedback::SUCCEEDED);
  remembered.set_incarnation("life2");
  session_->OnFeedback(Serial(), remembered);
  EXPECT_EQ(host_.reports.back().outcome, Outcome::kSucceeded);
}

TEST_F(CommandSessionTest, WhatAnEarlierCallSaysDoesNotCount) {
  Begin();
  End(grpc::StatusCode::UNAVAILABLE);
  host_.Go(absl::Seconds(1));
  ASSERT_EQ(host_.calls.size(), 2u);
  session_->OnFeedback(1, Says(v1::Feedback::SUCCEEDED));
  session_->OnCallEnded(1, grpc::Status(grpc::StatusCode::INVALID_ARGUMENT, "late"));
  EXPECT_FALSE(session_->done());
  EXPECT_THAT(host_.Outcomes(), ElementsAre(Outcome::kUnreachable));
}

TEST_F(CommandSessionTest, WhatAnEarlierProbeSaysDoesNotCount) {
  host_.connected = false;
  Begin();
  session_->OnProbed(1, grpc::Status(grpc::StatusCode::UNAVAILABLE, "no"), "");
  host_.Go(absl::Seconds(1));
  ASSERT_GE(host_.probes.size(), 2u);
  host_.connected = true;
  session_->OnProbed(1, grpc::Status::OK, "life1");
  EXPECT_THAT(host_.calls, IsEmpty());
  session_->OnProbed(host_.probes.back().second, grpc::Status(grpc::StatusCode::UNIMPLEMENTED, "whatever"),
                     "");
  EXPECT_EQ(host_.calls.size(), 1u) << "there is a connection now";
}

TEST_F(CommandSessionTest, EachRefusedMessageIsCountedAndTheFirstReported) {
  Begin();
  v1::Feedback other = Says(v1::Feedback::SUCCEEDED);
  other.set_command_id("c/2");
  session_->OnFeedback(1, other);
  session_->OnFeedback(1, other);
  EXPECT_EQ(host_.refused.size(), 2u);
  ASSERT_THAT(host_.Outcomes(), ElementsAre(Outcome::kRefused));
  EXPECT_THAT(host_.reports[0].message, HasSubstr("it is about command c/2"));
  EXPECT_FALSE(session_->done());
}

TEST_F(CommandSessionTest, StatesAreThoseThatThereAre) {
  Begin();
  for (const int state : {0, 6, -1}) {
    session_->OnFeedback(1, Says(static_cast<v1::Feedback::State>(state)));
    EXPECT_THAT(host_.refused.back(), HasSubstr("is not known")) << state;
  }
  EXPECT_EQ(host_.refused.size(), 3u);
  Say(v1::Feedback::ACCEPTED);
  Say(v1::Feedback::RUNNING);
  Say(v1::Feedback::RUNNING);
  EXPECT_EQ(host_.refused.size(), 3u);
  Say(v1::Feedback::ACCEPTED);
  EXPECT_THAT(host_.refused.back(), HasSubstr("ACCEPTED after RUNNING"));
}

TEST_F(CommandSessionTest, AnotherLifeThatBeganItIsAskedToEndAndTheOutcomeIsUnknown) {
  Begin();
  v1::Feedback other = Says(v1::Feedback::RUNNING);
  other.set_incarnation("life2");
  session_->OnFeedback(1, other);
  session_->OnFeedback(1, other);
  EXPECT_THAT(host_.cancels, ElementsAre("a:1"));
  other.set_state(v1::Feedback::SUCCEEDED);
  session_->OnFeedback(1, other);
  EXPECT_EQ(host_.reports.back().outcome, Outcome::kUnknown);
  EXPECT_THAT(host_.reports.back().message, HasSubstr("was meant for incarnation life1"));
}

TEST_F(CommandSessionTest, WithoutAnAddressItIsUnreachableAndFailsAtTheDeadline) {
  session_ = std::make_unique<CommandSession>(&host_, ProxySettings(), Drive(), absl::Seconds(1), false);
  session_->UseAdapter("", "life1");
  EXPECT_THAT(host_.Outcomes(), ElementsAre(Outcome::kUnreachable));
  EXPECT_EQ(host_.reports[0].message, "robot urn:r1 has no adapter now");
  host_.Go(absl::Seconds(2));
  EXPECT_EQ(host_.reports.back().message,
            "robot urn:r1 has no adapter and did not take drive before its deadline");
  EXPECT_THAT(host_.cancels, IsEmpty());
}

}  // namespace
}  // namespace docent::proxy
