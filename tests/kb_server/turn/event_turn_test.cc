// Events are occurrences: each telling counts, and none stays.
#include <algorithm>

#include "gmock/gmock.h"
#include "graph/base/workflow_limits.h"
#include "gtest/gtest.h"
#include "tests/kb_server/turn/turn_fixture.h"
#include "tests/kb_server/writer/old_formats.h"

namespace docent::server {
namespace {

using test::Fact;
using test::Iri;
using test::kSecond;
using test::Put;
using test::StateInFormat;
using test::Tell;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

std::string Cawl(const std::string& activator, const std::string& flow) {
  return absl::StrCat(R"(<CAWL name="Bell" xmlns:docent="https://w3id.org/docent#" xmlns:w="urn:w:"
      xmlns:ext="https://w3id.org/docent/cawl-ext#">)",
                      activator, "<flow name=\"Answer\"><source name=\"s\"/>", flow,
                      "<sink name=\"e\"/></flow></CAWL>");
}
std::string OnCase(const std::string& condition) {
  return Cawl(absl::StrCat("<activator name=\"A\"><activate flow=\"Answer\"/>", condition, "</activator>"),
              "<node name=\"N\"/><link from=\"s\" to=\"N\"/><link from=\"N\" to=\"e\"/>");
}
// A constraint of its own context.
std::string Context(const std::string& s, const std::string& v, const std::string& o,
                    const std::string& attributes = "") {
  return absl::StrCat("<context name=\"c\"><rule name=\"r\"", attributes, "><constraint name=\"k\"><subject>",
                      s, "</subject><verb>", v, "</verb><object>", o,
                      "</object></constraint></rule></context>");
}
const char kRang[] = "<condition><case><event operation=\"doorbell\"/></case></condition>";

WriteBatch Event(const std::string& subject, const std::string& operation = "doorbell") {
  return Tell(
      {Fact(subject, "a", "docent:Event"), Fact(subject, "docent:operation", Term::Literal(operation))});
}
WriteBatch BlankEvent(const std::string& operation = "doorbell", const std::string& label = "b1") {
  WriteBatch batch;
  const Term event = Term::Blank(label);
  batch.operations.push_back({QuadOperation::Kind::kAdd, {event, Iri("a"), Iri("docent:Event"), Term()}});
  batch.operations.push_back(
      {QuadOperation::Kind::kAdd, {event, Iri("docent:operation"), Term::Literal(operation), Term()}});
  return batch;
}

class EventTurnTest : public test::TurnTest {
 protected:
  size_t Events() const {
    const auto type = dictionary_.FindIri(kRdfType), event = dictionary_.FindIri(DocentIri("Event"));
    return stages_->writer.current().Count({{}, *type, *event, {}});
  }
};

TEST_F(EventTurnTest, EachTellingOfTheSameEventStartsARun) {
  Turn(Put(Document::Kind::kCawl, "bell", OnCase(kRang)));
  EXPECT_THAT(Started(Turn(Event("ring"))), ElementsAre("Answer-1"));
  EXPECT_EQ(Events(), 1u) << "it is there at the revision that told it";
  Settle();
  EXPECT_EQ(Events(), 0u);
  EXPECT_EQ(Count("docent:operation"), 0u);
  EXPECT_THAT(Started(Turn(Event("ring"))), ElementsAre("Answer-2"));
  EXPECT_THAT(Started(Turn(Event("ring"))), ElementsAre("Answer-3")) << "told again before the clock's turn";
  Settle();
  EXPECT_EQ(Events(), 0u);
  EXPECT_EQ(stages_->NextDeadline(), std::nullopt) << "the clock has nothing to do";
}

TEST_F(EventTurnTest, AnEventWithoutANameIsANewOneEachTime) {
  Turn(Put(Document::Kind::kCawl, "bell", OnCase(kRang)));
  for (int i = 1; i <= 3; ++i) EXPECT_THAT(Started(Turn(BlankEvent())), SizeIs(1));
  WriteBatch two = BlankEvent("doorbell", "x");
  for (const QuadOperation& operation : BlankEvent("doorbell", "y").operations)
    two.operations.push_back(operation);
  EXPECT_THAT(Started(Turn(two)), SizeIs(2)) << "two of one batch are two";
  Settle();
  EXPECT_EQ(Events(), 0u);
}

TEST_F(EventTurnTest, TwoSourcesThatTellOneEventTellItTwice) {
  Turn(Put(Document::Kind::kCawl, "bell", OnCase(kRang)));
  for (const char* source : {"urn:w:Door", "urn:w:Camera"}) {
    WriteBatch ring = Event("ring");
    ring.source = source;
    EXPECT_THAT(Started(Turn(ring)), SizeIs(1)) << source;
  }
  WriteBatch both = Event("ring");
  WriteBatch other = Event("ring");
  for (QuadOperation& operation : other.operations) {
    operation.quad.graph = Iri("Other");
    both.operations.push_back(operation);
  }
  EXPECT_THAT(Started(Turn(both)), SizeIs(1)) << "one batch tells an event once";
  Settle();
  EXPECT_EQ(Events(), 0u);
}

TEST_F(EventTurnTest, WhatWasToldWithAnEventLeavesWithItAndWhatWasThereBeforeStays) {
  Turn(Put(Document::Kind::kCawl, "bell", OnCase(kRang)));
  Turn(Tell({Fact("ring", "label", Term::Literal("front door")), Fact("John", "a", "docent:Visitor")}));
  WriteBatch ring = Event("ring");
  ring.operations.push_back({QuadOperation::Kind::kAdd, Fact("ring", "by", "John")});
  ring.operations.push_back({QuadOperation::Kind::kAdd, Fact("ring", "label", Term::Literal("front door"))});
  ring.operations.push_back({QuadOperation::Kind::kAdd, {Iri("ring"), Iri("how"), Term::Blank("h"), Term()}});
  ring.operations.push_back(
      {QuadOperation::Kind::kAdd, {Term::Blank("h"), Iri("times"), Term::Literal("2"), Term()}});
  ring.operations.push_back({QuadOperation::Kind::kAdd, Fact("John", "knows", "Ann")});
  Turn(ring);
  EXPECT_EQ(Count("by"), 1u);
  Settle();
  EXPECT_EQ(Count("by"), 0u);
  EXPECT_EQ(Count("how"), 0u);
  EXPECT_EQ(Count("times"), 0u);
  EXPECT_EQ(Count("label"), 1u);
  EXPECT_EQ(Count("knows"), 1u);
}

TEST_F(EventTurnTest, WhoNamesABlankEventLosesThatFactWithIt) {
  WriteBatch ring = BlankEvent();
  ring.operations.push_back(
      {QuadOperation::Kind::kAdd, {Iri("John"), Iri("rang"), Term::Blank("b1"), Term()}});
  Turn(ring);
  EXPECT_EQ(Count("rang"), 1u);
  Settle();
  EXPECT_EQ(Count("rang"), 0u);
}

TEST_F(EventTurnTest, TheRunHasWhatTheEventSaidThoughItIsGone) {
  Turn(Put(
      Document::Kind::kCawl, "bell",
      OnCase(
          "<condition expression=\"rang and c\"><case name=\"rang\"><event operation=\"doorbell\"/></case>" +
          Context("?ring", "w:by", "?user") + "</condition>")));
  WriteBatch ring = Event("ring");
  ring.operations.push_back({QuadOperation::Kind::kAdd, Fact("ring", "by", "John")});
  EXPECT_THAT(Started(Turn(ring)), SizeIs(1));
  Settle();
  const auto value = dictionary_.FindIri(DocentIri("variableValue"));
  const auto john = dictionary_.FindIri("urn:w:John");
  EXPECT_EQ(stages_->writer.current().Count({{}, *value, *john, {}}), 1u);
}

// Each run of one batch was started for each of the others, too.
TEST_F(EventTurnTest, EventsOfOneBatchEachStartARunWithWhatIsToldOfThem) {
  Turn(Put(
      Document::Kind::kCawl, "bell",
      OnCase(
          "<condition expression=\"rang and c\"><case name=\"rang\"><event operation=\"doorbell\"/></case>" +
          Context("?ring", "w:by", "?user") + "</condition>")));
  Turn(Tell({Fact("Letter", "by", "Zoe")}));
  Settle();
  WriteBatch rings;
  for (const char* user : {"John", "Ann", "Eve"}) {
    const WriteBatch ring = Event(std::string("ring") + user);
    rings.operations.insert(rings.operations.end(), ring.operations.begin(), ring.operations.end());
    rings.operations.push_back({QuadOperation::Kind::kAdd, Fact(std::string("ring") + user, "by", user)});
  }
  // what is no event of this operation may stand in the context, too: three rings with Zoe's letter
  EXPECT_THAT(Started(Turn(rings)), SizeIs(6));
  const auto value = dictionary_.FindIri(DocentIri("variableValue"));
  for (const char* user : {"John", "Ann", "Eve"}) {
    EXPECT_EQ(
        stages_->writer.current().Count({{}, *value, *dictionary_.FindIri(std::string("urn:w:") + user), {}}),
        1u)
        << user;
  }
  Settle();
  EXPECT_THAT(Started(Turn(rings)), SizeIs(6)) << "told again";
}

TEST_F(EventTurnTest, AnEventThatAContextNamesAsTheObjectIsTheOneThatIsCounted) {
  Turn(Put(Document::Kind::kCawl, "bell",
           OnCase("<condition expression=\"both and c\"><case name=\"both\" expression=\"doorbell and "
                  "knock\"><event operation=\"doorbell\"/>"
                  "<event operation=\"knock\"/></case>" +
                  Context("?user", "w:made", "?what") + "</condition>")));
  WriteBatch batch;
  for (const auto& [node, operation] : {std::pair("r1", "doorbell"), {"r2", "doorbell"}, {"k1", "knock"}}) {
    const WriteBatch event = Event(node, operation);
    batch.operations.insert(batch.operations.end(), event.operations.begin(), event.operations.end());
    batch.operations.push_back({QuadOperation::Kind::kAdd, Fact("John", "made", node)});
  }
  EXPECT_THAT(Started(Turn(batch)), SizeIs(4)) << "each ring with itself and with the knock";
}

TEST_F(EventTurnTest, ALifetimeDoesNotKeepAnEvent) {
  Turn(Put(Document::Kind::kCawl, "bell", OnCase(kRang)));
  for (int i = 0; i < 2; ++i) {
    WriteBatch ring = Event("ring");
    ring.lifetime_ms = 60000;
    EXPECT_THAT(Started(Turn(ring)), SizeIs(1));
    Settle();
    EXPECT_EQ(Events(), 0u);
    EXPECT_EQ(stages_->NextDeadline(), std::nullopt) << "its lifetime left with it";
  }
}

TEST_F(EventTurnTest, AnEventOfASubclassIsOneToo) {
  Turn(Put(Document::Kind::kRules, "types",
           "PREFIX rdfs: <http://www.w3.org/2000/01/rdf-schema#>\n"
           "RULE { ?x a ?above } WHERE { ?x a ?class . ?class rdfs:subClassOf ?above }"));
  Turn(Put(Document::Kind::kCawl, "bell", OnCase(kRang)));
  Turn(Tell({Fact("Ring", std::string(kRdfsNs) + "subClassOf", "docent:Event")}));
  for (int i = 0; i < 2; ++i) {
    EXPECT_THAT(Started(Turn(Tell(
                    {Fact("r", "a", "Ring"), Fact("r", "docent:operation", Term::Literal("doorbell"))}))),
                SizeIs(1));
  }
  Settle();
  EXPECT_EQ(Events(), 0u);
  EXPECT_EQ(Count("docent:operation"), 0u);
}

TEST_F(EventTurnTest, AClassThatTheSameBatchPutsBelowEventIsOneToo) {
  const std::string below = std::string(kRdfsNs) + "subClassOf";
  Turn(Put(Document::Kind::kRules, "types",
           "PREFIX rdfs: <http://www.w3.org/2000/01/rdf-schema#>\n"
           "RULE { ?x a ?above } WHERE { ?x a ?class . ?class rdfs:subClassOf ?above }"));
  Turn(Put(Document::Kind::kCawl, "bell", OnCase(kRang)));
  const auto told = [](const std::string& node, const std::string& type) {
    return std::vector<TermQuad>{Fact(node, "a", type),
                                 Fact(node, "docent:operation", Term::Literal("doorbell"))};
  };
  std::vector<TermQuad> facts = told("r", "Ring");
  facts.push_back(Fact("Ring", below, "docent:Event"));
  EXPECT_THAT(Started(Turn(Tell(facts))), SizeIs(1));
  Settle();
  EXPECT_EQ(Events(), 0u);
  Turn(Tell({Fact("Short", below, "Knock")}));
  facts = told("k", "Short");
  facts.push_back(Fact("Bang", below, "docent:Event"));
  facts.push_back(Fact("Knock", below, "Bang"));
  EXPECT_THAT(Started(Turn(Tell(facts))), SizeIs(1)) << "by what the graph says and by what the batch says";
  Settle();
  EXPECT_EQ(Events(), 0u);
  EXPECT_THAT(Started(Turn(Tell(told("k", "Short")))), SizeIs(1)) << "later it is in the graph";
  Settle();
  EXPECT_EQ(Events(), 0u);
}

TEST_F(EventTurnTest, AnEventToldAgainIsCountedWhetherTheClockCameBetweenOrNot) {
  const TurnResult first = Turn(Event("ring"));
  EXPECT_EQ(first.delta.added.size() + first.told_again, 2u);
  const TurnResult at_once = Turn(Event("ring"));
  EXPECT_EQ(at_once.delta.added.size() + at_once.told_again, 2u);
  EXPECT_THAT(at_once.delta.removed, IsEmpty());
  Settle();
  const TurnResult later = Turn(Event("ring"));
  EXPECT_EQ(later.delta.added.size() + later.told_again, 2u);
  const TurnResult other = Turn(Tell({Fact("John", "knows", "Ann")}));
  EXPECT_EQ(other.delta.added.size() + other.told_again, 1u);
}

TEST_F(EventTurnTest, JointEventsAreAwaitedAfterAStartFromAnyFormat) {
  for (uint64_t format = 4; format <= 11; ++format) {
    stages_ = std::make_unique<Stages>(&dictionary_, &functions_, Limits());
    Turn(Put(
        Document::Kind::kCawl, "bell",
        OnCase("<condition><case expression=\"(doorbell and knock) or shout\"><event operation=\"doorbell\"/>"
               "<event operation=\"knock\"/><event operation=\"shout\"/></case></condition>")));
    RestartFrom(StateInFormat(format, State(), dictionary_));
    EXPECT_THAT(Started(Turn(BlankEvent("doorbell"))), IsEmpty()) << format;
    Settle();
    EXPECT_EQ(Events(), 1u) << format << ": the bell waits for the knock";
    RestartFrom(StateInFormat(std::max<uint64_t>(format, 6), State(), dictionary_));
    EXPECT_THAT(Started(Turn(BlankEvent("knock"))), SizeIs(1)) << format;
    Settle();
    EXPECT_EQ(Events(), 0u) << format;
    EXPECT_THAT(Started(Turn(BlankEvent("shout"))), SizeIs(1)) << format;
  }
}

TEST_F(EventTurnTest, WhatWaitsForARobotGoesOnAfterAStartFromAnyFormat) {
  for (uint64_t format = 4; format <= 11; ++format) {
    stages_ = std::make_unique<Stages>(&dictionary_, &functions_, Limits());
    Turn(test::WorldFacts());
    Turn(Put(Document::Kind::kCawl, "bell",
             Cawl("", "<node name=\"N\"><condition>" + Context("?robot", "docent:isAt", "w:Hall") +
                          "</condition><invoke operation=\"greet\"/></node>"
                          "<link from=\"s\" to=\"N\"/><link from=\"N\" to=\"e\"/>")));
    const TurnResult first = Turn(test::Start("Bell"));
    ASSERT_THAT(first.record.commands, SizeIs(1)) << format;
    EXPECT_THAT(Turn(test::Start("Bell")).record.commands, IsEmpty()) << format;
    RestartFrom(StateInFormat(format, State(), dictionary_));
    EXPECT_THAT(
        Turn(test::Report(first.record.commands[0].id, CommandReport::Outcome::kSucceeded)).record.commands,
        SizeIs(1))
        << format << ": the robot is free for the second run";
  }
}

TEST_F(EventTurnTest, EventsThatAreNeededTogetherWaitForEachOther) {
  Turn(Put(Document::Kind::kCawl, "bell",
           OnCase("<condition><case><event operation=\"doorbell\"/><event "
                  "operation=\"knock\"/></case></condition>")));
  EXPECT_THAT(Started(Turn(BlankEvent("doorbell"))), IsEmpty());
  Turn(BlankEvent("whistle"));
  Settle();
  EXPECT_EQ(Events(), 1u) << "the bell waits for the knock, and nothing waits for the whistle";
  Restart();
  Settle();
  EXPECT_EQ(Events(), 1u);
  EXPECT_THAT(Started(Turn(BlankEvent("knock"))), SizeIs(1));
  Settle();
  EXPECT_EQ(Events(), 0u);
  EXPECT_THAT(Started(Turn(BlankEvent("knock"))), IsEmpty()) << "the bell is used";
}

TEST_F(EventTurnTest, AnEventThatWaitsLeavesWithTheWorkflowThatNeedsIt) {
  Turn(Put(Document::Kind::kCawl, "bell",
           OnCase("<condition><case><event operation=\"doorbell\"/><event "
                  "operation=\"knock\"/></case></condition>")));
  Turn(BlankEvent("doorbell"));
  Settle();
  EXPECT_EQ(Events(), 1u);
  WriteBatch remove;
  remove.documents.push_back({Document::Kind::kCawl, Document::Action::kRemove, "Bell", ""});
  Turn(remove);
  Settle();
  EXPECT_EQ(Events(), 0u);
}

TEST_F(EventTurnTest, ThoseThatWaitAreBounded) {
  Turn(Put(Document::Kind::kCawl, "bell",
           OnCase("<condition><case><event operation=\"doorbell\"/><event "
                  "operation=\"knock\"/></case></condition>")));
  for (size_t i = 0; i < kWorkflowLimits.events_waiting; ++i) Turn(BlankEvent());
  Settle();
  EXPECT_EQ(Events(), kWorkflowLimits.events_waiting);
  Turn(BlankEvent());
  Settle();
  EXPECT_EQ(Events(), kWorkflowLimits.events_waiting) << "the oldest has left";
}

TEST_F(EventTurnTest, WhatElseAConditionNeedsHasToHoldWhenTheEventIsTold) {
  Turn(Put(
      Document::Kind::kCawl, "bell",
      OnCase(
          "<condition expression=\"rang and c\"><case name=\"rang\"><event operation=\"doorbell\"/></case>" +
          Context("w:Hall", "w:isOpen", "true") + "</condition>")));
  Turn(Event("ring"));
  Settle();
  EXPECT_THAT(Started(Turn(Tell({Fact("Hall", "isOpen", Term::Boolean(true))}))), IsEmpty());
  EXPECT_THAT(Started(Turn(Event("ring"))), SizeIs(1));
}

TEST_F(EventTurnTest, AnEventThatABusyRobotKeepsFromItsNodeStaysUntilItIsTaken) {
  Turn(test::WorldFacts());
  Turn(Put(Document::Kind::kCawl, "bell",
           Cawl("",
                "<node name=\"N\"><condition expression=\"rang and c\"><case name=\"rang\">"
                "<event operation=\"doorbell\"/></case>" +
                    Context("?robot", "docent:isAt", "w:Hall") +
                    "</condition><invoke operation=\"greet\"/></node>"
                    "<link from=\"s\" to=\"N\"/><link from=\"N\" to=\"e\"/>")));
  Turn(test::Start("Bell"));
  TurnResult first = Turn(Event("ring"));
  ASSERT_THAT(first.record.commands, SizeIs(1));
  Settle();
  EXPECT_EQ(Events(), 0u);
  Turn(test::Start("Bell"));
  EXPECT_THAT(Turn(Event("ring")).record.commands, IsEmpty());
  Settle();
  EXPECT_EQ(Events(), 1u) << "the second run waits with it for the robot";
  EXPECT_THAT(Turn(Event("ring")).record.commands, IsEmpty()) << "told again before it is taken";
  Restart();
  Settle();
  EXPECT_EQ(Events(), 1u);
  EXPECT_THAT(
      Turn(test::Report(first.record.commands[0].id, CommandReport::Outcome::kSucceeded)).record.commands,
      SizeIs(1));
  Settle();
  EXPECT_EQ(Events(), 0u);
}

TEST_F(EventTurnTest, AnEventThatIsGivenUpLeaves) {
  Turn(test::WorldFacts());
  Turn(Put(Document::Kind::kCawl, "bell",
           Cawl("",
                "<node name=\"N\"><condition expression=\"rang and c\"><case name=\"rang\">"
                "<event operation=\"doorbell\"/></case>" +
                    Context("?robot", "docent:isAt", "w:Hall") +
                    "</condition><invoke operation=\"greet\"/></node>"
                    "<link from=\"s\" to=\"N\"/><link from=\"N\" to=\"e\"/>")));
  Turn(test::Start("Bell"));
  Turn(Event("ring"));
  Turn(test::Start("Bell"));
  Turn(Event("ring"));
  Settle();
  ASSERT_EQ(Events(), 1u);
  WriteBatch cancel;
  cancel.run_requests.push_back({RunRequest::Kind::kCancel, "Answer-2", {}});
  Turn(cancel);
  Settle();
  EXPECT_EQ(Events(), 0u);
}

TEST_F(EventTurnTest, ARefusedTurnLeavesEventsAsTheyWere) {
  Turn(Put(Document::Kind::kCawl, "bell", OnCase(kRang)));
  Turn(Event("ring"));
  WriteBatch bad = Event("ring");
  bad.documents.push_back({Document::Kind::kRules, Document::Action::kRemove, "none", ""});
  bad.time_us = now_us_ += 1000;
  EXPECT_FALSE(RunTurn(stages_.get(), std::move(bad), head_ + 1).ok());
  EXPECT_EQ(Events(), 1u);
  Settle();
  EXPECT_EQ(Events(), 0u);
  EXPECT_THAT(Started(Turn(Event("ring"))), SizeIs(1));
}

TEST_F(EventTurnTest, WhatAnOntologySaysOfAnEventStays) {
  WriteBatch ontology = Put(Document::Kind::kOntology, "bells", "");
  for (TermQuad fact : {Fact("Ring", "a", "docent:Event"), Fact("Ring", "label", Term::Literal("a bell"))}) {
    fact.graph = Term::Iri(OntologyGraph("bells"));
    ontology.operations.push_back({QuadOperation::Kind::kAdd, fact});
  }
  Turn(ontology);
  Settle();
  EXPECT_EQ(Events(), 1u);
  EXPECT_EQ(Count("label"), 1u);
}

// --- the same document loaded again

class RedeployTest : public EventTurnTest {
 protected:
  static std::string Stays(const std::string& time, const std::string& more = "",
                           const std::string& node = "N") {
    return Cawl(
        "<activator name=\"A\">" + more + "<activate flow=\"Answer\"/><condition>" +
            Context("?who", "docent:isAt", "?where", time.empty() ? "" : " ext:for=\"" + time + "\"") +
            "</condition></activator>",
        "<node name=\"" + node + "\"/><link from=\"s\" to=\"" + node + "\"/><link from=\"" + node +
            "\" to=\"e\"/>");
  }
  std::vector<std::string> Deploy(const std::string& text, const std::string& file = "stays.cawl.xml") {
    return Started(Turn(Put(Document::Kind::kCawl, file, text)));
  }
  // Lets time pass; the runs that start.
  std::vector<std::string> After(TimeMicros time_us) {
    now_us_ += time_us;
    return Started(Tick());
  }
};

TEST_F(RedeployTest, ADocumentLoadedAgainFiresNothingAgain) {
  Deploy(Stays("2s"));
  Turn(Tell({Fact("John", "docent:isAt", "B1")}));
  EXPECT_THAT(After(3 * kSecond), SizeIs(1));
  EXPECT_THAT(Deploy(Stays("2s")), IsEmpty());
  EXPECT_THAT(After(5 * kSecond), IsEmpty());
  EXPECT_THAT(Deploy(Stays("2s"), "another_name.cawl.xml"), IsEmpty());
  EXPECT_THAT(Deploy("<!-- a comment -->\n" + Stays("2s", "\n\n   ")), IsEmpty());
  EXPECT_THAT(After(5 * kSecond), IsEmpty());
  Restart();
  EXPECT_THAT(Deploy(Stays("2s")), IsEmpty());
  EXPECT_THAT(After(5 * kSecond), IsEmpty());
  EXPECT_THAT(Deploy(Stays("2s", "", "AnotherNode")), IsEmpty()) << "the condition is the same";
  EXPECT_THAT(After(5 * kSecond), IsEmpty());
  Turn(Tell({}, {Fact("John", "docent:isAt", "B1")}));
  Turn(Tell({Fact("John", "docent:isAt", "B1")}));
  EXPECT_THAT(After(3 * kSecond), SizeIs(1)) << "who left and came back";
}

TEST_F(RedeployTest, TimesGoOnWhenTheDocumentIsLoadedAgain) {
  Deploy(Stays("10s"));
  Turn(Tell({Fact("John", "docent:isAt", "B1")}));
  After(6 * kSecond);
  Deploy(Stays("10s"));
  Restart();
  EXPECT_THAT(Deploy(Stays("10s")), IsEmpty());
  EXPECT_THAT(After(3 * kSecond), IsEmpty());
  EXPECT_THAT(After(2 * kSecond), SizeIs(1)) << "ten seconds after John came, not after the load";
  EXPECT_THAT(After(20 * kSecond), IsEmpty());
}

TEST_F(RedeployTest, TheNewFlowOfAnUnchangedConditionIsWhatStarts) {
  Deploy(Stays(""));
  EXPECT_THAT(Deploy(Stays("", "", "Other")), IsEmpty());
  const TurnResult result = Turn(Tell({Fact("John", "docent:isAt", "B1")}));
  EXPECT_TRUE(std::any_of(result.record.transitions.begin(), result.record.transitions.end(),
                          [](const Transition& t) { return t.subject == "Answer-1/Other"; }));
}

TEST_F(RedeployTest, AnotherConditionFiresForWhatIsNewToIt) {
  Deploy(Stays(""));
  EXPECT_THAT(Started(Turn(Tell({Fact("John", "docent:isAt", "B1")}))), SizeIs(1));
  std::string wider = Stays("");
  wider.insert(wider.find("</context>") + 10,
               "<context name=\"d\"><rule name=\"r\"><constraint name=\"k\"><subject>?who"
               "</subject><verb>w:near</verb><object>?where</object></constraint></rule>"
               "</context>");
  Turn(Tell({Fact("Ann", "near", "B1")}));
  EXPECT_THAT(Deploy(wider), SizeIs(1)) << "Ann's; John's has run";
}

TEST_F(RedeployTest, TwoDifferentTextsInOneBatchLeaveNoConditionBehind) {
  Deploy(Stays(""));
  WriteBatch both = Put(Document::Kind::kCawl, "a", Stays("2s"));
  both.documents.push_back({Document::Kind::kCawl, Document::Action::kPut, "b", Stays("4s")});
  Turn(both);
  EXPECT_THAT(stages_->conditions.Requests(), SizeIs(1));
}

TEST_F(RedeployTest, WhatIsUndeployedAndLoadedAgainBeginsAnew) {
  Deploy(Stays(""));
  EXPECT_THAT(Started(Turn(Tell({Fact("John", "docent:isAt", "B1")}))), SizeIs(1));
  WriteBatch remove;
  remove.documents.push_back({Document::Kind::kCawl, Document::Action::kRemove, "Bell", ""});
  Turn(remove);
  EXPECT_THAT(stages_->conditions.Requests(), IsEmpty());
  EXPECT_THAT(Deploy(Stays("")), SizeIs(1));
}

}  // namespace
}  // namespace docent::server
