#include "robot_adapters/sdk/fact_sender.h"

#include <cmath>

#include "absl/strings/str_cat.h"
#include "graph/rdf/vocabulary.h"
#include "gtest/gtest.h"
#include "robot_adapters/sdk/decimal.h"

namespace docent::robot {
namespace {

constexpr char kRobot[] = "http://example.org/r1";
constexpr char kUser[] = "http://example.org/john";

// A server that the test controls: it can be away, lose answers, or refuse.
class ScriptedServer {
 public:
  absl::Status Assert(const v1::AssertRequest& request, v1::AssertReply* reply) {
    absl::MutexLock lock(&mutex_);
    ++calls_;
    if (away_) return absl::UnavailableError("nobody there");
    if (refuse_) return absl::InvalidArgumentError("bad term");
    reply->set_offset(batches_.size() + 1);
    for (const v1::AssertRequest& seen : batches_) {
      if (seen.request_id() == request.request_id()) return absl::OkStatus();
    }
    batches_.push_back(request);
    if (lose_answers_ > 0) {
      --lose_answers_;
      return absl::UnavailableError("the answer got lost");
    }
    return absl::OkStatus();
  }
  void SetAway(bool away) {
    absl::MutexLock lock(&mutex_);
    away_ = away;
  }
  void SetRefuse(bool refuse) {
    absl::MutexLock lock(&mutex_);
    refuse_ = refuse;
  }
  void LoseAnswers(int n) {
    absl::MutexLock lock(&mutex_);
    lose_answers_ = n;
  }
  void AwaitCalls(int n) {
    absl::MutexLock lock(&mutex_);
    auto enough = [this, n]() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) { return calls_ >= n; };
    mutex_.Await(absl::Condition(&enough));
  }
  std::vector<v1::AssertRequest> batches() {
    absl::MutexLock lock(&mutex_);
    return batches_;
  }

 private:
  absl::Mutex mutex_;
  bool away_ = false;
  bool refuse_ = false;
  int lose_answers_ = 0;
  int calls_ = 0;
  std::vector<v1::AssertRequest> batches_;
};

FactSenderOptions Options() {
  FactSenderOptions options;
  options.source = kRobot;
  options.request_id_prefix = "test";
  options.queue_limit = 4;
  options.first_retry = absl::Milliseconds(1);
  options.last_retry = absl::Milliseconds(5);
  return options;
}

TermQuad Event(const std::string& what) {
  return {Term::Iri(kUser), Term::Iri(DocentIri("selected")), Term::Iri("http://example.org/" + what),
          Term::Iri("")};
}

class FactSenderTest : public testing::Test {
 protected:
  ScriptedServer server_;
  FactSender sender_{Options(), [this](const v1::AssertRequest& request, v1::AssertReply* reply) {
                       return server_.Assert(request, reply);
                     }};
};

TEST_F(FactSenderTest, SendsStatesOnlyOnChange) {
  sender_.Set(kRobot, DocentIri("x"), Decimal(1.5, 3));
  ASSERT_TRUE(sender_.Flush(absl::Seconds(10)));
  sender_.Set(kRobot, DocentIri("x"), Decimal(1.5, 3));
  sender_.Set(kRobot, DocentIri("x"), Decimal(1.6, 3));
  ASSERT_TRUE(sender_.Flush(absl::Seconds(10)));
  auto batches = server_.batches();
  ASSERT_EQ(batches.size(), 2u);
  EXPECT_EQ(batches[0].source(), kRobot);
  EXPECT_EQ(batches[1].add(0).object().literal().lexical(), "1.6");
  EXPECT_NE(batches[0].request_id(), batches[1].request_id());
}

TEST_F(FactSenderTest, ClearRemovesTheValueThatTheServerHas) {
  sender_.Set(kRobot, DocentIri("isAt"), Term::Iri("http://example.org/b1"));
  ASSERT_TRUE(sender_.Flush(absl::Seconds(10)));
  sender_.Clear(kRobot, DocentIri("isAt"));
  sender_.Clear(kRobot, DocentIri("isAt"));
  ASSERT_TRUE(sender_.Flush(absl::Seconds(10)));
  auto batches = server_.batches();
  ASSERT_EQ(batches.size(), 2u);
  EXPECT_EQ(batches[1].add_size(), 0);
  ASSERT_EQ(batches[1].remove_size(), 1);
  EXPECT_EQ(batches[1].remove(0).object().iri(), "http://example.org/b1");
}

TEST_F(FactSenderTest, StatesSetTogetherTravelTogether) {
  sender_.SetAll(kRobot,
                 {{DocentIri("x"), Decimal(1, 3)}, {DocentIri("y"), Decimal(2, 3)}, {DocentIri("isAt"), {}}});
  ASSERT_TRUE(sender_.Flush(absl::Seconds(10)));
  ASSERT_EQ(server_.batches().size(), 1u);
  EXPECT_EQ(server_.batches()[0].add_size(), 2);
  EXPECT_EQ(server_.batches()[0].remove_size(), 0);
}

TEST_F(FactSenderTest, WhatWasNotMeasuredIsNotToldAndSpoilsNothingElse) {
  sender_.SetAll(kRobot, {{DocentIri("x"), Decimal(1, 3)}, {DocentIri("y"), Decimal(2, 3)}});
  ASSERT_TRUE(sender_.Flush(absl::Seconds(10)));
  sender_.Set(kRobot, DocentIri("status"), Term::Iri(DocentIri("Busy")));
  sender_.SetAll(kRobot, {{DocentIri("x"), Decimal(3, 3)}, {DocentIri("y"), Decimal(std::nan(""), 3)}});
  sender_.Set(kRobot, "http://example.org/battery", Term::Literal("INF", std::string(kXsdDouble)));
  ASSERT_TRUE(sender_.Flush(absl::Seconds(10)));
  EXPECT_EQ(sender_.refused(), 2u);
  std::string told;
  for (const v1::AssertRequest& batch : server_.batches()) {
    for (const v1::Quad& quad : batch.add())
      absl::StrAppend(&told, quad.object().has_iri() ? "status" : quad.object().literal().lexical(), " ");
  }
  EXPECT_EQ(told, "1.0 2.0 status ") << "an x without its y would be another place";
  EXPECT_FALSE(sender_
                   .Tell({{Term::Iri(kUser), Term::Iri(DocentIri("weight")),
                           Term::Literal("NaN", std::string(kXsdDouble)), Term::Iri("")}})
                   .ok());
  EXPECT_FALSE(
      sender_.Tell({}, {}, {{"http://example.org/scales", Term::Literal("NaN", std::string(kXsdDouble))}})
          .ok());
}

TEST_F(FactSenderTest, LeftoverIsWithdrawnUnlessToldAnew) {
  const Term old_place = Term::Iri("http://example.org/b1");
  sender_.WithdrawLeftover(kRobot, DocentIri("isAt"), old_place);
  sender_.Set(kRobot, DocentIri("progress"), Decimal(0.5, 2));
  sender_.WithdrawLeftover(kRobot, DocentIri("progress"), Decimal(0.1, 2));
  ASSERT_TRUE(sender_.Flush(absl::Seconds(10)));
  int removed = 0;
  for (const v1::AssertRequest& batch : server_.batches()) {
    for (const v1::Quad& quad : batch.remove()) {
      EXPECT_EQ(quad.object().iri(), old_place.lexical);
      ++removed;
    }
  }
  EXPECT_EQ(removed, 1);
}

TEST_F(FactSenderTest, WhileTheServerIsAwayStatesMergeButNeverOvertakeAnEvent) {
  server_.SetAway(true);
  sender_.Set(kRobot, DocentIri("x"), Decimal(0, 3));
  server_.AwaitCalls(1);  // the first batch is on its way now
  for (int i = 1; i <= 50; ++i) sender_.Set(kRobot, DocentIri("x"), Decimal(i, 3));
  ASSERT_TRUE(sender_.Tell({Event("b1")}).ok());
  for (int i = 51; i <= 99; ++i) sender_.Set(kRobot, DocentIri("x"), Decimal(i, 3));
  server_.SetAway(false);
  ASSERT_TRUE(sender_.Flush(absl::Seconds(10)));
  auto batches = server_.batches();
  ASSERT_EQ(batches.size(), 4u);
  EXPECT_EQ(batches[0].add(0).object().literal().lexical(), "0.0");
  EXPECT_EQ(batches[1].add(0).object().literal().lexical(), "50.0");
  EXPECT_EQ(batches[2].add(0).object().iri(), "http://example.org/b1");
  EXPECT_EQ(batches[3].add(0).object().literal().lexical(), "99.0");
}

TEST_F(FactSenderTest, LostAnswerRepeatsTheSameRequestId) {
  server_.LoseAnswers(3);
  for (int i = 0; i < 4; ++i) {
    ASSERT_TRUE(sender_.Tell({Event(std::to_string(i))}).ok());
    ASSERT_TRUE(sender_.Flush(absl::Seconds(10)));
  }
  auto batches = server_.batches();
  ASSERT_EQ(batches.size(), 4u);  // the server drops repeats by id, so each came once
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(batches[i].add(0).object().iri(), "http://example.org/" + std::to_string(i));
  }
  EXPECT_EQ(sender_.refused(), 0u);
}

TEST_F(FactSenderTest, FullQueueRefusesTheNextEventAndStillTakesStates) {
  server_.SetAway(true);
  ASSERT_TRUE(sender_.Tell({Event("first")}).ok());
  server_.AwaitCalls(1);
  for (int i = 0; i < 4; ++i) ASSERT_TRUE(sender_.Tell({Event(std::to_string(i))}).ok());
  EXPECT_TRUE(absl::IsResourceExhausted(sender_.Tell({Event("one too many")})));
  sender_.Set(kRobot, DocentIri("x"), Decimal(7, 3));
  server_.SetAway(false);
  ASSERT_TRUE(sender_.Flush(absl::Seconds(10)));
  ASSERT_EQ(server_.batches().size(), 6u);
  EXPECT_EQ(server_.batches()[5].add(0).object().literal().lexical(), "7.0");
}

TEST_F(FactSenderTest, RefusedBatchIsCountedAndTheNextGoesOn) {
  server_.SetRefuse(true);
  ASSERT_TRUE(sender_.Tell({Event("bad")}).ok());
  ASSERT_TRUE(sender_.Flush(absl::Seconds(10)));
  server_.SetRefuse(false);
  ASSERT_TRUE(sender_.Tell({}, {}, {{"http://example.org/door", Term::Literal("tag-17")}}).ok());
  ASSERT_TRUE(sender_.Flush(absl::Seconds(10)));
  EXPECT_EQ(sender_.refused(), 1u);
  ASSERT_EQ(server_.batches().size(), 1u);
  EXPECT_EQ(server_.batches()[0].readings(0).sensor(), "http://example.org/door");
}

TEST_F(FactSenderTest, ResendTellsEveryStateAgain) {
  sender_.Set(kRobot, DocentIri("x"), Decimal(1, 3));
  sender_.Set(kRobot, DocentIri("y"), Decimal(2, 3));
  ASSERT_TRUE(sender_.Flush(absl::Seconds(10)));
  sender_.ResendStates();
  ASSERT_TRUE(sender_.Flush(absl::Seconds(10)));
  EXPECT_EQ(server_.batches().back().add_size(), 2);
}

TEST(FactSenderStopTest, StopWhileTheServerIsAwayReturns) {
  ScriptedServer server;
  server.SetAway(true);
  FactSender sender(Options(), [&](const v1::AssertRequest& request, v1::AssertReply* reply) {
    return server.Assert(request, reply);
  });
  sender.Set(kRobot, DocentIri("x"), Decimal(1, 3));
  server.AwaitCalls(2);
  sender.Stop(absl::Milliseconds(5));
  EXPECT_FALSE(sender.Flush(absl::Milliseconds(1)));
}

TEST(DecimalTest, IsCanonical) {
  EXPECT_EQ(Decimal(2, 3).lexical, "2.0");
  EXPECT_EQ(Decimal(-0.0001, 3).lexical, "0.0");
  EXPECT_EQ(Decimal(1.2345, 3).lexical, "1.234");
  EXPECT_EQ(Decimal(-10.5, 3).lexical, "-10.5");
  EXPECT_EQ(Decimal(100, 0).lexical, "100.0");
  EXPECT_EQ(Decimal(0.05, 2).datatype, kXsdDecimal);
}

}  // namespace
}  // namespace docent::robot
