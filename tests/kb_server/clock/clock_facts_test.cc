// Time triggers turn by turn: the clock tells, conditions see, workflows start and open.
#include "kb_server/clock/clock_facts.h"

#include "absl/strings/match.h"
#include "absl/strings/str_join.h"
#include "absl/time/time.h"
#include "gmock/gmock.h"
#include "graph/rdf/date_time.h"
#include "gtest/gtest.h"
#include "kb_server/turn/turn.h"
#include "tests/kb_server/test_world.h"

namespace docent::server {
namespace {

using test::Fact;
using test::Put;
using test::Tell;

constexpr TimeMicros kSecond = 1'000'000, kMinute = 60 * kSecond, kHour = 60 * kMinute, kDay = 24 * kHour;

TimeMicros At(const std::string& utc) {
  return MicrosOfDateTime(utc + ":00Z");
}

// A server's stages, and a clock whose hands a test sets.
class ClockFactsTest : public testing::Test {
 protected:
  ClockFactsTest() { Turn(test::WorldFacts()); }

  TurnResult Turn(WriteBatch batch) {
    batch.time_us = steady_us_;
    auto result = RunTurn(stages_.get(), std::move(batch), ++head_);
    EXPECT_TRUE(result.ok()) << result.status();
    if (!result.ok()) return TurnResult();
    records_.push_back(result->record);
    return *std::move(result);
  }

  // The clock tells what there is to tell; returns how often something occurred.
  int Look() {
    int occurred = 0;
    for (int looks = 0; looks < 10; ++looks) {
      ClockFacts facts = ClockFactsAt({wall_us_, steady_us_}, dictionary_, stages_->writer.current());
      news_.insert(news_.end(), facts.news.begin(), facts.news.end());
      next_ = facts;
      if (facts.operations.empty()) return occurred;
      occurred += facts.occurs ? 1 : 0;
      WriteBatch batch;
      batch.source = kClockGraph;
      batch.mode = WriteBatch::Mode::kLoad;
      batch.operations = std::move(facts.operations);
      Turn(std::move(batch));
    }
    ADD_FAILURE() << "the clock always has something to tell";
    return occurred;
  }
  // Time goes on, on both clocks.
  int GoTo(const std::string& utc) { return Go(At(utc) - wall_us_); }
  int Go(TimeMicros by) {
    wall_us_ += by;
    steady_us_ += by;
    WriteBatch tick;
    tick.clock_tick = true;
    Turn(std::move(tick));
    return Look();
  }
  // An operator sets the wall clock.
  int SetTo(const std::string& utc) {
    wall_us_ = At(utc);
    return Look();
  }

  // A document with an activator with this context, and one with a node that waits for it.
  static std::string Activator(const std::string& context) {
    return Document("<activator name=\"A\"><activate flow=\"F\"/><condition><context>" + context +
                        "</context></condition></activator>",
                    "");
  }
  static std::string Node(const std::string& context, const std::string& more = "") {
    return Document("", "<condition><context>" + context + "</context>" + more + "</condition>");
  }
  static std::string Document(const std::string& activator, const std::string& condition) {
    return "<CAWL name=\"T\" xmlns:ext=\"https://w3id.org/docent/cawl-ext#\" xmlns:w=\"urn:w:\">" +
           activator + "<flow name=\"F\"><source name=\"s\"/><node name=\"N\">" + condition +
           "</node><sink name=\"e\"/><link from=\"s\" to=\"N\"/><link from=\"N\" to=\"e\"/></flow></CAWL>";
  }
  void Deploy(const std::string& text) {
    Turn(Put(Document::Kind::kCawl, "t.xml", text));
    Look();
  }
  void Start() {
    Turn(test::Start("T/F"));
    Look();
  }
  using Kind = docent::Document::Kind;

  size_t live() const { return stages_->engine.live_runs(); }
  // Runs that were started so far.
  size_t runs() const { return Subjects("docent:runState"); }
  size_t Subjects(const std::string& property) const {
    const auto predicate = dictionary_.FindIri(test::Name(property));
    size_t count = 0;
    if (predicate) {
      stages_->writer.current().ForEach({{}, *predicate, {}, {}}, [&](const Quad&) { return ++count > 0; });
    }
    return count;
  }
  std::string Value(const std::string& property) const {
    const auto predicate = dictionary_.FindIri(test::Name(property));
    std::vector<std::string> values;
    if (predicate) {
      stages_->writer.current().ForEach({{}, *predicate, {}, {}}, [&](const Quad& quad) {
        values.push_back(dictionary_.Decode(quad.object).lexical);
        return true;
      });
    }
    return absl::StrJoin(values, " ");
  }

  Dictionary dictionary_;
  sparql::FunctionRegistry functions_;
  std::unique_ptr<Stages> stages_ = std::make_unique<Stages>(&dictionary_, &functions_, Limits());
  uint64_t head_ = 0;
  std::vector<log::TurnRecord> records_;
  TimeMicros wall_us_ = At("2026-11-26T10:00"), steady_us_ = 1000 * kSecond;
  std::vector<std::string> news_;
  ClockFacts next_;
};

TEST_F(ClockFactsTest, NothingIsToldWhereNobodyAsks) {
  EXPECT_EQ(Look(), 0);
  EXPECT_FALSE(next_.next_wall_us.has_value());
  EXPECT_EQ(Subjects("docent:timeHolds"), 0u);
}

TEST_F(ClockFactsTest, ANodeOpensInItsHours) {
  Deploy(Node("<ext:time between=\"11:00-12:00\"/>"));
  Start();
  EXPECT_EQ(Value("docent:timeHolds"), "false");
  EXPECT_EQ(next_.next_wall_us, At("2026-11-26T11:00"));
  GoTo("2026-11-26T10:59");
  EXPECT_EQ(live(), 1u);
  GoTo("2026-11-26T11:00");
  EXPECT_EQ(live(), 0u);
  Look();
  EXPECT_EQ(Subjects("docent:timeHolds"), 0u) << "no condition asks any more";
}

TEST_F(ClockFactsTest, AnHourThatIsNotKnownYetIsNotAbsent) {
  Deploy(Node("<rule expression=\"not day\"><ext:time name=\"day\" between=\"09:00-17:00\"/></rule>"));
  Start();
  EXPECT_EQ(live(), 1u) << "it is day";
  GoTo("2026-11-26T17:00");
  EXPECT_EQ(live(), 0u);
}

TEST_F(ClockFactsTest, TimesAndFactsAreJoinedByAndOrNot) {
  Deploy(Node(
      "<rule expression=\"(early or late) and not busy\">"
      "<ext:time name=\"early\" between=\"06:00-08:00\"/><ext:time name=\"late\" between=\"20:00-22:00\"/>"
      "<constraint "
      "name=\"busy\"><subject>w:Hall</subject><verb>w:is</verb><object>w:Busy</object></constraint>"
      "</rule>"));
  Turn(Tell({Fact("Hall", "is", "Busy")}));
  Start();
  GoTo("2026-11-26T21:00");
  EXPECT_EQ(live(), 1u) << "busy";
  GoTo("2026-11-26T23:00");
  Turn(Tell({}, {Fact("Hall", "is", "Busy")}));
  EXPECT_EQ(live(), 1u) << "too late";
  GoTo("2026-11-27T06:30");
  EXPECT_EQ(live(), 0u);
}

TEST_F(ClockFactsTest, ADailyTimeStartsOneRunADay) {
  Deploy(Activator("<ext:time at=\"18:00\"/>"));
  EXPECT_EQ(GoTo("2026-11-26T17:59"), 0);
  EXPECT_EQ(runs(), 0u);
  EXPECT_EQ(GoTo("2026-11-26T18:00"), 1);
  EXPECT_EQ(runs(), 1u);
  EXPECT_EQ(Subjects("docent:occurs"), 0u) << "an occurrence does not stay";
  EXPECT_EQ(Value("docent:lastOccurrence"), "2026-11-26T18:00:00Z");
  EXPECT_EQ(Value("docent:nextOccurrence"), "2026-11-27T18:00:00Z");
  EXPECT_EQ(GoTo("2026-11-26T18:30"), 0);
  EXPECT_EQ(GoTo("2026-11-27T18:00"), 1);
  EXPECT_EQ(runs(), 2u);
  EXPECT_TRUE(news_.empty()) << news_[0];
}

TEST_F(ClockFactsTest, AnOccurrenceCountsOnlyWithWhatHoldsInItsTurn) {
  Deploy(Activator(
      "<rule><ext:time at=\"18:00\"/>"
      "<constraint><subject>w:Sky</subject><verb>w:is</verb><object>w:Wet</object></constraint></rule>"));
  GoTo("2026-11-26T18:00");
  Turn(Tell({Fact("Sky", "is", "Wet")}));
  EXPECT_EQ(runs(), 0u) << "it rains later";
  GoTo("2026-11-27T18:00");
  EXPECT_EQ(runs(), 1u);
}

TEST_F(ClockFactsTest, AClockThatIsSetAheadMakesADailyTimeLateAndOnce) {
  Deploy(Activator("<ext:time at=\"18:00\"/>"));
  EXPECT_EQ(SetTo("2026-11-26T20:00"), 1);
  EXPECT_EQ(runs(), 1u);
  EXPECT_THAT(news_, testing::ElementsAre(testing::HasSubstr("was missed; it occurs now")));
  EXPECT_EQ(SetTo("2026-11-26T10:00"), 0) << "and back again";
  EXPECT_EQ(GoTo("2026-11-26T18:00"), 0) << "it occurred already";
  EXPECT_EQ(GoTo("2026-11-27T18:00"), 1);
  EXPECT_EQ(runs(), 2u);
}

TEST_F(ClockFactsTest, AClockThatIsSetBackRepeatsNothing) {
  Deploy(Activator("<ext:time at=\"18:00\"/>"));
  GoTo("2026-11-26T18:10");
  EXPECT_EQ(runs(), 1u);
  EXPECT_EQ(SetTo("2026-11-26T17:10"), 0);
  EXPECT_EQ(GoTo("2026-11-26T18:00"), 0);
  EXPECT_EQ(GoTo("2026-11-27T18:00"), 1);
  EXPECT_EQ(runs(), 2u);
}

TEST_F(ClockFactsTest, AClockThatWasFarAheadLosesNoDay) {
  Deploy(Activator("<ext:time at=\"18:00\"/>"));
  EXPECT_EQ(SetTo("2030-01-01T12:00"), 1);
  SetTo("2026-11-26T17:00");
  EXPECT_EQ(GoTo("2026-11-26T18:00"), 1) << "the new time counts";
  EXPECT_EQ(runs(), 2u);
}

TEST_F(ClockFactsTest, SeveralMissedDaysOccurOnce) {
  Deploy(Activator("<ext:time at=\"18:00\"/>"));
  EXPECT_EQ(GoTo("2026-11-29T12:00"), 1) << "as after a restart";
  EXPECT_EQ(Value("docent:lastOccurrence"), "2026-11-28T18:00:00Z");
  EXPECT_EQ(runs(), 1u);
}

TEST_F(ClockFactsTest, WhatIsMissedMayBeLeftOut) {
  Deploy(Activator("<ext:time at=\"18:00\" missed=\"skip\"/>"));
  EXPECT_EQ(GoTo("2026-11-26T20:00"), 0);
  EXPECT_EQ(runs(), 0u);
  EXPECT_EQ(Value("docent:missedOccurrence"), "2026-11-26T18:00:00Z") << "not in silence";
  EXPECT_EQ(GoTo("2026-11-27T18:00"), 1);
  EXPECT_EQ(runs(), 1u);
}

TEST_F(ClockFactsTest, ALittleLateIsNotMissed) {
  Deploy(Activator("<ext:time at=\"18:00\" missed=\"skip\"/>"));
  GoTo("2026-11-26T17:59");
  EXPECT_EQ(Go(kMinute + 5 * kSecond), 1);
  EXPECT_EQ(runs(), 1u);
}

TEST_F(ClockFactsTest, AnIntervalFollowsTheSteadyClock) {
  Deploy(Activator("<ext:time every=\"10min\"/>"));
  EXPECT_EQ(Go(9 * kMinute), 0);
  EXPECT_EQ(SetTo("2026-11-26T23:00"), 0) << "setting the wall clock moves no interval";
  EXPECT_EQ(Go(kMinute), 1);
  EXPECT_EQ(Go(10 * kMinute), 1);
  EXPECT_EQ(Go(35 * kMinute), 1) << "a server that was down";
  EXPECT_EQ(Go(5 * kMinute), 1) << "and the grid stays";
  EXPECT_EQ(runs(), 4u);
}

TEST_F(ClockFactsTest, TheSameDocumentAgainFiresNothingAndGoesOn) {
  Deploy(Activator("<ext:time every=\"10min\"/>"));
  Go(6 * kMinute);
  Deploy(Activator("<ext:time every=\"10min\"/>"));
  EXPECT_EQ(runs(), 0u);
  EXPECT_EQ(Go(4 * kMinute), 1);
  EXPECT_EQ(runs(), 1u);
}

TEST_F(ClockFactsTest, ADelayIsCountedFromWhenTheNodeIsEntered) {
  Deploy(Node("<ext:time after=\"30s\"/>"));
  Start();
  EXPECT_EQ(stages_->NextDeadline(), steady_us_ + 30 * kSecond);
  Go(29 * kSecond);
  EXPECT_EQ(live(), 1u);
  Go(kSecond);
  EXPECT_EQ(live(), 0u);
}

TEST_F(ClockFactsTest, ADelayIsJoinedWithFacts) {
  Deploy(
      Node("<ext:time after=\"30s\"/><rule><constraint><subject>w:Door</subject><verb>w:is</verb>"
           "<object>w:Open</object></constraint></rule>"));
  Start();
  Turn(Tell({Fact("Door", "is", "Open")}));
  EXPECT_EQ(live(), 1u);
  Go(30 * kSecond);
  EXPECT_EQ(live(), 0u);
  Start();
  Turn(Tell({}, {Fact("Door", "is", "Open")}));
  Go(40 * kSecond);
  EXPECT_EQ(live(), 1u);
  Turn(Tell({Fact("Door", "is", "Open")}));
  EXPECT_EQ(live(), 0u) << "at once, since the time is over";
}

TEST_F(ClockFactsTest, ATriggerOfTheGraphIsAFactForRules) {
  Turn(Put(Document::Kind::kRules, "night.rules",
           R"(PREFIX docent: <https://w3id.org/docent#> PREFIX w: <urn:w:>
    RULE { ?robot w:volume "soft" } WHERE { w:Night docent:timeHolds true . ?robot a docent:Robot })"));
  Turn(Tell({Fact("Night", "a", "docent:TimeTrigger"),
             Fact("Night", "docent:between", Term::Literal("22:00-06:00")),
             Fact("Night", "docent:timeZone", Term::Literal("Europe/Berlin"))}));
  Look();
  EXPECT_EQ(Value("urn:w:volume"), "");
  GoTo("2026-11-26T21:00");
  EXPECT_EQ(Value("urn:w:volume"), "soft") << "22:00 in Berlin";
  GoTo("2026-11-27T05:00");
  EXPECT_EQ(Value("urn:w:volume"), "");
  Turn(Tell({Fact("Night", "docent:between", Term::Literal("05:00-07:00"))},
            {Fact("Night", "docent:between", Term::Literal("22:00-06:00"))}));
  Look();
  EXPECT_EQ(Value("urn:w:volume"), "soft") << "described otherwise";
  Turn(Tell({Fact("Night", "docent:onDays", Term::Literal("Someday"))}));
  Look();
  EXPECT_EQ(Value("docent:timeHolds"), "");
  EXPECT_TRUE(absl::StrContains(Value("docent:timeFault"), "Someday"));
}

TEST_F(ClockFactsTest, APlaceIsOpenByItsOpeningHours) {
  const auto hours = [](const std::string& node, const std::string& opens, const std::string& closes) {
    return std::vector<TermQuad>{Fact(node, "https://schema.org/opens", Term::Literal(opens)),
                                 Fact(node, "https://schema.org/closes", Term::Literal(closes))};
  };
  const std::string ns = "https://schema.org/";
  Turn(Tell({Fact("Cafe", ns + "openingHoursSpecification", "H1"),
             Fact("H1", ns + "dayOfWeek", ns + "Thursday"), Fact("H1", ns + "dayOfWeek", ns + "Friday"),
             Fact("Cafe", ns + "specialOpeningHoursSpecification", "H2"),
             Fact("H2", ns + "validFrom", Term::Literal("2026-12-24", std::string(kXsdDate))),
             Fact("H2", ns + "validThrough", Term::Literal("2026-12-25", std::string(kXsdDate)))}));
  Turn(Tell(hours("H1", "18:00:00", "02:00:00")));
  Turn(Tell(hours("H2", "00:00", "00:00")));
  Look();
  EXPECT_EQ(Value("docent:openNow"), "false");
  Deploy(Node("<ext:time open=\"?place\"/>"));
  Start();
  GoTo("2026-11-26T18:00");
  EXPECT_EQ(Value("docent:openNow"), "true");
  EXPECT_EQ(live(), 0u);
  GoTo("2026-11-27T01:59");
  EXPECT_EQ(Value("docent:openNow"), "true") << "Thursday's night";
  GoTo("2026-11-27T02:00");
  EXPECT_EQ(Value("docent:openNow"), "false");
  GoTo("2026-12-24T20:00");
  EXPECT_EQ(Value("docent:openNow"), "false") << "a special day, a Thursday";
  GoTo("2026-12-31T20:00");
  EXPECT_EQ(Value("docent:openNow"), "true");
}

TEST_F(ClockFactsTest, TheGraphSaysWhetherTheTimeIsSimulated) {
  const auto look = [&](bool simulated) {
    return ClockFactsAt({wall_us_, steady_us_, simulated}, dictionary_, stages_->writer.current());
  };
  const auto apply = [&](const ClockFacts& facts) {
    WriteBatch batch;
    batch.source = kClockGraph;
    batch.mode = WriteBatch::Mode::kLoad;
    batch.operations = facts.operations;
    Turn(std::move(batch));
  };
  EXPECT_TRUE(look(false).operations.empty());
  const ClockFacts begins = look(true);
  ASSERT_EQ(begins.operations.size(), 1u);
  apply(begins);
  EXPECT_EQ(Value("docent:simulatedTime"), "true");
  EXPECT_TRUE(look(true).operations.empty());
  const ClockFacts over = look(false);
  ASSERT_EQ(over.news.size(), 1u) << "the operator has to know that these times are not of this world";
  apply(over);
  EXPECT_EQ(Value("docent:simulatedTime"), "");
  EXPECT_TRUE(look(false).news.empty());
}

TEST_F(ClockFactsTest, AReplayNeedsNoClock) {
  Deploy(Activator("<ext:time at=\"18:00\"/>"));
  EXPECT_EQ(GoTo("2026-11-26T18:00"), 1);
  EXPECT_EQ(SetTo("2026-11-26T12:00"), 0);
  EXPECT_EQ(GoTo("2026-11-27T18:00"), 1);
  EXPECT_EQ(runs(), 2u);
  Dictionary dictionary;
  Stages again(&dictionary, &functions_, Limits());
  for (const log::TurnRecord& record : records_) {
    const auto result = RunTurn(&again, record.batch, record.offset);
    ASSERT_TRUE(result.ok()) << result.status();
    EXPECT_EQ(result->record, record) << record.offset;
  }
  EXPECT_EQ(again.writer.current().size(), stages_->writer.current().size());
}

}  // namespace
}  // namespace docent::server
