// Checks, which report inconsistencies as facts.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <random>
#include <set>

#include "absl/strings/match.h"
#include "tests/reasoner/rules/rule_engine_fixture.h"

namespace docent::rules {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

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

TEST_F(RuleEngineTest, WhatAnotherEngineInferredIsInferredAnew) {
  const std::string rules =
      "RULE :odd { } WHERE { ?x a :Robot . ?x a :Person }\nRULE { ?x a :Agent } WHERE { ?x a :Robot }";
  Put(rules);
  Turn({"r a Robot", "r a Person"});
  const std::vector<std::string> reported = world_.Inferred();
  // as from a snapshot, where that engine called the same one otherwise, too, and let facts follow from it
  const TermId old = world_.dictionary.InternIri("urn:docent:inconsistency:odd:0"),
               graph = world_.dictionary.InternIri(kInferredGraph);
  const auto word = [&](const char* name) { return world_.dictionary.InternIri(DocentIri(name)); };
  world_.writer.Add({old, world_.dictionary.InternIri(kRdfType), word("Inconsistency"), graph});
  world_.writer.Add({old, word("rule"), world_.dictionary.Intern(Term::Literal("odd")), graph});
  world_.writer.Add({old, world_.Id("seen"), world_.Id("it"), graph});
  RuleEngine engine(world_.dictionary);
  ASSERT_THAT(engine.PutRules("test.rules", "PREFIX : <http://example.org/>\n" + rules), IsEmpty());
  const absl::StatusOr<Delta> delta = engine.Update(world_.writer, world_.Apply({}));
  ASSERT_TRUE(delta.ok()) << delta.status();
  EXPECT_THAT(delta->added, IsEmpty());
  EXPECT_THAT(delta->removed, SizeIs(3));
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

}  // namespace
}  // namespace docent::rules
