// What is said of a condition that did not open its node in time, and that all of its alternatives are told of while it waits.
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "gmock/gmock.h"
#include "graph/calendar/time_spec.h"
#include "graph/store/graph_reader.h"
#include "gtest/gtest.h"
#include "tests/kb_server/turn/run_fixture.h"

namespace docent::server {
namespace {

using test::Fact;
using test::Tell;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr char kNotHeld[] = "node A: its condition did not hold within 5 s: ";

class RunLacksTest : public RunActionsTest {
 protected:
  // Of the last of so many runs, one after the other.
  std::string FailsWith(const std::string& condition, int runs = 1) {
    std::string timed = condition;
    timed.insert(std::string("<condition").size(), " ext:timeout=\"5s\"");
    DeployOne(timed);
    for (; runs > 0; --runs) Run({{"x", test::Iri("John")}});
    now_us_ += 6'000'000;
    WriteBatch tick;
    tick.clock_tick = true;
    for (const Transition& t : Must(std::move(tick)).record.transitions) {
      if (t.to == "failed" && t.subject.find('/') == std::string::npos) return t.cause;
    }
    return "";
  }
  static std::string Rule(const std::string& expression, const std::vector<std::string>& constraints) {
    return absl::StrCat("<condition>", Context("c", expression, constraints), "</condition>");
  }
  static std::string Context(const std::string& name, const std::string& expression,
                             const std::vector<std::string>& constraints) {
    std::string text = absl::StrCat("<context name=\"", name, "\"><rule");
    if (!expression.empty()) absl::StrAppend(&text, " expression=\"", expression, "\"");
    text += ">";
    for (const std::string& constraint : constraints) text += constraint;
    return text + "</rule></context>";
  }
  static std::string Constraint(const std::string& name, const std::string& s, const std::string& v,
                                const std::string& o) {
    return absl::StrCat("<constraint name=\"", name, "\"><subject>", s, "</subject><verb>", v,
                        "</verb><object>", o, "</object></constraint>");
  }
  // A context of two facts, one of one fact, and an event.
  static std::string Alternatives(const std::string& expression) {
    return absl::StrCat(
        "<condition", expression.empty() ? "" : absl::StrCat(" expression=\"", expression, "\""), ">",
        Context("a", "",
                {Constraint("h", "w:o", "w:hold", "false"), Constraint("t", "w:o", "w:temp", "&gt; 4")}),
        Context("b", "", {Constraint("r", "w:o", "w:state", "w:Refused")}),
        "<case name=\"c\"><event operation=\"bell\"/></case></condition>");
  }
  // The ASKs of docent:waitsFor.
  std::vector<std::string> WaitsFor(const std::string& condition) {
    DeployOne(condition);
    Run();
    const GraphReader graph(dictionary_, stages_.writer.current());
    return absl::StrSplit(graph.Object("urn:docent:run:F-1/A", DocentIri("waitsFor")), "\n# or\n");
  }
};

TEST_F(RunLacksTest, AConditionThatDidNotHoldInTimeNamesWhatLacked) {
  Must(Tell({Fact("John", "isAt", "Hall")}));
  EXPECT_EQ(
      FailsWith(Rule("", {Constraint("a", "$x", "w:isAt", "w:Hall"), Constraint("b", "$x", "w:has", "?t")})),
      absl::StrCat(kNotHeld, "it lacks <urn:w:John> w:has ?t"));
}

TEST_F(RunLacksTest, WhatIsInItsWayIsNamed) {
  Must(Tell({Fact("Hall", "closed", Term::Boolean(true))}));
  EXPECT_EQ(FailsWith(Rule("not c", {Constraint("c", "w:Hall", "w:closed", "true")})),
            absl::StrCat(kNotHeld, "in its way is w:Hall w:closed true"));
  EXPECT_EQ(FailsWith(Rule("a and (b or not c)",
                           {Constraint("a", "w:a", "w:p", "&gt; 3"), Constraint("b", "w:b", "w:p", "1"),
                            Constraint("c", "w:Hall", "w:closed", "true")})),
            absl::StrCat(kNotHeld,
                         "it lacks w:a w:p > 3, it lacks w:b w:p 1; or it lacks w:a w:p > 3, in its way is "
                         "w:Hall w:closed true"));
}

// What is absent of other things than those that match is not in the way of these.
TEST_F(RunLacksTest, WhatIsInTheWayOfOthersIsNot) {
  const std::string ready = Rule(
      "a and not b", {Constraint("a", "?r", "w:ready", "true"), Constraint("b", "?r", "w:broken", "?w")});
  Must(Tell({Fact("R2", "broken", "Wheel")}));
  EXPECT_EQ(FailsWith(ready), absl::StrCat(kNotHeld, "it lacks ?r w:ready true"));
  Must(Tell({Fact("R2", "ready", Term::Boolean(true))}));
  EXPECT_EQ(FailsWith(ready), absl::StrCat(kNotHeld, "in its way is ?r w:broken ?w"));
}

TEST_F(RunLacksTest, OfWhatMayNotBeTogetherAllIsNamed) {
  Must(Tell({Fact("e", "p", "b"), Fact("c", "q", "d")}));
  EXPECT_EQ(FailsWith(Rule("not (a and b)",
                           {Constraint("a", "w:e", "w:p", "w:b"), Constraint("b", "w:c", "w:q", "w:d")})),
            absl::StrCat(kNotHeld, "in its way is (w:e w:p w:b and w:c w:q w:d)"));
}

TEST_F(RunLacksTest, WhatIsThereButNotTogetherIsSaid) {
  Must(Tell({Fact("e", "p", "b"), Fact("c", "q", "d")}));
  EXPECT_EQ(FailsWith(Rule("", {Constraint("a", "?s", "w:p", "w:b"), Constraint("b", "?s", "w:q", "w:d")})),
            absl::StrCat(kNotHeld, "each of its facts is there, but not together"));
}

TEST_F(RunLacksTest, WhatIsThereButNotForLongEnoughIsSaid) {
  Must(Tell({Fact("e", "p", "b")}));
  std::string lasting = Rule("", {Constraint("a", "w:e", "w:p", "w:b")});
  lasting.insert(lasting.find("<rule") + 5, " ext:for=\"1min\"");
  EXPECT_EQ(FailsWith(lasting),
            absl::StrCat(kNotHeld, "each of its facts is there, but not for long enough"));
}

TEST_F(RunLacksTest, AnEventIsNamed) {
  EXPECT_THAT(FailsWith("<condition><case><event operation=\"ring\"/></case></condition>"),
              HasSubstr("it lacks the event ring"));
}

TEST_F(RunLacksTest, AlternativesAreToldApartWithAnExpressionAsWithoutOne) {
  const std::string all = absl::StrCat(kNotHeld,
                                       "it lacks w:o w:hold false, it lacks w:o w:temp > 4; or it lacks w:o "
                                       "w:state w:Refused; or it lacks the event bell");
  EXPECT_EQ(FailsWith(Alternatives("")), all);
  EXPECT_EQ(FailsWith(Alternatives("a or b or c")), all);
  Must(Tell({Fact("o", "hold", Term::Boolean(false))}));
  EXPECT_EQ(FailsWith(Alternatives("a and (b or c)")),
            absl::StrCat(kNotHeld,
                         "it lacks w:o w:temp > 4, it lacks w:o w:state w:Refused; or it lacks the event "
                         "bell, it lacks w:o w:temp > 4"));
}

TEST_F(RunLacksTest, OfManyAlternativesSomeAreNamed) {
  std::string names;
  std::vector<std::string> constraints;
  for (int i = 0; i < 8; ++i) {
    absl::StrAppend(&names, i == 0 ? "" : " or ", "n", i);
    constraints.push_back(Constraint(absl::StrCat("n", i), "w:o", "w:p", absl::StrCat(i)));
  }
  const std::string said = FailsWith(Rule(names, constraints));
  EXPECT_THAT(said, HasSubstr("; or it lacks w:o w:p 4; or one of 3 more alternatives"));
}

TEST_F(RunLacksTest, ATimeIsToldInFull) {
  const auto of_time = [&](const std::string& attributes) {
    return FailsWith(absl::StrCat("<condition><context><ext:time ", attributes, "/></context></condition>"));
  };
  EXPECT_EQ(of_time("between=\"03:00-04:00\""),
            absl::StrCat(kNotHeld, "it lacks <", calendar::TimeIri({{"between", "03:00-04:00"}}),
                         "> docent:timeHolds true"));
  EXPECT_EQ(
      of_time("at=\"03:00\""),
      absl::StrCat(kNotHeld, "it lacks <", calendar::TimeIri({{"at", "03:00"}}), "> docent:occurs true"));
  EXPECT_EQ(of_time("open=\"w:Cafe\""), absl::StrCat(kNotHeld, "it lacks w:Cafe docent:openNow true"));
}

TEST_F(RunLacksTest, ATimeInTheWayIsToldInFull) {
  const std::string window = calendar::TimeIri({{"between", "22:00-23:00"}});
  Must(Tell({{Term::Iri(window), Term::Iri(DocentIri("timeHolds")), Term::Boolean(true), Term()}}));
  EXPECT_EQ(FailsWith("<condition><context><rule expression=\"not t\"><ext:time name=\"t\" "
                      "between=\"22:00-23:00\"/></rule></context></condition>"),
            absl::StrCat(kNotHeld, "in its way is <", window, "> docent:timeHolds true"));
}

TEST_F(RunLacksTest, RobotsWithWhichItHoldsAreNamedWithWhatKeepsThem) {
  Must(Tell(test::FreeRobots({"R1", "R2"}, "look")));
  Must(Tell({Fact("R1", "ready", Term::Boolean(true)), Fact("R2", "ready", Term::Boolean(true)),
             Fact("R2", "docent:outOfService", Term::Literal("smoke")), Fact("R3", "broken", "Wheel")}));
  const std::string held =
      "node A: its condition holds, but no robot with which it does became free within 5 s: <urn:w:R1> is "
      "held by run F-1; <urn:w:R2> is out of service: smoke";
  const std::string look = "<invoke operation=\"look\"/>";
  EXPECT_EQ(FailsWith(Rule("a and not b", {Constraint("a", "?robot", "w:ready", "true"),
                                           Constraint("b", "?robot", "w:broken", "?w")}) +
                          look,
                      2),
            held);
  const std::string robot_or =
      absl::StrCat("<condition>", Context("a", "", {Constraint("a", "?robot", "w:ready", "true")}),
                   Context("b", "", {Constraint("b", "w:o", "w:state", "w:Refused")}), "</condition>", look);
  EXPECT_EQ(FailsWith(robot_or), absl::StrCat(held, "; or it lacks w:o w:state w:Refused"));
}

TEST_F(RunLacksTest, EachAlternativeThatIsWaitedForIsAnAsk) {
  const auto asks = WaitsFor(Alternatives("a or b or c"));
  ASSERT_EQ(asks.size(), 3u);
  EXPECT_THAT(asks[0], HasSubstr("hold"));
  EXPECT_THAT(asks[0], Not(HasSubstr("Refused")));
  EXPECT_THAT(asks[1], HasSubstr("Refused"));
  EXPECT_THAT(asks[2], HasSubstr("bell"));
}

TEST_F(RunLacksTest, SoIsEachOfARule) {
  std::string either =
      Rule("a or b", {Constraint("a", "w:a", "w:p", "1"), Constraint("b", "w:b", "w:p", "2")});
  either.insert(either.find("<rule") + 5, " name=\"r\" ext:for=\"1min\"");
  EXPECT_THAT(WaitsFor(either), ElementsAre(HasSubstr("# rule r: for at least 1min"),
                                            HasSubstr("# rule r: for at least 1min")));
}

// What a run told stays when what it did is undone, but for what lasts as long as the run.
TEST_F(RunLacksTest, FactsThatNothingUndoesAreNamed) {
  Must(Tell(test::FreeRobots({"R1"}, "act")));
  for (const bool stays : {false, true}) {
    Deploy(absl::StrCat("<node name=\"A\" ext:compensate=\"act\"><invoke operation=\"act\"/></node><node "
                        "name=\"B\"><ext:tell",
                        stays ? "" : " lifetime=\"run\"",
                        ">w:o w:state w:Picked</ext:tell><ext:tell at=\"failure\">w:o w:state "
                        "w:Failed</ext:tell></node><node name=\"C\"><ext:fail reason=\"no\"/></node>"),
           {"A", "B", "C"});
    std::string said;
    for (TurnResult turn = Run(); !turn.record.commands.empty();) {
      turn = Must(test::Report(turn.record.commands[0].id, CommandReport::Outcome::kSucceeded));
      for (const Transition& t : turn.record.transitions) {
        if (t.to == "failed" && t.subject.find('/') == std::string::npos) said = t.cause;
      }
    }
    EXPECT_EQ(said, stays ? "node C: no; not undone: B: what was told, withdrawn or notified stays so"
                          : "node C: no; what it did was undone");
  }
}

}  // namespace
}  // namespace docent::server
