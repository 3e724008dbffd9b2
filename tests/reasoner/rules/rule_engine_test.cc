#include "reasoner/rules/rule_engine.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <random>
#include <set>

#include "absl/strings/match.h"
#include "reasoner/rules/rule_sets.h"
#include "tests/reasoner/test_world.h"

namespace docent::rules {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class RuleEngineTest : public ::testing::Test {
 protected:
  void Put(const std::string& text, const std::string& name = "test.rules") {
    const std::string document = "PREFIX : <http://example.org/>\n" + text;
    const Diagnostics diagnostics = engine_.PutRules(name, document);
    ASSERT_THAT(diagnostics, IsEmpty()) << Render(diagnostics, document);
  }
  Delta Turn(const std::vector<std::string>& add, const std::vector<std::string>& remove = {}) {
    absl::StatusOr<Delta> delta = engine_.Update(world_.writer, world_.Apply(add, remove));
    EXPECT_TRUE(delta.ok()) << delta.status();
    if (!delta.ok()) return {};
    engine_.Commit();
    world_.writer.Freeze(Revision(++revision_));
    return *delta;
  }

  TestWorld world_;
  RuleEngine engine_{world_.dictionary};
  uint64_t revision_ = 0;
};

TEST_F(RuleEngineTest, InfersAndRetracts) {
  Put("RULE { ?x :at ?c } WHERE { ?x :at ?b . ?b :in ?c }");
  Turn({"r at b3", "b3 in hall", "hall in city"});
  EXPECT_THAT(world_.Inferred(), ElementsAre("r at city", "r at hall"));
  Turn({}, {"b3 in hall"});
  EXPECT_THAT(world_.Inferred(), IsEmpty());
}

TEST_F(RuleEngineTest, TheDeltaIsNetAndHoldsToldAndInferred) {
  Put("RULE { ?y :knows ?x } WHERE { ?x :knows ?y }");
  const Delta first = Turn({"a knows b"});
  EXPECT_EQ(first.added.size(), 2u);  // told a-b, inferred b-a
  EXPECT_TRUE(first.removed.empty());
  const Delta none = Turn({"a knows b @other"});
  EXPECT_EQ(none.added.size(), 1u) << "the same triple in a second graph infers nothing";
  EXPECT_EQ(Turn({}, {"a knows b"}).removed.size(), 1u) << "still told in the other graph";
  EXPECT_EQ(Turn({}, {"a knows b @other"}).removed.size(), 2u);
}

TEST_F(RuleEngineTest, WhatBranchesOfAUnionAssignComesAndGoesWithThem) {
  Put("RULE { ?x :y ?y } WHERE { { ?x :p ?y } UNION { ?x :q ?z BIND(:n AS ?y) } }");
  Turn({"x p m", "x p n", "x q k", "z q k"});
  EXPECT_THAT(world_.Inferred(), ElementsAre("x y m", "x y n", "z y n"));
  Turn({"w q k"}, {"x q k"});
  EXPECT_THAT(world_.Inferred(), ElementsAre("w y n", "x y m", "x y n", "z y n"))
      << "x y n by the other branch";
  Turn({}, {"x p n", "x p m"});
  EXPECT_THAT(world_.Inferred(), ElementsAre("w y n", "z y n"));
}

// CLIPS never removes these: the two facts support each other.
TEST_F(RuleEngineTest, InversePropertiesDoNotSupportEachOther) {
  Put("RULE { ?o :memberOf ?s } WHERE { ?s :member ?o }\nRULE { ?o :member ?s } WHERE { ?s :memberOf ?o }");
  Turn({"d member u", "d member v"});
  EXPECT_THAT(world_.Inferred(), ElementsAre("u memberOf d", "v memberOf d"));
  Turn({"u memberOf d"}, {"d member u"});
  EXPECT_THAT(world_.Inferred(), ElementsAre("d member u", "v memberOf d"));
  Turn({}, {"u memberOf d"});
  EXPECT_THAT(world_.Inferred(), ElementsAre("v memberOf d"));
}

// Jena's RETE loses these, although the fact has other support.
TEST_F(RuleEngineTest, SharedSupportStays) {
  Put("RULE { ?x a :Agent } WHERE { ?x a :Robot }\nRULE { ?x a :Agent } WHERE { ?x :speaks ?l }");
  Turn({"r a Robot", "r speaks english"});
  EXPECT_EQ(Turn({}, {"r a Robot"}).removed.size(), 1u);
  EXPECT_THAT(world_.Inferred(), ElementsAre("r a Agent"));
  Turn({}, {"r speaks english"});
  EXPECT_THAT(world_.Inferred(), IsEmpty());
}

TEST_F(RuleEngineTest, AToldFactIsNotInferredBesides) {
  Put("RULE { ?x a :Agent } WHERE { ?x a :Robot }\nRULE { ?x a :Thing } WHERE { ?x a :Agent }");
  Turn({"r a Robot", "r a Agent"});
  EXPECT_THAT(world_.Inferred(), ElementsAre("r a Thing"));
  const Delta untold = Turn({}, {"r a Agent"});
  EXPECT_THAT(world_.Inferred(), ElementsAre("r a Agent", "r a Thing")) << "it still follows";
  EXPECT_EQ(untold.removed.size(), 1u);
  EXPECT_EQ(untold.added.size(), 1u);
  Turn({"r a Agent @g"}, {"r a Robot"});
  EXPECT_THAT(world_.Inferred(), ElementsAre("r a Thing"));
  Turn({}, {"r a Agent @g"});
  EXPECT_THAT(world_.Inferred(), IsEmpty());
}

TEST_F(RuleEngineTest, FactsUntoldTogetherStillFollowFromEachOther) {
  Turn({"a p1 b", "a p2 b", "a p3 b"});  // p1 is asked about before p2, from which it follows
  Put("RULE { ?x :p1 ?y } WHERE { ?x :p2 ?y }\nRULE { ?x :p2 ?y } WHERE { ?x :p3 ?y }");
  Turn({});
  EXPECT_THAT(world_.Inferred(), IsEmpty());
  Turn({}, {"a p1 b", "a p2 b"});
  EXPECT_THAT(world_.Inferred(), ElementsAre("a p1 b", "a p2 b"));
}

TEST_F(RuleEngineTest, RulesMayHaveNamesAndTheOtherFormsOfTheDraft) {
  Put("RULE :first { ?x :q ?y } WHERE { ?x :p ?y NOT { ?x :not ?y } SET(?z := 1) }\n"
      "IF { ?x :q ?y } THEN { ?y :r ?x }");
  Turn({"a p b", "c p d", "c not d"});
  EXPECT_THAT(world_.Inferred(), ElementsAre("a q b", "b r a"));
}

TEST_F(RuleEngineTest, ACheckReportsItsSolutionsWithTheirTriples) {
  Put("RULE :overlap { } WHERE { ?x a :Robot . ?x a :Person }");
  Turn({"r a Robot", "r a Person"});
  const std::vector<std::string> reported = world_.Inferred();
  ASSERT_EQ(reported.size(), 10u) << "type, rule, and for two triples evidence and its three parts";
  EXPECT_TRUE(absl::StrContains(reported[0], "urn:docent:inconsistency:overlap:"));
  Turn({}, {"r a Person"});
  EXPECT_THAT(world_.Inferred(), IsEmpty());
  Turn({"r a Person"});
  EXPECT_EQ(world_.Inferred(), reported) << "the same inconsistency bears the same name";
}

// Lines of `inferred` that contain `word`, without the reports' names.
std::vector<std::string> Told(const std::vector<std::string>& inferred, const std::string& word) {
  std::vector<std::string> told;
  for (const std::string& line : inferred) {
    const size_t at = line.find(word);
    if (at != std::string::npos) told.push_back(line.substr(std::min(line.size(), at + word.size() + 1)));
  }
  std::sort(told.begin(), told.end());
  return told;
}

TEST_F(RuleEngineTest, ACheckWithAUnionSaysWhatIsWrong) {
  Put("RULE :alt { } WHERE { { ?x :bad :yes } UNION { ?y :worse :yes } }");
  const uint64_t nothing = world_.Inferred().size();
  Turn({"a bad yes"});
  EXPECT_THAT(Told(world_.Inferred(), "bindingName"), ElementsAre("'x"));
  EXPECT_THAT(Told(world_.Inferred(), "bindingValue"), ElementsAre("a"));
  Turn({"b worse yes"});
  EXPECT_THAT(Told(world_.Inferred(), "Inconsistency"), SizeIs(2)) << "one of each branch, none of both";
  EXPECT_THAT(Told(world_.Inferred(), "bindingValue"), ElementsAre("a", "b"));
  EXPECT_THAT(Told(world_.Inferred(), "bindingName"), ElementsAre("'x", "'y"));
  Turn({}, {"a bad yes"});
  EXPECT_THAT(Told(world_.Inferred(), "bindingValue"), ElementsAre("b"));
  Turn({}, {"b worse yes"});
  EXPECT_EQ(world_.Inferred().size(), nothing);
}

TEST_F(RuleEngineTest, ACheckThatCountsSaysWhatAndHowMany) {
  Put("RULE :many { } WHERE { ?x a :Parent { SELECT ?x (COUNT(?y) AS ?n) WHERE { ?x :kid ?y } GROUP BY ?x } "
      "FILTER(?n > 1) }");
  Turn({"p a Parent", "p kid k1", "p kid k2"});
  EXPECT_THAT(Told(world_.Inferred(), "bindingName"), ElementsAre("'n", "'x"));
  EXPECT_THAT(Told(world_.Inferred(), "bindingValue"), ElementsAre("2", "p"));
  EXPECT_THAT(Told(world_.Inferred(), "ns#subject"), ElementsAre("p")) << "every solution matches it";
  EXPECT_THAT(Told(world_.Inferred(), "ns#object"), ElementsAre("Parent"));
  Turn({"p kid k3"});
  EXPECT_THAT(Told(world_.Inferred(), "bindingValue"), ElementsAre("3", "p"));
  Turn({}, {"p kid k1", "p kid k2"});
  EXPECT_THAT(world_.Inferred(), IsEmpty());
}

TEST_F(RuleEngineTest, ChecksOfOneNameAreToldApart) {
  Put("RULE :odd { } WHERE { ?x a :Robot NOT { ?x :at ?p } }\n"
      "RULE :odd { } WHERE { ?x a :Robot NOT { ?x :owner ?p } }\n"
      "RULE :sum { } WHERE { { ?x :bad :yes } UNION { ?x :worse :yes } }\n"
      "RULE :sum { } WHERE { { ?x :bad :yes } UNION { ?x :worst :yes } }");
  Turn({"r a Robot", "s bad yes"});
  EXPECT_THAT(Told(world_.Inferred(), "Inconsistency"), SizeIs(4));
  Turn({"r at b1"}, {"s bad yes"});
  EXPECT_THAT(Told(world_.Inferred(), "Inconsistency"), SizeIs(1)) << "it has no owner yet";
  Turn({"r owner o"});
  EXPECT_THAT(world_.Inferred(), IsEmpty());
}

TEST_F(RuleEngineTest, ReportsAreThoseOfAFreshStartWhateverComesAndGoes) {
  const std::string rules =
      "RULE { ?x :p ?z } WHERE { ?x :q ?y . ?y :q ?z }\n"
      "RULE :union { } WHERE { { ?x :p ?y . ?x :r ?y } UNION { ?z :q ?z } }\n"
      "RULE :count { } WHERE { { SELECT ?x (COUNT(?y) AS ?n) WHERE { ?x :p ?y } GROUP BY ?x } FILTER(?n > 1) "
      "}\n"
      "RULE :not { } WHERE { ?x :r ?y NOT { ?y :p ?z } }\n"
      "RULE :not { } WHERE { ?x :r ?y NOT { ?y :q ?z } }\n"
      "RULE :minus { } WHERE { { ?x :p ?y } UNION { ?y :p ?x } MINUS { ?x :r ?y } }";
  Put(rules);
  std::mt19937 random(7);
  const auto name = [&](const char* names) { return std::string(1, names[random() % std::strlen(names)]); };
  std::set<std::string> facts;
  for (int turn = 0; turn < 300; ++turn) {
    std::set<std::string> add, remove;
    for (int i = 0; i < 3; ++i) {
      const std::string fact = name("abcd") + " " + name("pqr") + " " + name("abcd");
      (facts.contains(fact) ? remove : add).insert(fact);
    }
    facts.insert(add.begin(), add.end());
    for (const std::string& fact : remove) facts.erase(fact);
    Turn({add.begin(), add.end()}, {remove.begin(), remove.end()});
    TestWorld fresh;
    RuleEngine engine(fresh.dictionary);
    ASSERT_THAT(engine.PutRules("test.rules", "PREFIX : <http://example.org/>\n" + rules), IsEmpty());
    ASSERT_TRUE(engine.Update(fresh.writer, fresh.Apply({facts.begin(), facts.end()})).ok());
    ASSERT_EQ(world_.Inferred(), fresh.Inferred()) << "turn " << turn;
  }
}

TEST_F(RuleEngineTest, ReportsThatAnotherEngineMadeAreFoundAnew) {
  const std::string rules =
      "RULE :odd { } WHERE { ?x a :Robot . ?x a :Person }\nRULE { ?i :seen :it } WHERE { ?i a "
      "docent:Inconsistency }";
  Put(rules);
  Turn({"r a Robot", "r a Person"});
  const std::vector<std::string> reported = world_.Inferred();
  // as from a snapshot, where that engine called the same one otherwise, too
  const TermId old = world_.dictionary.InternIri("urn:docent:inconsistency:odd:0"),
               graph = world_.dictionary.InternIri(kInferredGraph);
  const auto word = [&](const char* name) { return world_.dictionary.InternIri(DocentIri(name)); };
  world_.writer.Add({old, world_.dictionary.InternIri(kRdfType), word("Inconsistency"), graph});
  world_.writer.Add({old, word("rule"), world_.dictionary.Intern(Term::Literal("odd")), graph});
  RuleEngine engine(world_.dictionary);
  ASSERT_THAT(engine.PutRules("test.rules", "PREFIX : <http://example.org/>\n" + rules), IsEmpty());
  const absl::StatusOr<Delta> delta = engine.Update(world_.writer, world_.Apply({}));
  ASSERT_TRUE(delta.ok()) << delta.status();
  EXPECT_THAT(delta->added, IsEmpty());
  EXPECT_THAT(delta->removed, SizeIs(2));
  EXPECT_EQ(world_.Inferred(), reported);
}

// They were taken for reports of checks after a start or a change of the rules, and stayed for ever.
TEST_F(RuleEngineTest, WhatAUsersRuleCallsAnInconsistencyComesAndGoesAsAllElse) {
  const std::string rules =
      "RULE :low { ?r a docent:Inconsistency ; docent:rule \"low\" ; docent:evidence ?b } WHERE { ?r "
      ":battery ?b FILTER(?b < 10) }\n"
      "RULE :odd { } WHERE { ?x a :Robot . ?x a :Person }";
  Put(rules);
  Turn({"r battery 5", "s battery 4", "x a Robot", "x a Person"});
  const std::vector<std::string> both = world_.Inferred();
  Put("RULE { ?x :seen true } WHERE { ?x :battery ?b }", "more.rules");
  Turn({}, {"r battery 5"});
  for (const std::string& fact : world_.Inferred()) EXPECT_FALSE(fact.starts_with("r ")) << fact;
  RuleEngine engine(world_.dictionary);
  ASSERT_THAT(engine.PutRules("test.rules", "PREFIX : <http://example.org/>\n" + rules), IsEmpty());
  ASSERT_THAT(
      engine.PutRules("more.rules",
                      "PREFIX : <http://example.org/> RULE { ?x :seen true } WHERE { ?x :battery ?b }"),
      IsEmpty());
  engine.Adopt();
  ASSERT_TRUE(engine.Update(world_.writer, world_.Apply({}, {"s battery 4", "x a Robot"})).ok());
  EXPECT_THAT(world_.Inferred(), IsEmpty());
  ASSERT_TRUE(engine.RemoveRules("more.rules"));
  ASSERT_TRUE(engine.Update(world_.writer, world_.Apply({"r battery 5", "s battery 4", "x a Robot"})).ok());
  EXPECT_EQ(world_.Inferred(), both);
}

TEST_F(RuleEngineTest, AReportsNameIsAnIriWhateverTheSetIsCalled) {
  Put("RULE { } WHERE { ?x a :Robot . ?x a :Person }", "my rules (1).rules");
  Turn({"r a Robot", "r a Person"});
  const std::vector<std::string> reported = world_.Inferred();
  ASSERT_EQ(reported.size(), 10u);
  EXPECT_THAT(reported[0], HasSubstr("urn:docent:inconsistency:my%20rules%20(1).rules:"));
}

TEST_F(RuleEngineTest, WhatFollowsFromAReportStaysWithIt) {
  Put("RULE :odd { } WHERE { ?x :at ?a . ?x :near ?a }\n"
      "RULE { :ops :sees ?rule } WHERE { ?i docent:rule ?rule }\n"
      "RULE { :ops :sees ?rule } WHERE { ?w :watches ?rule }");
  Turn({"r1 at b1", "r1 near b1", "w watches 'odd"});
  const auto sees = [&] {
    const std::vector<std::string> inferred = world_.Inferred();
    return std::count(inferred.begin(), inferred.end(), "ops sees 'odd");
  };
  EXPECT_EQ(sees(), 1);
  Turn({}, {"w watches 'odd"});
  EXPECT_EQ(sees(), 1) << "the report is still there";
  Turn({}, {"r1 near b1"});
  EXPECT_EQ(sees(), 0);
}

TEST_F(RuleEngineTest, RuleChangesAreMaintainedNotComputedAnew) {
  Put("RULE { ?x :q ?y } WHERE { ?x :p ?y }\nRULE { ?x :s ?y } WHERE { ?x :q ?y }");
  std::vector<std::string> facts;
  for (int i = 0; i < 200; ++i) facts.push_back("n" + std::to_string(i) + " p m");
  Turn(facts);
  const uint64_t firings = engine_.counters().firings;
  Put("RULE { ?x :q ?y } WHERE { ?x :p ?y }\nRULE { ?x :s ?y } WHERE { ?x :q ?y }\nDATA { :a :b :c }");
  EXPECT_EQ(Turn({}).added.size(), 1u);
  EXPECT_LE(engine_.counters().firings, firings + 1);
}

TEST_F(RuleEngineTest, ATransitiveClosureFollowsCutsAndCycles) {
  Put("RULE { ?a :r ?c } WHERE { ?a :e ?c }\nRULE { ?a :r ?c } WHERE { ?a :r ?b . ?b :e ?c }");
  Turn({"x1 e x2", "x2 e x3", "x3 e x1"});
  EXPECT_EQ(world_.Inferred().size(), 9u);
  Turn({}, {"x3 e x1"});
  EXPECT_THAT(world_.Inferred(), ElementsAre("x1 r x2", "x1 r x3", "x2 r x3"));
  Turn({"x1 e x3"}, {"x2 e x3"});
  EXPECT_THAT(world_.Inferred(), ElementsAre("x1 r x2", "x1 r x3"));
}

TEST_F(RuleEngineTest, NegationFollowsBothDirections) {
  Put("RULE { ?r a :Free } WHERE { ?r a :Robot FILTER NOT EXISTS { ?r a :Busy } }\n"
      "RULE { ?r a :Busy } WHERE { ?r :task ?t }\n"
      "RULE { :hall :has ?r } WHERE { ?r a :Free }");
  Turn({"r1 a Robot", "r2 a Robot", "r1 task t1"});
  EXPECT_THAT(world_.Inferred(), ElementsAre("hall has r2", "r1 a Busy", "r2 a Free"));
  Turn({"r2 task t2"}, {"r1 task t1"});
  EXPECT_THAT(world_.Inferred(), ElementsAre("hall has r1", "r1 a Free", "r2 a Busy"));
  Turn({"r2 a Busy"}, {"r2 task t2"});
  EXPECT_THAT(world_.Inferred(), ElementsAre("hall has r1", "r1 a Free")) << "told Busy negates as well";
}

TEST_F(RuleEngineTest, FiltersAndBindCompute) {
  Put("RULE { ?r :low true } WHERE { ?r :battery ?b FILTER(?b < 0.2) }\n"
      "RULE { ?r :percent ?p } WHERE { ?r :battery ?b BIND(?b * 100 AS ?p) }");
  Turn({"r battery 0.5"});
  EXPECT_THAT(world_.Inferred(), ElementsAre("r percent 50"));
  Turn({"r battery 0.1"}, {"r battery 0.5"});
  EXPECT_EQ(world_.Inferred().size(), 2u);
  EXPECT_THAT(world_.Inferred(), ElementsAre("r low true", "r percent 10"));
}

TEST_F(RuleEngineTest, RulesChangeAtRunTime) {
  Turn({"a p b"});
  Put("RULE { ?x :q ?y } WHERE { ?x :p ?y }");
  EXPECT_EQ(Turn({}).added.size(), 1u);
  EXPECT_THAT(world_.Inferred(), ElementsAre("a q b"));
  Put("RULE { ?x :s ?y } WHERE { ?x :q ?y }", "second.rules");
  Put("RULE { ?y :q ?x } WHERE { ?x :p ?y }");
  Turn({"c p d"});
  EXPECT_THAT(world_.Inferred(), ElementsAre("b q a", "b s a", "d q c", "d s c"));
  EXPECT_TRUE(engine_.RemoveRules("test.rules"));
  EXPECT_FALSE(engine_.RemoveRules("test.rules"));
  EXPECT_EQ(Turn({}).removed.size(), 4u);
  EXPECT_THAT(world_.Inferred(), IsEmpty());
}

TEST_F(RuleEngineTest, DataIsInferred) {
  Put("DATA { :near :inverse :near }");
  Turn({});
  EXPECT_THAT(world_.Inferred(), ElementsAre("near inverse near"));
}

TEST_F(RuleEngineTest, HeadsThatAreNoTriplesAreLeftOut) {
  Put("RULE { ?y :of ?x } WHERE { ?x :p ?y }");
  Turn({"a p 5", "a p b"});
  EXPECT_THAT(world_.Inferred(), ElementsAre("b of a"));
}

TEST_F(RuleEngineTest, AVariablePredicateIsARuleLikeOthers) {
  Put("RULE { ?s ?q ?o } WHERE { ?s ?p ?o . ?p :subPropertyOf ?q }");
  Turn({"p subPropertyOf q", "q subPropertyOf r", "a p b"});
  EXPECT_THAT(world_.Inferred(), ElementsAre("a q b", "a r b"));
  Turn({}, {"q subPropertyOf r"});
  EXPECT_THAT(world_.Inferred(), ElementsAre("a q b"));
}

TEST_F(RuleEngineTest, NegationThroughRecursionIsRefusedWithItsCycle) {
  const std::string text =
      "PREFIX : <http://example.org/>\n"
      "RULE { ?x a :A } WHERE { ?x a :T FILTER NOT EXISTS { ?x a :B } }\n"
      "RULE { ?x a :B } WHERE { ?x a :C }\n"
      "RULE { ?x a :C } WHERE { ?x a :A }\n";
  const Diagnostics diagnostics = engine_.PutRules("bad.rules", text);
  ASSERT_EQ(diagnostics.size(), 1u);
  EXPECT_EQ(diagnostics[0].message,
            "negation through recursion: bad.rules rule 1 (line 2) negates the results of bad.rules rule "
            "2 (line 3), "
            "which needs bad.rules rule 3 (line 4), which needs bad.rules rule 1 (line 2)");
  EXPECT_EQ(diagnostics[0].span.line, 2);
  EXPECT_EQ(engine_.rule_count(), 0u) << "nothing changed";
}

TEST_F(RuleEngineTest, CountingWhatTheCountMakesIsRefusedAsSuch) {
  const Diagnostics diagnostics =
      engine_.PutRules("bad.rules",
                       "PREFIX : <http://example.org/>\nRULE { ?x :n ?c } WHERE { { SELECT ?x (COUNT(?y) AS "
                       "?c) { ?x :n ?y } GROUP BY ?x } }");
  ASSERT_EQ(diagnostics.size(), 1u);
  EXPECT_THAT(diagnostics[0].message, ::testing::HasSubstr("aggregates the results of itself"));
  EXPECT_THAT(diagnostics[0].hint, ::testing::HasSubstr("take the aggregate out of the cycle"));
}

TEST_F(RuleEngineTest, ARuleThatNeverEndsIsRefusedWithItsCycle) {
  const std::string text =
      "PREFIX : <http://example.org/>\n"
      "RULE { ?x :n ?m } WHERE { ?x :k ?n BIND(?n + 1 AS ?m) }\n"
      "RULE { ?x :k ?n } WHERE { ?x :n ?n }\n"
      "RULE { ?x :twice ?m } WHERE { ?x :n ?n BIND(?n * 2 AS ?m) }\n";
  const Diagnostics diagnostics = engine_.PutRules("bad.rules", text);
  ASSERT_EQ(diagnostics.size(), 1u) << Render(diagnostics, text);
  EXPECT_EQ(diagnostics[0].message,
            "may never end: ?m is computed from the results of the rule itself: bad.rules rule 1 (line "
            "2) needs "
            "bad.rules rule 2 (line 3) needs bad.rules rule 1 (line 2)");
  EXPECT_EQ(diagnostics[0].span.line, 2);
  EXPECT_EQ(engine_.rule_count(), 0u) << "nothing changed";
}

TEST_F(RuleEngineTest, TheSamePredicateMayBeNegatedForAnotherClass) {
  Put("RULE { ?r a :Free } WHERE { ?r a :Robot FILTER NOT EXISTS { ?r a :Busy } }");
  EXPECT_EQ(engine_.rule_count(), 1u);
  ASSERT_EQ(engine_.names().size(), 1u);
  EXPECT_EQ(engine_.rule_count(engine_.names()[0]), 1u);
  EXPECT_EQ(engine_.rule_count("nothing"), 0u);
}

TEST_F(RuleEngineTest, AnUnknownFunctionIsReportedAtItsRule) {
  const Diagnostics diagnostics = engine_.PutRules(
      "f.rules", "PREFIX : <http://example.org/>\nRULE { ?x a :A } WHERE { ?x :p ?y FILTER(:nope(?y)) }");
  ASSERT_EQ(diagnostics.size(), 1u);
  EXPECT_EQ(diagnostics[0].span.line, 2);
}

TEST_F(RuleEngineTest, WritingTheInferredGraphIsRefused) {
  Quad quad = world_.QuadOf("a p b");
  quad.graph = world_.dictionary.InternIri(kInferredGraph);
  const absl::Status status = engine_.Update(world_.writer, world_.writer.Apply({quad}, {})).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
}

TEST_F(RuleEngineTest, ACycleByAxiomsNamesTheAxioms) {
  ASSERT_THAT(engine_.PutRules("owl2rl", BuiltInRuleSet("owl2rl")), IsEmpty());
  Put("RULE :avail { ?r a :Available } WHERE { ?r a :Rob NOT { ?r a :Broken } }");
  Turn({"r a Rob"});
  const absl::StatusOr<Delta> delta = engine_.Update(
      world_.writer, world_.Apply({"Available rdfs:subClassOf Odd", "Odd rdfs:subClassOf Broken"}));
  EXPECT_EQ(delta.status().code(), absl::StatusCode::kFailedPrecondition);
  const std::string message(delta.status().message());
  EXPECT_THAT(message, HasSubstr("avail (line 2) negates consequences of itself by owl2rl cax-sco"));
  EXPECT_THAT(message,
              ::testing::ContainsRegex(
                  "\\(<http://example.org/Available> rdfs:subClassOf <http://example.org/(Odd|Broken)>\\)"));
  EXPECT_THAT(message, HasSubstr("<http://example.org/Broken>)"));
  EXPECT_THAT(message, HasSubstr("Take one of these axioms away"));
}

class RuleLimitsTest : public ::testing::Test {
 protected:
  absl::Status Run(const Limits& limits, const std::string& rules, const std::vector<std::string>& add,
                   const std::vector<std::string>& base = {}) {
    TestWorld world;
    RuleEngine engine(world.dictionary, limits);
    EXPECT_THAT(engine.PutRules("loop.rules", "PREFIX : <http://example.org/>\n" + rules), IsEmpty());
    if (!engine.Update(world.writer, world.Apply(base)).ok()) return absl::InternalError("the base facts");
    engine.Commit();
    world.writer.Freeze(Revision(1));
    const absl::Status status = engine.Update(world.writer, world.Apply(add)).status();
    if (!status.ok()) {
      engine.Rollback();
      world.writer.Rollback();
      EXPECT_THAT(world.Inferred(), IsEmpty());
      EXPECT_TRUE(engine.Update(world.writer, world.Apply({"other fact x"})).ok()) << "the engine goes on";
    }
    return status;
  }
  TestWorld world_;
};

TEST_F(RuleLimitsTest, ARuleThatFeedsItselfIsStoppedAndNamed) {
  Limits limits;
  limits.rule_rounds = 50;
  const absl::Status status =
      Run(limits, "RULE { ?x :n ?m } WHERE { ?x :n ?n BIND(?n + 1 AS ?m) FILTER(?n < 100000) }", {"a n 1"});
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(std::string(status.message()),
              HasSubstr("loop.rules rule 1 (line 2) goes beyond the limit rule_rounds = 50"));
}

TEST_F(RuleLimitsTest, InferredFactsAreLimitedAtTheLimitAndOnePast) {
  Limits limits;
  limits.inferred_per_turn = 4;
  const std::string rule = "RULE { ?y :of ?x } WHERE { ?x :p ?y }";
  EXPECT_TRUE(Run(limits, rule, {"a p b1", "a p b2", "a p b3", "a p b4"}).ok());
  const absl::Status status = Run(limits, rule, {"a p b1", "a p b2", "a p b3", "a p b4", "a p b5"});
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(std::string(status.message()), HasSubstr("inferred_per_turn = 4"));
}

// It had no result, so the time limit was never checked.
TEST_F(RuleEngineTest, AJoinWithoutResultsIsStoppedAndNamed) {
  std::vector<std::string> facts;
  for (int i = 0; i < 200; ++i) facts.push_back(absl::StrCat("k", i, " p ", i));
  Turn(facts);
  for (
      const char* body : {
          "?a :p ?b . ?c :p ?d . ?e :p ?f FILTER(?b + ?d + ?f = -1)",              // leaves
          "?a :p ?b . ?c :p ?d . ?e :p ?f FILTER(?f < ?b && ?f < ?d && ?b < ?f)",  // on ids
          "?a :p ?b . ?c :p ?d . ?e :p ?f . ?a :q ?f",  // a pattern without a match
          "{ ?a :p ?b } UNION { ?b :p ?a } ?c :p ?d . ?e :p ?f FILTER(?b + ?d + ?f = -1)",  // the SPARQL evaluator
          "?a :p ?b . ?c :p ?d . ?e :p ?f BIND(?b + ?d + ?f AS ?g) FILTER(?g = -1)",
      }) {
    const std::string document =
        absl::StrCat("PREFIX : <http://example.org/>\nRULE :cross { ?a :r ?d } WHERE { ", body, " }");
    ASSERT_THAT(engine_.PutRules("cross.rules", document), IsEmpty()) << body;
    Cancellation cancellation;
    cancellation.AllowSteps(100000);
    const absl::StatusOr<Delta> delta = engine_.Update(world_.writer, {}, &cancellation);
    if (std::string_view(body).find(":q") != std::string_view::npos) {
      EXPECT_TRUE(delta.ok()) << "the pattern without a match is asked first";
    } else {
      EXPECT_EQ(delta.status().code(), absl::StatusCode::kResourceExhausted) << body;
      EXPECT_THAT(std::string(delta.status().message()),
                  HasSubstr("cross.rules cross (line 2): evaluation stopped after 100000"));
      EXPECT_THAT(std::string(delta.status().message()), HasSubstr("steps_per_turn"));
    }
    engine_.Rollback();
    world_.writer.Rollback();
  }
  Turn({"x p y"});
  EXPECT_THAT(world_.Inferred(), IsEmpty()) << "the rule set was not taken";
}

// Inferred facts cost steps like any other work: the inferences of a turn do not raise its limit.
TEST_F(RuleEngineTest, WhatIsInferredCostsSteps) {
  Put("RULE { ?y a :Hot } WHERE { ?x a :Hot . ?x :next ?y }");
  std::vector<std::string> facts;
  for (int i = 0; i < 5000; ++i) facts.push_back(absl::StrCat("a", i, " next a", i + 1));
  Turn(facts);
  for (const bool enough : {false, true}) {
    Cancellation cancellation;
    cancellation.AllowSteps(enough ? 2000000 : 200000);
    const absl::StatusOr<Delta> delta =
        engine_.Update(world_.writer, world_.Apply({"a0 a Hot"}), &cancellation);
    EXPECT_EQ(delta.ok(), enough) << delta.status();
    EXPECT_THAT(std::string(delta.status().message()), HasSubstr(enough ? "" : "steps_per_turn"));
    engine_.Rollback();
    world_.writer.Rollback();
  }
}

TEST_F(RuleLimitsTest, RoundsAreAllowedUpToTheLimit) {
  Limits limits;
  limits.rule_rounds = 3;
  const std::string rule = "RULE { ?y a :Hot } WHERE { ?x a :Hot . ?x :next ?y }";
  EXPECT_TRUE(Run(limits, rule, {"a1 a Hot"}, {"a1 next a2", "a2 next a3"}).ok());
  EXPECT_EQ(Run(limits, rule, {"a1 a Hot"}, {"a1 next a2", "a2 next a3", "a3 next a4"}).code(),
            absl::StatusCode::kResourceExhausted);
}

TEST_F(RuleEngineTest, RollbackRestoresRuleSets) {
  Put("RULE { ?x :q ?y } WHERE { ?x :p ?y }");
  Turn({"a p b"});
  Put("RULE { ?x :q2 ?y } WHERE { ?x :p ?y }");
  Put("RULE { ?x :s ?y } WHERE { ?x :p ?y }", "second.rules");
  ASSERT_TRUE(engine_.Update(world_.writer, world_.Apply({"c p d"})).ok());
  EXPECT_THAT(world_.Inferred(), ElementsAre("a q2 b", "a s b", "c q2 d", "c s d"));
  engine_.Rollback();
  world_.writer.Rollback();
  EXPECT_THAT(engine_.names(), ElementsAre("test.rules"));
  Turn({"e p f"});
  EXPECT_THAT(world_.Inferred(), ElementsAre("a q b", "e q f"));
}

// Two entangled groups of rules, connected by axioms alone; a third set joins them, and is removed.
TEST_F(RuleEngineTest, FewerRulesAreNeverRefused) {
  const std::string knots =
      "PREFIX : <http://example.org/>\n"
      "RULE { ?x :status ?d } WHERE { ?c rdfs:subClassOf ?d . ?x :status ?c }\n"
      "RULE { ?x :status :Free } WHERE { ?x :status :On NOT { ?x :status :Busy } }\n"
      "RULE { ?x :kind ?d } WHERE { ?c rdfs:subClassOf ?d . ?x :kind ?c }\n"
      "RULE { ?x :kind :Small } WHERE { ?x :kind :On NOT { ?x :kind :Large } }\n";
  RuleEngine engine(world_.dictionary);
  ASSERT_FALSE(
      HasErrors(engine.PutRules("sub", "RULE { ?x ?q ?y } WHERE { ?p rdfs:subPropertyOf ?q . ?x ?p ?y }")));
  ASSERT_FALSE(HasErrors(engine.PutRules("knots", knots)));
  ASSERT_TRUE(engine.Update(world_.writer, world_.Apply({"a status On", "a kind On"})).ok());
  const std::vector<std::string> inferred = {"a kind Small", "a status Free"};
  EXPECT_EQ(world_.Inferred(), inferred);
  EXPECT_TRUE(engine.RemoveRules("sub"));
  EXPECT_EQ(engine.rule_count(), 4u);
  ASSERT_TRUE(engine.Update(world_.writer, {}).ok());
  EXPECT_EQ(world_.Inferred(), inferred);
}

// A rule about reports also sees them beside rules with negation.
TEST_F(RuleEngineTest, ReportsAreSeenBesideNegation) {
  RuleEngine engine(world_.dictionary);
  ASSERT_FALSE(HasErrors(engine.PutRules("r",
                                         "PREFIX : <http://example.org/>\n"
                                         "RULE { ?x ?q ?y } WHERE { ?p rdfs:subPropertyOf ?q . ?x ?p ?y }\n"
                                         "RULE :odd { } WHERE { ?x a :Robot . ?x a :Person }\n"
                                         "RULE { ?i :seen :it } WHERE { ?i a docent:Inconsistency }\n"
                                         "RULE { ?x :h ?y } WHERE { ?x :k ?y NOT { ?x :m ?y } }\n")));
  const auto seen = [&] {
    const std::vector<std::string> all = world_.Inferred();
    return std::count_if(all.begin(), all.end(),
                         [](const std::string& t) { return t.find(" seen it") != t.npos; });
  };
  ASSERT_TRUE(engine.Update(world_.writer, world_.Apply({"r a Robot", "r a Person"})).ok());
  EXPECT_EQ(seen(), 1);
  ASSERT_TRUE(engine.Update(world_.writer, world_.Apply({}, {"r a Person"})).ok());
  EXPECT_EQ(seen(), 0);
}

}  // namespace
}  // namespace docent::rules
