// Events that runs tell are occurrences, as those of clients are.
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "gmock/gmock.h"
#include "graph/base/text.h"
#include "graph/rdf/docent_iris.h"
#include "graph/rdf/vocabulary.h"
#include "gtest/gtest.h"
#include "tests/kb_server/turn/turn_fixture.h"
#include "tests/kb_server/writer/old_formats.h"

namespace docent::server {
namespace {

using test::Fact;
using test::Put;
using test::Tell;
using ::testing::IsEmpty;
using ::testing::SizeIs;

std::string Cawl(const std::string& name, const std::string& activator, const std::string& flow) {
  return absl::StrCat("<CAWL name=\"", name,
                      "\" xmlns:docent=\"https://w3id.org/docent#\" xmlns:w=\"urn:w:\" "
                      "xmlns:ext=\"https://w3id.org/docent/cawl-ext#\">",
                      activator, "<flow name=\"", name, "\"><source name=\"s\"/>", flow,
                      "<sink name=\"e\"/></flow></CAWL>");
}
// Of flows whose runs are given who it is.
std::string WithWho(const std::string& cawl) {
  return absl::StrReplaceAll(cawl, {{"<source", "<variable name=\"who\"/><variable name=\"x\"/><source"}});
}
std::string OneNode(const std::string& node) {
  return absl::StrCat(node, "<link from=\"s\" to=\"N\"/><link from=\"N\" to=\"e\"/>");
}
// One that starts a run for each event "bell".
std::string Bell() {
  return Cawl("Bell",
              "<activator name=\"A\"><activate flow=\"Bell\"/><condition><case><event "
              "operation=\"bell\"/></case></condition></activator>",
              OneNode("<node name=\"N\"/>"));
}
std::string Rings(const std::string& more = "", const std::string& type = "docent:Event") {
  return absl::StrCat("<ext:tell>w:ring a ", type, "\nw:ring docent:operation \"bell\"\n", more,
                      "</ext:tell>");
}
WriteBatch Ring() {
  return Tell({Fact("ring", "a", "docent:Event"), Fact("ring", "docent:operation", Term::Literal("bell"))});
}

class ToldEventTest : public test::TurnTest {
 protected:
  void Deploy(const std::string& name, const std::string& text) {
    Turn(Put(Document::Kind::kCawl, name, text));
  }
  size_t Events() const {
    const auto type = dictionary_.FindIri(kRdfType), event = dictionary_.FindIri(DocentIri("Event"));
    return stages_->writer.current().Count({{}, *type, *event, {}});
  }
  // Runs of Bell that the turn started.
  static size_t Bells(const TurnResult& result) {
    size_t bells = 0;
    for (const std::string& run : Started(result)) bells += run.starts_with("Bell-") ? 1 : 0;
    return bells;
  }
};

TEST_F(ToldEventTest, EachTellingStartsARunAndNoneStays) {
  Deploy("bell", Bell());
  Deploy("t",
         Cawl("T", "", OneNode(absl::StrCat("<node name=\"N\">", Rings("w:ring w:by w:John"), "</node>"))));
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(Bells(Turn(test::Start("T"))), 1u) << i;
    EXPECT_EQ(Events(), 1u) << "it is there at the revision that told it";
    if (i == 1) Settle();
  }
  EXPECT_EQ(Bells(Turn(Ring())), 1u) << "a client's, after a run's";
  EXPECT_EQ(Bells(Turn(test::Start("T"))), 1u) << "a run's, after a client's";
  Settle();
  EXPECT_EQ(Events(), 0u);
  EXPECT_EQ(Count("docent:operation"), 0u);
  EXPECT_EQ(Count("by"), 0u) << "what came with it leaves with it";
  EXPECT_EQ(stages_->NextDeadline(), std::nullopt);
  Restart();
  EXPECT_EQ(Bells(Turn(test::Start("T"))), 1u);
}

TEST_F(ToldEventTest, ALifetimeDoesNotKeepIt) {
  for (const char* lifetime : {"lifetime=\"run\"", "lifetime=\"60s\""}) {
    stages_ = std::make_unique<Stages>(&dictionary_, &functions_, Limits());
    Deploy("bell", Bell());
    std::string tell = Rings();
    tell.insert(std::string("<ext:tell").size(), absl::StrCat(" ", lifetime));
    const char* waits =
        "<node name=\"M\"><condition><context><rule><constraint><subject>w:a</subject><verb>w:is</verb>"
        "<object>w:Open</object></constraint></rule></context></condition></node>";
    Deploy("t", Cawl("T", "",
                     absl::StrCat("<node name=\"N\">", tell, "</node>", waits,
                                  "<link from=\"s\" to=\"N\"/><link from=\"N\" to=\"M\"/>"
                                  "<link from=\"M\" to=\"e\"/>")));
    EXPECT_EQ(Bells(Turn(test::Start("T"))), 1u) << lifetime;
    Settle();
    EXPECT_EQ(Events(), 0u) << lifetime << ", and the run is there";
    EXPECT_EQ(Bells(Turn(test::Start("T"))), 1u) << lifetime;
  }
}

TEST_F(ToldEventTest, ItMayOpenANodeOfTheRunThatTellsIt) {
  Deploy("t", Cawl("T", "",
                   absl::StrCat("<node name=\"A\">", Rings(),
                                "</node><node name=\"B\"><condition><case><event "
                                "operation=\"bell\"/></case></condition></node>"
                                "<link from=\"s\" to=\"A\"/><link from=\"s\" to=\"B\"/><link from=\"A\" "
                                "to=\"e\"/><link from=\"B\" to=\"e\"/>")));
  Turn(test::Start("T"));
  Turn(test::Start("T"));
  Settle();
  EXPECT_EQ(stages_->engine.live_runs(), 0u);
  EXPECT_EQ(Events(), 0u);
}

TEST_F(ToldEventTest, TwoThatTellItInOneTurnTellItTwice) {
  Deploy("bell", Bell());
  const std::string node = absl::StrCat(Rings(), "</node>");
  Deploy("t",
         Cawl("T", "",
              absl::StrCat("<node name=\"A\">", node, "<node name=\"B\">", node, "<node name=\"C\">", node,
                           "<link from=\"s\" to=\"A\"/><link from=\"A\" to=\"B\"/><link from=\"B\" "
                           "to=\"C\"/><link from=\"C\" to=\"e\"/>")));
  EXPECT_EQ(Bells(Turn(test::Start("T"))), 3u);
  WriteBatch two = test::Start("T");
  two.run_requests.push_back(two.run_requests.front());
  EXPECT_EQ(Bells(Turn(two)), 6u);
  Settle();
  EXPECT_EQ(Events(), 0u);
}

// A node with ext:forEach tells it once for each binding, which a condition that asks nothing of the binding sees, too.
TEST_F(ToldEventTest, EachBindingOfForEachTellsIt) {
  Deploy("bell", Bell());
  Deploy("who", Cawl("Who",
                     "<activator name=\"A\"><activate flow=\"Who\"/><condition expression=\"rang and by\">"
                     "<case name=\"rang\"><event operation=\"bell\"/></case><context name=\"by\"><rule>"
                     "<constraint><subject>?bell</subject><verb>w:by</verb><object>?who</object></constraint>"
                     "</rule></context></condition></activator>",
                     OneNode("<node name=\"N\"/>")));
  Turn(Tell({Fact("a", "go", "Yes"), Fact("b", "go", "Yes"), Fact("c", "go", "Yes")}));
  const auto deploy = [this](const std::string& attributes, const std::string& at, const std::string& told) {
    Deploy("t", Cawl("T", "",
                     OneNode(absl::StrCat("<node name=\"N\" ext:forEach=\"?x\" ", attributes,
                                          "><condition><context><rule><constraint><subject>?x</subject>"
                                          "<verb>w:go</verb><object>w:Yes</object></constraint></rule>"
                                          "</context></condition><ext:tell at=\"",
                                          at, "\">", told, "</ext:tell></node>"))));
  };
  for (const char* at : {"open", "done"}) {
    for (const char* attributes : {"", "ext:sequential=\"true\""}) {
      for (const char* told : {"w:ring a docent:Event\nw:ring docent:operation \"bell\"\nw:ring w:by ?x",
                               "w:ring w:by ?x\nw:ring docent:operation \"bell\"\nw:ring a docent:Event",
                               "?x a docent:Event\n?x docent:operation \"bell\"\n?x w:by w:John"}) {
        deploy(attributes, at, told);
        const TurnResult result = Turn(test::Start("T"));
        EXPECT_EQ(Bells(result), 3u) << at << attributes << told;
        EXPECT_EQ(Started(result).size(), 7u) << "as many that bind who rang, and the run itself";
        Settle();
        EXPECT_EQ(Events(), 0u);
        EXPECT_EQ(Count("by"), 0u) << "what came with it leaves with it";
      }
    }
  }
  deploy("", "open", "w:hall w:is w:Checked\nw:hall w:checked ?x");
  EXPECT_EQ(Turn(test::Start("T")).record.told.size(), 4u) << "what is no event is told once";
}

// Who gives it another class tells it, too.
TEST_F(ToldEventTest, TwoThatTellItAsOfTwoClassesTellItTwice) {
  Deploy("bell", Bell());
  Turn(Put(Document::Kind::kRules, "types",
           "PREFIX rdfs: <http://www.w3.org/2000/01/rdf-schema#>\n"
           "RULE { ?x a ?above } WHERE { ?x a ?class . ?class rdfs:subClassOf ?above }"));
  Turn(Tell({Fact("Knock", Concat(kRdfsNs, "subClassOf"), "docent:Event")}));
  Deploy("t",
         Cawl("T", "", OneNode(absl::StrCat("<node name=\"N\">", Rings(), Rings("", "w:Knock"), "</node>"))));
  EXPECT_EQ(Bells(Turn(test::Start("T"))), 2u);
  Deploy("t",
         Cawl("T", "", OneNode(absl::StrCat("<node name=\"N\">", Rings("w:ring a w:Knock"), "</node>"))));
  EXPECT_EQ(Bells(Turn(test::Start("T"))), 1u) << "one telling may give several";
  Settle();
  EXPECT_EQ(Events(), 0u);
}

TEST_F(ToldEventTest, TheOrderOfItsFactsDoesNotMatter) {
  Deploy("bell", Bell());
  const std::string node =
      "<ext:tell>w:ring docent:operation \"bell\"\nw:ring w:by w:John\nw:ring a "
      "docent:Event</ext:tell></node>";
  Deploy("t", Cawl("T", "",
                   absl::StrCat("<node name=\"A\">", node, "<node name=\"B\">", node,
                                "<link from=\"s\" to=\"A\"/><link from=\"A\" to=\"B\"/><link from=\"B\" "
                                "to=\"e\"/>")));
  EXPECT_EQ(Bells(Turn(test::Start("T"))), 2u);
  Settle();
  EXPECT_EQ(Events(), 0u);
  EXPECT_EQ(Count("by"), 0u);
}

TEST_F(ToldEventTest, OfARunThatEndsAtOnceItCountsToo) {
  Deploy("bell", Bell());
  std::string tell = Rings("w:ring w:by $who");
  tell.insert(std::string("<ext:tell").size(), " lifetime=\"run\"");
  Deploy("t", WithWho(Cawl("T", "", OneNode(absl::StrCat("<node name=\"N\">", tell, "</node>")))));
  const auto run = [](const std::string& who) {
    WriteBatch batch = test::Start("T");
    batch.run_requests[0].arguments = {{"who", test::Iri(who)}};
    return batch;
  };
  EXPECT_EQ(Bells(Turn(run("John"))), 1u);
  EXPECT_EQ(Count("by"), 0u) << "the run has ended";
  WriteBatch two = run("John");
  two.run_requests.push_back(run("Mary").run_requests[0]);
  EXPECT_EQ(Bells(Turn(two)), 2u);
  Settle();
  EXPECT_EQ(Events(), 0u);
}

TEST_F(ToldEventTest, WhatTheRunWithdrawsAtOnceHasHappened) {
  Deploy("bell", Bell());
  Deploy("t", Cawl("T", "",
                   OneNode(absl::StrCat("<node name=\"N\">", Rings(),
                                        "<ext:withdraw>w:ring a ?what</ext:withdraw></node>"))));
  EXPECT_EQ(Bells(Turn(test::Start("T"))), 1u);
  Settle();
  EXPECT_EQ(Events(), 0u);
  EXPECT_EQ(Count("docent:operation"), 0u);
}

// Of two runs that tell the same event in one turn the second has to wait; what it does then is in its order all the same.
TEST_F(ToldEventTest, WhatIsToldLaterIsSeenByTheRunThatToldIt) {
  Deploy("bell", Bell());
  Deploy("t", WithWho(Cawl("T", "",
                           OneNode(absl::StrCat(
                               "<node name=\"N\">", Rings("w:ring w:by $who\n$who w:has w:Rung"),
                               "<ext:assign none=\"fail\">SELECT ?x WHERE { $who w:has ?x }</ext:assign>"
                               "<ext:withdraw>$who w:has ?any</ext:withdraw></node>")))));
  WriteBatch two = test::Start("T");
  two.run_requests.push_back(two.run_requests.front());
  two.run_requests[0].arguments = {{"who", test::Iri("John")}};
  two.run_requests[1].arguments = {{"who", test::Iri("Mary")}};
  EXPECT_EQ(Bells(Turn(two)), 2u);
  EXPECT_EQ(Count("has"), 0u);
  Settle();
  EXPECT_EQ(Events(), 0u);
}

// Where a turn goes on for long, what is told very often counts less often, and the turn is not refused.
TEST_F(ToldEventTest, ATurnMayTellItVeryOften) {
  Deploy("bell", Bell());
  Deploy("t", Cawl("T", "", OneNode(absl::StrCat("<node name=\"N\">", Rings(), "</node>"))));
  WriteBatch many;
  for (int i = 0; i < 200; ++i) many.run_requests.push_back(test::Start("T").run_requests.front());
  Turn(many);
  Settle();
  EXPECT_EQ(Events(), 0u);
}

TEST_F(ToldEventTest, AnEventOfASubclassIsOneToo) {
  Deploy("bell", Bell());
  Turn(Put(Document::Kind::kRules, "types",
           "PREFIX rdfs: <http://www.w3.org/2000/01/rdf-schema#>\n"
           "RULE { ?x a ?above } WHERE { ?x a ?class . ?class rdfs:subClassOf ?above }"));
  Turn(Tell({Fact("Knock", Concat(kRdfsNs, "subClassOf"), "docent:Event")}));
  Deploy("t", Cawl("T", "", OneNode(absl::StrCat("<node name=\"N\">", Rings("", "w:Knock"), "</node>"))));
  for (int i = 0; i < 2; ++i) EXPECT_EQ(Bells(Turn(test::Start("T"))), 1u);
  Settle();
  EXPECT_EQ(Events(), 0u);
}

// It was told when its class was none of events.
TEST_F(ToldEventTest, WhatBecameAnEventLaterIsToldAgainLikeAnyOther) {
  Deploy("bell", Bell());
  Turn(Put(Document::Kind::kRules, "types",
           "PREFIX rdfs: <http://www.w3.org/2000/01/rdf-schema#>\n"
           "RULE { ?x a ?above } WHERE { ?x a ?class . ?class rdfs:subClassOf ?above }"));
  const std::vector<TermQuad> knock = {Fact("ring", "a", "Knock"),
                                       Fact("ring", "docent:operation", Term::Literal("bell"))};
  Turn(Tell(knock));
  Turn(Tell({Fact("Knock", Concat(kRdfsNs, "subClassOf"), "docent:Event")}));
  Settle();
  EXPECT_EQ(Bells(Turn(Tell(knock))), 1u);
  EXPECT_EQ(Bells(Turn(Tell(knock))), 1u);
  Settle();
  EXPECT_EQ(Events(), 0u);
}

TEST_F(ToldEventTest, WhatEarlierVersionsKeptLeaves) {
  Turn(Ring());
  ServerState kept = State();
  kept.events.clear();  // as if a run of an earlier version had told it
  RestartFrom(test::StateInFormat(12, kept, dictionary_));
  EXPECT_EQ(Events(), 1u);
  Settle();
  EXPECT_EQ(Events(), 0u);
}

}  // namespace
}  // namespace docent::server
