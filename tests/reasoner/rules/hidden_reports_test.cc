// Rules do not see the reports of checks, whatever their patterns match.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "reasoner/rules/rule_engine.h"
#include "reasoner/rules/rule_sets.h"
#include "tests/reasoner/test_world.h"

namespace docent::rules {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

// A world with rules, turn by turn.
class Site {
 public:
  // `set`: a built-in one beside the rules.
  explicit Site(const std::string& rules, const std::string& set = "") {
    if (!set.empty()) sets_.emplace_back(set, BuiltInRuleSet(set));
    sets_.emplace_back("own", "PREFIX : <http://example.org/>\n" + rules);
    for (const auto& [name, text] : sets_) EXPECT_THAT(engine_.PutRules(name, text), IsEmpty());
    Turn({});
  }

  void Turn(const std::vector<std::string>& add, const std::vector<std::string>& remove = {}) {
    Take(world_.Apply(add, remove));
  }
  void Put(const std::string& rules) {
    sets_.back().second = "PREFIX : <http://example.org/>\n" + rules;
    EXPECT_THAT(engine_.PutRules("own", sets_.back().second), IsEmpty());
    Turn({});
  }
  void Take(const Delta& told) {
    const absl::StatusOr<Delta> delta = engine_.Update(world_.writer, told);
    EXPECT_TRUE(delta.ok()) << delta.status();
    engine_.Commit();
    world_.writer.Commit();
  }
  std::vector<std::string> Inferred() const { return world_.Inferred(); }
  // Those about no report.
  std::vector<std::string> Followed() const {
    std::vector<std::string> facts = Inferred();
    std::erase_if(facts,
                  [](const std::string& fact) { return fact.starts_with("urn:docent:inconsistency:"); });
    return facts;
  }
  size_t reports() const {
    const std::vector<std::string> facts = Inferred();
    return static_cast<size_t>(std::count_if(facts.begin(), facts.end(), [](const std::string& fact) {
      return absl::EndsWith(fact, " a https://w3id.org/docent#Inconsistency");
    }));
  }
  TestWorld& world() { return world_; }

  // Tells the facts and withdraws them, one by one in both orders and all at once.
  void ExpectAsFresh(const std::vector<std::string>& facts) {
    const std::vector<std::string> backwards(facts.rbegin(), facts.rend());
    Turn(facts);
    ExpectAsFreshWith(facts);
    Turn({}, facts);
    ExpectAsFreshWith({});
    for (const std::vector<std::string>* order : {&facts, &backwards}) {
      for (auto fact = order->begin(); fact != order->end(); ++fact) {
        Turn({*fact});
        ExpectAsFreshWith({order->begin(), fact + 1});
      }
      for (auto fact = order->begin(); fact != order->end(); ++fact) {
        Turn({}, {*fact});
        ExpectAsFreshWith({fact + 1, order->end()});
      }
    }
  }

 private:
  void ExpectAsFreshWith(const std::vector<std::string>& told) {
    TestWorld fresh;
    RuleEngine engine(fresh.dictionary);
    for (const auto& [name, text] : sets_) EXPECT_THAT(engine.PutRules(name, text), IsEmpty());
    EXPECT_TRUE(engine.Update(fresh.writer, fresh.Apply(told)).ok());
    EXPECT_EQ(world_.Inferred(), fresh.Inferred()) << "with " << absl::StrJoin(told, " . ");
  }

  std::vector<std::pair<std::string, std::string>> sets_;
  TestWorld world_;
  RuleEngine engine_{world_.dictionary};
};

constexpr char kBusy[] =
    "RULE :n { ?x :busy ?y } WHERE { ?x :p2 ?y NOT { ?x :p1 ?y } }\n"
    "RULE :chk { } WHERE { ?x :busy ?y , ?z FILTER(STR(?y) < STR(?z)) }\n";

TEST(HiddenReports, NothingOfASetRestsOnThem) {
  for (const char* set : {"rdfs", "owl2rl"}) {
    SCOPED_TRACE(set);
    Site site(kBusy, set);
    site.ExpectAsFresh({"i1 p3 i4", "i1 p2 i3", "p3 rdfs:subPropertyOf p2",
                        "docent:Inconsistency rdfs:subClassOf Problem", "docent:rule rdfs:domain Ruled"});
    site.Turn({"i1 p2 i4", "i1 p2 i3", "docent:Inconsistency rdfs:subClassOf Problem"});
    EXPECT_EQ(site.reports(), 1u);
    for (const std::string& fact : site.Followed())
      EXPECT_THAT(fact, Not(HasSubstr("urn:docent:inconsistency:")));
    for (const std::string& fact : site.Inferred()) EXPECT_FALSE(absl::EndsWith(fact, " a Problem")) << fact;
  }
}

TEST(HiddenReports, ChecksThatNegateBesideASet) {
  for (const char* set : {"rdfs", "owl2rl"}) {
    for (const char* check : {"RULE :chk { } WHERE { ?x :p2 ?y NOT { ?y :p1 ?x } }",
                              "RULE :chk { } WHERE { ?x :p2 ?y MINUS { ?x :p1 ?y } }",
                              "RULE :chk { } WHERE { { SELECT ?x (COUNT(?y) AS ?n) WHERE { ?x :p2 ?y } GROUP "
                              "BY ?x } FILTER(?n > 1) }",
                              "RULE :chk { } WHERE { ?x :p2 ?y NOT { ?x a ?c } }",
                              "RULE :chk { } WHERE { ?x ?p ?y . ?y ?q ?z }"}) {
      SCOPED_TRACE(absl::StrCat(set, " ", check));
      Site(check, set)
          .ExpectAsFresh({"i1 p3 i4", "i1 p2 i3", "p3 rdfs:subPropertyOf p2",
                          "docent:Inconsistency rdfs:subClassOf Problem"});
    }
  }
}

TEST(HiddenReports, NoPatternMatchesThem) {
  const std::string rules =
      "RULE :odd { } WHERE { ?x a :Robot . ?x a :Person }\n"
      "RULE { :all :uses ?p } WHERE { ?s ?p ?o FILTER(?p != :uses && ?p != :counts) }\n"
      "RULE { :all :types ?c } WHERE { ?x a ?c }\n"
      "RULE { :all :counts ?n } WHERE { { SELECT (COUNT(*) AS ?n) WHERE { ?s rdf:type ?o } } }\n"
      "RULE { :all :counts ?n } WHERE { { SELECT (COUNT(*) AS ?n) WHERE { ?e rdf:subject ?x ; rdf:object ?y "
      "} } }\n"
      "RULE { ?x :stated true } WHERE { { ?e rdf:subject ?x } UNION { ?e rdf:object ?x } }\n"
      "RULE { ?x :unstated true } WHERE { ?x a :Robot NOT { ?e rdf:subject ?x } }\n"
      "RULE { ?x :alone false } WHERE { ?x a :Robot FILTER EXISTS { ?e ?p ?x } }\n"
      "RULE { ?x :apart true } WHERE { ?x a :Robot MINUS { ?e rdf:subject ?x } }\n";
  Site site(rules);
  site.Turn({"r a Robot", "r a Person"});
  EXPECT_EQ(site.reports(), 1u);
  EXPECT_THAT(site.Followed(),
              ElementsAre("all counts 0", "all counts 2", "all types Person", "all types Robot", "all uses a",
                          "all uses apart", "all uses types", "all uses unstated", "r apart true",
                          "r unstated true"));
  site.Put(rules + "RULE { :all :types :new } WHERE { }\n");  // evaluated beside the reports
  site.Turn({"s a Robot", "s a Person", "e rdf:subject s"});
  EXPECT_EQ(site.reports(), 2u);
  EXPECT_THAT(site.Followed(), Contains("s stated true"));
  EXPECT_THAT(site.Followed(), Contains("s alone false"));
  site.Turn({}, {"r a Robot", "r a Person", "s a Robot", "s a Person", "e rdf:subject s"});
  site.ExpectAsFresh(
      {"r a Robot", "r a Person", "s a Robot", "s a Person", "e rdf:subject s", "e rdf:object r"});
}

TEST(HiddenReports, ACheckOfEverythingEnds) {
  Site site("RULE :any { } WHERE { ?s ?p ?o }\n");
  site.Turn({"a p b", "b p c"});
  EXPECT_EQ(site.reports(), 2u);
  site.Turn({}, {"a p b"});
  EXPECT_EQ(site.reports(), 1u);
}

TEST(HiddenReports, ARuleThatNamesThemIsRefused) {
  for (const char* body :
       {"?i a docent:Inconsistency", "?i docent:rule ?r", "?i docent:evidence/rdf:subject ?x",
        "?e ^docent:evidence ?i", "?x :p ?y NOT { ?i docent:evidence ?x }", "?i docent:binding ?b",
        "{ ?x :p ?y } UNION { ?b docent:bindingName ?y }",
        "{ SELECT (COUNT(?i) AS ?n) WHERE { ?i rdf:type docent:Inconsistency } }",
        "?b docent:bindingValue ?v"}) {
    for (const char* head : {"", ":a :b :c"}) {
      const std::string text =
          absl::StrCat("PREFIX : <http://example.org/>\nRULE { ", head, " } WHERE { ", body, " }\n");
      TestWorld world;
      RuleEngine engine(world.dictionary);
      const Diagnostics diagnostics = engine.PutRules("own", text);
      ASSERT_THAT(diagnostics, SizeIs(1)) << text;
      EXPECT_TRUE(HasErrors(diagnostics));
      EXPECT_EQ(diagnostics[0].span.line, 2) << text;
      EXPECT_THAT(diagnostics[0].message, HasSubstr("reports of checks"));
      EXPECT_THAT(engine.PutRules("own", text, RuleTextOrigin::kAccepted), IsEmpty()) << "as from a log";
      EXPECT_THAT(engine.PutRules("other", "PREFIX : <http://example.org/>\nDATA { :a :b :c }"), IsEmpty());
    }
  }
}

// A log of an older version may have such a rule.
TEST(HiddenReports, AnAcceptedRuleThatNamesThemSeesNone) {
  TestWorld world;
  RuleEngine engine(world.dictionary);
  ASSERT_THAT(engine.PutRules("own",
                              "PREFIX : <http://example.org/>\n"
                              "RULE :odd { } WHERE { ?x a :Robot . ?x a :Person }\n"
                              "RULE { ?i :seen true } WHERE { ?i a docent:Inconsistency }\n",
                              RuleTextOrigin::kAccepted),
              IsEmpty());
  ASSERT_TRUE(
      engine.Update(world.writer, world.Apply({"r a Robot", "r a Person", "own a docent:Inconsistency"}))
          .ok());
  const std::vector<std::string> inferred = world.Inferred();
  EXPECT_THAT(inferred, SizeIs(11));
  EXPECT_THAT(inferred, Contains("own seen true"));
}

TEST(HiddenReports, AToldFactOfAReportLeavesTheReport) {
  Site site(
      "RULE :odd { } WHERE { ?x a :Robot . ?x a :Person }\n"
      "RULE { :all :types ?c } WHERE { ?x a ?c }\n");
  site.Turn({"r a Robot", "r a Person"});
  const std::vector<std::string> inferred = site.Inferred();
  TestWorld& world = site.world();
  Delta copies;
  world.writer.current().ForEach(
      {TermId(), TermId(), TermId(), world.dictionary.InternIri(kInferredGraph)}, [&](const Quad& q) {
        if (world.Text(q.subject) != "all")
          copies.added.push_back({q.subject, q.predicate, q.object, world.Id("copy")});
        return true;
      });
  world.writer.AddAll(copies.added);
  site.Take(copies);
  EXPECT_EQ(site.Inferred(), inferred);
  site.Turn({}, {"r a Person"});
  EXPECT_THAT(site.Inferred(), ElementsAre("all types Robot"));
  site.Turn({"r a Person"});
  EXPECT_EQ(site.Inferred(), inferred);
  world.writer.RemoveAll(copies.added);
  copies.removed.swap(copies.added);
  site.Take(copies);
  EXPECT_EQ(site.Inferred(), inferred);
}

TEST(HiddenReports, ACheckThatLeavesTakesNoReportOfItsNameAlong) {
  const std::string high = "RULE :odd { } WHERE { ?x :v ?y FILTER(?y > 5) }\n",
                    low = "RULE :odd { } WHERE { ?x :v ?y FILTER(?y > 1) }\n",
                    untyped = "RULE :odd { } WHERE { ?x :v ?y NOT { ?x a ?c } }\n";
  Site site(high + low + untyped);
  site.Turn({"a v 7", "b v 3"});
  EXPECT_EQ(site.reports(), 4u);
  site.Put(low + untyped);
  EXPECT_EQ(site.reports(), 4u);
  site.Put(high + low);
  EXPECT_EQ(site.reports(), 2u);
  site.Put(high);
  EXPECT_EQ(site.reports(), 1u);
  site.Put(high + untyped);
  EXPECT_EQ(site.reports(), 3u);
}

TEST(HiddenReports, ACheckWithoutANameIsCalledByItsPlace) {
  const std::string check = "RULE { } WHERE { ?x a :Robot NOT { ?x :at ?y } }\n";
  Site site(check);
  site.Turn({"r a Robot"});
  EXPECT_THAT(site.Inferred(), Contains(HasSubstr("#rule 'own rule 1 (line 2)")));
  site.Put("RULE { ?x a :Thing } WHERE { ?x a :Robot }\n" + check);
  EXPECT_THAT(site.Inferred(), Contains(HasSubstr("#rule 'own rule 2 (line 3)")));
  EXPECT_THAT(site.Inferred(), Not(Contains(HasSubstr("#rule 'own rule 1 (line 2)"))));
}

}  // namespace
}  // namespace docent::rules
