// Rules that read the reports of checks: they come after the checks, in whatever strata those are.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "absl/strings/str_join.h"
#include "reasoner/rules/rule_engine.h"
#include "reasoner/rules/rule_sets.h"
#include "tests/reasoner/test_world.h"

namespace docent::rules {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

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
  void Take(const Delta& told) {
    const absl::StatusOr<Delta> delta = engine_.Update(world_.writer, told);
    EXPECT_TRUE(delta.ok()) << delta.status();
    engine_.Commit();
    world_.writer.Commit();
  }
  std::vector<std::string> Inferred() const { return world_.Inferred(); }
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

TEST(ReportStrata, WhatASetMakesOfAReportGoesWithIt) {
  for (const char* set : {"rdfs", "owl2rl"}) {
    SCOPED_TRACE(set);
    Site(kBusy, set)
        .ExpectAsFresh({"i1 p3 i4", "i1 p2 i3", "p3 rdfs:subPropertyOf p2",
                        "docent:Inconsistency rdfs:subClassOf Problem", "docent:rule rdfs:domain Ruled"});
  }
}

TEST(ReportStrata, ASetReadsTheReportsOfChecksThatNegate) {
  for (const char* set : {"rdfs", "owl2rl"}) {
    for (const char* check : {"RULE :chk { } WHERE { ?x :p2 ?y NOT { ?y :p1 ?x } }",
                              "RULE :chk { } WHERE { ?x :p2 ?y MINUS { ?x :p1 ?y } }",
                              "RULE :chk { } WHERE { { SELECT ?x (COUNT(?y) AS ?n) WHERE { ?x :p2 ?y } GROUP "
                              "BY ?x } FILTER(?n > 1) }",
                              "RULE :chk { } WHERE { ?x :p2 ?y NOT { ?x a ?c } }"}) {
      SCOPED_TRACE(std::string(set) + " " + check);
      Site(check, set)
          .ExpectAsFresh({"i1 p3 i4", "i1 p2 i3", "p3 rdfs:subPropertyOf p2",
                          "docent:Inconsistency rdfs:subClassOf Problem"});
    }
  }
}

// A rule that reads reports is in no lower stratum than their check.
TEST(ReportStrata, ARuleAboutReportsSeesThoseOfACheckThatComesLate) {
  Site site(
      "RULE { ?x :h ?y } WHERE { ?x :k ?y NOT { ?x :m ?y } }\n"
      "RULE { ?x :m ?y } WHERE { ?x :l ?y }\n"
      "RULE :late { } WHERE { ?x :h ?y }\n"
      "RULE { :ops :warned ?x } WHERE { ?i a docent:Inconsistency ; docent:evidence/rdf:subject ?x }\n"
      "RULE { ?x :trusted true } WHERE { ?x a :Robot NOT { ?i docent:evidence/rdf:subject ?x } }\n"
      "RULE { :ops :reports ?n } WHERE { { SELECT (COUNT(?i) AS ?n) WHERE { ?i docent:rule \"late\" } } "
      "}\n");
  site.Turn({"r k s", "r a Robot", "s a Robot"});
  EXPECT_THAT(site.Inferred(), Contains("ops warned r"));
  EXPECT_THAT(site.Inferred(), Contains("ops reports 1"));
  EXPECT_THAT(site.Inferred(), Contains("s trusted true"));
  EXPECT_THAT(site.Inferred(), Not(Contains("r trusted true")));
  site.Turn({}, {"r k s", "r a Robot", "s a Robot"});
  site.ExpectAsFresh({"r k s", "r l s", "r a Robot", "s a Robot", "s k r"});
}

TEST(ReportStrata, ANegatedReportBesideASetIsSeen) {
  for (const char* set : {"rdfs", "owl2rl"}) {
    SCOPED_TRACE(set);
    Site site(
        "RULE :odd { } WHERE { ?x a :Robot . ?x a :Person }\n"
        "RULE { ?x :trusted true } WHERE { ?x a :Robot NOT { ?i docent:evidence/rdf:subject ?x } }\n"
        "RULE { ?x :calm true } WHERE { ?x a :Robot NOT { ?i a :Problem } }\n",
        set);
    site.Turn({"r a Robot", "s a Robot", "r a Person"});
    EXPECT_THAT(site.Inferred(), Contains("s trusted true"));
    EXPECT_THAT(site.Inferred(), Not(Contains("r trusted true")));
    EXPECT_THAT(site.Inferred(), Contains("s calm true"));
    site.Turn({"docent:Inconsistency rdfs:subClassOf Problem"});
    EXPECT_THAT(site.Inferred(), Not(Contains("s calm true")));
    site.Turn({}, {"r a Robot", "s a Robot", "r a Person", "docent:Inconsistency rdfs:subClassOf Problem"});
    site.ExpectAsFresh({"r a Robot", "s a Robot", "Actor rdfs:subClassOf Person", "r a Actor",
                        "docent:Inconsistency rdfs:subClassOf Problem"});
  }
}

TEST(ReportStrata, NegatingAReportAboutItselfIsRefused) {
  TestWorld world;
  RuleEngine engine(world.dictionary);
  const Diagnostics diagnostics =
      engine.PutRules("own",
                      "PREFIX : <http://example.org/>\n"
                      "RULE { ?x a :Calm } WHERE { ?x a :Robot NOT { ?i a docent:Inconsistency } }\n"
                      "RULE :odd { } WHERE { ?x a :Calm . ?x a :Wild }\n");
  ASSERT_FALSE(diagnostics.empty());
  EXPECT_THAT(diagnostics[0].message, HasSubstr("negation through recursion"));
}

// The patterns would match reports, too.
TEST(ReportStrata, AnOpenPatternDoesNotNegateItsOwnReports) {
  Site(
      "RULE :untyped { } WHERE { ?x :at ?y NOT { ?x a ?c } }\n"
      "RULE :subjectless { } WHERE { ?x a rdf:Statement NOT { ?x rdf:subject ?s } }\n")
      .ExpectAsFresh({"r at b", "r a Robot", "s near r", "t a rdf:Statement", "t rdf:subject r"});
}

TEST(ReportStrata, AToldFactOfAReportLeavesTheReport) {
  Site site("RULE :odd { } WHERE { ?x a :Robot . ?x a :Person }\n");
  site.Turn({"r a Robot", "r a Person"});
  const std::vector<std::string> reported = site.Inferred();
  TestWorld& world = site.world();
  Delta copies;
  world.writer.current().ForEach(
      {TermId(), TermId(), TermId(), world.dictionary.InternIri(kInferredGraph)}, [&](const Quad& q) {
        copies.added.push_back({q.subject, q.predicate, q.object, world.Id("copy")});
        return true;
      });
  world.writer.AddAll(copies.added);
  site.Take(copies);
  EXPECT_THAT(site.Inferred(), IsEmpty());
  world.writer.RemoveAll(copies.added);
  copies.removed.swap(copies.added);
  site.Take(copies);
  EXPECT_EQ(site.Inferred(), reported);
}

}  // namespace
}  // namespace docent::rules
