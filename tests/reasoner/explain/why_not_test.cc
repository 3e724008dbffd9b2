// Why-not: the most natural repair comes first, and every listed repair is enough.
#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "gmock/gmock.h"
#include "tests/reasoner/explain/explain_world.h"

namespace docent {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::UnorderedElementsAre;

class WhyNotTest : public ExplainWorld {};

constexpr char kBig[] =
    "RULE :big { ?x a :Big } WHERE { ?x :area ?a . FILTER(?a >= 20) FILTER NOT EXISTS { ?x :broken :yes } }";

TEST_F(WhyNotTest, WhatARuleForbidsIsSaidOfTheRulesThing) {
  // ?x of the question is :bob, ?x of the rule is :t2
  Rules("big.rules", kBig);
  Tell({"bob likes t2", "t2 area 30", "t2 broken yes"});
  EXPECT_THAT(WhyNotText("ASK { ?x :likes ?y . ?y a :Big }"),
              HasSubstr("in the way  :t2 :broken :yes   (there must be no { :t2 :broken :yes })"));
}

TEST_F(WhyNotTest, WhatARuleForbidsIsSaidWithoutItsVariablesInAQuestionWithoutAny) {
  Rules("big.rules", kBig);
  Tell({"t2 area 30", "t2 broken yes"});
  EXPECT_THAT(WhyNotText("ASK { :t2 a :Big }"), HasSubstr("(there must be no { :t2 :broken :yes })"));
}

TEST_F(WhyNotTest, WhatARuleForbidsDoesNotTakeTheQuestionsNames) {
  Rules("free.rules", "RULE { ?r a :Free } WHERE { ?r a :Robot FILTER NOT EXISTS { ?r :task ?t } }");
  Tell({"r1 a Robot", "r1 task j1"});
  EXPECT_THAT(
      WhyNotText("ASK { :r1 a :Free ; :goes ?t }"),
      AllOf(HasSubstr("missing     :r1 :goes ?t"), HasSubstr("(there must be no { :r1 :task ?t2 })")));
}

TEST_F(WhyNotTest, WhatMustNotBeOfAnOpenVariableIsAConditionOnIt) {
  // with :c1 or :c2 for ?b, following the answer would not make it true
  Tell({"c1 edge c2", "c2 edge c1"});
  const std::string ask = "ASK { :c3 :edge ?b FILTER NOT EXISTS { ?b :edge ?c } }";
  const explain::WhyNotAnswer answer = WhyNot(ask, 9);
  ASSERT_EQ(answer.repairs.size(), 1u);
  EXPECT_THAT(answer.repairs[0].conditions, ElementsAre("there is no { ?b :edge ?c }"));
  EXPECT_THAT(WhyNotText(ask),
              HasSubstr("  missing     :c3 :edge ?b\n  where       there is no { ?b :edge ?c }\n"));
}

TEST_F(WhyNotTest, WhatMustNotBeIsAskedForOnceWhateverItsAlternatives) {
  Tell({"p1 a Place"});
  EXPECT_THAT(
      WhyNot("ASK { :r1 :at ?p MINUS { { ?p :taken ?by } UNION { ?p a :Closed } } }").repairs[0].conditions,
      ElementsAre("there is no { { ?p :taken ?by . } UNION { ?p a :Closed . } }"));
}

TEST_F(WhyNotTest, WhatARuleForbidsOfAnOpenVariableIsSaidInTheQuestionsNames) {
  Rules("free.rules", "RULE { ?r a :Free } WHERE { ?r a :Robot FILTER NOT EXISTS { ?r :task ?t } }");
  const explain::WhyNotAnswer answer = WhyNot("ASK { ?t a :Free ; :at :Hall }", 9);
  ASSERT_EQ(answer.repairs.size(), 1u);
  EXPECT_THAT(answer.repairs[0].conditions, ElementsAre("there is no { ?t :task ?t2 }"));
}

// forPatient says what a delivery is; at says in which state it is.
TEST_F(WhyNotTest, ASecondValueOfAFunctionalPropertyIsNotOffered) {
  Tell({"forPatient a owl:FunctionalProperty", "at a docent:StateProperty", "d1 forPatient ann", "d1 at Ward",
        "d2 forPatient bob"});
  const explain::WhyNotAnswer answer = WhyNot("ASK { ?d :forPatient :bob ; :at :Ward }", 9);
  ASSERT_EQ(answer.repairs.size(), 1u);
  EXPECT_THAT(WhyNotText("ASK { ?d :forPatient :bob ; :at :Ward }", 9),
              HasSubstr("missing     :d2 :at :Ward"));
  EXPECT_EQ(answer.forbidden, 1u);
  EXPECT_THAT(WhyNotText("ASK { :d1 :forPatient :bob }"),
              HasSubstr("1 set is left out: shapes, or what their properties may have, forbid it."));
  EXPECT_THAT(WhyNotText("ASK { :d3 :forPatient :bob }"), HasSubstr("missing     :d3 :forPatient :bob"))
      << "it has no value yet";
}

TEST_F(WhyNotTest, AValueOfAnInverseFunctionalPropertyIsNotOfferedTwice) {
  Tell({"badge a owl:InverseFunctionalProperty", "ann badge b1"});
  EXPECT_TRUE(WhyNot("ASK { :bob :badge :b1 }").repairs.empty());
  EXPECT_EQ(WhyNot("ASK { :bob :badge :b2 }").repairs.size(), 1u);
}

TEST_F(WhyNotTest, TwoValuesOfAStatePropertyAreNotOffered) {
  Tell({"is a docent:StateProperty", "door is Shut"});
  EXPECT_EQ(WhyNot("ASK { :door :is :Open }").repairs.size(), 1u) << "it may change";
  EXPECT_TRUE(WhyNot("ASK { :door :is :Open , :Shut }").repairs.empty());
  EXPECT_TRUE(WhyNot("ASK { :door :is :Open , :Locked }").repairs.empty());
}

TEST_F(WhyNotTest, WhatTheCallerForbidsIsNotOffered) {
  settings_.may_change = [](const std::vector<TermQuad>& add, const std::vector<TermQuad>&) {
    return absl::StatusOr<bool>(add.empty() || !add[0].subject.lexical.ends_with("p1"));
  };
  Tell({"p1 a Person", "p2 a Person"});
  const explain::WhyNotAnswer answer = WhyNot("ASK { ?p a :Person ; :likes :tea }", 9);
  ASSERT_EQ(answer.repairs.size(), 1u);
  EXPECT_THAT(answer.repairs[0].tell[0].example.subject.lexical, ::testing::EndsWith("p2"));
  EXPECT_EQ(answer.forbidden, 1u);
}

TEST_F(WhyNotTest, AFactThatTwoPatternsNeedIsInferredOnce) {
  Rules("inverse.rules", "RULE { ?x :holds ?y } WHERE { ?y :isHeldBy ?x }");
  Tell({"c isHeldBy d", "d marked yes"});
  const explain::WhyNotAnswer answer = WhyNot("ASK { :a :holds :b . ?x :holds :b }", 9);
  ASSERT_EQ(answer.repairs.size(), 1u);
  EXPECT_EQ(answer.repairs[0].inferred.size(), 1u) << WhyNotText("ASK { :a :holds :b . ?x :holds :b }");
}

TEST_F(WhyNotTest, WhatACheckForbidsByItselfIsNotTold) {
  Rules("kinds.rules",
        "RULE { ?x a :Pizza } WHERE { ?x a :Margherita } RULE { ?x a :Pizza } WHERE { ?x a :Impossible }\n"
        "RULE :none { } WHERE { ?x a :Impossible }\n"
        "RULE :one { } WHERE { ?x a :Margherita . ?x a :Salad }");
  const explain::WhyNotAnswer answer = WhyNot("ASK { :p a :Pizza }", 9);
  ASSERT_EQ(answer.repairs.size(), 1u) << WhyNotText("ASK { :p a :Pizza }", 9);
  EXPECT_EQ(Text(dictionary.Intern(answer.repairs[0].tell[0].example.object)), "Margherita");
  // a question about it gets an answer
  EXPECT_EQ(WhyNot("ASK { :p a :Impossible }").repairs.size(), 1u);
}

// Each set as "-Z p K" for withdrawn facts and "+F1 ack true" for asserted ones, sorted.
class WhyNotSets : public ExplainWorld {
 protected:
  std::vector<std::string> Sets(const std::string& ask, size_t sets = 9) {
    answer_ = WhyNot(ask, sets);
    std::vector<std::string> all;
    for (const explain::Repair& repair : answer_.repairs) {
      std::set<std::string> changes;
      for (const explain::ToTell& tell : repair.tell) changes.insert("+" + TextOf(tell.example));
      for (const explain::InTheWay& way : repair.in_the_way) {
        for (const TermQuad& quad : way.withdraw) changes.insert("-" + TextOf(quad));
      }
      all.push_back(absl::StrJoin(changes, ", "));
    }
    return all;
  }
  std::string TextOf(const TermQuad& fact) {
    const auto word = [this](const Term& term) { return Text(dictionary.Intern(term)); };
    return absl::StrCat(word(fact.subject), " ", word(fact.predicate), " ", word(fact.object));
  }

  explain::WhyNotAnswer answer_;
};

TEST_F(WhyNotSets, OfAGroupThatMustNotBeTheFactThatIsNotNeededIsInTheWay) {
  Tell({"Z p K", "Z2 a Bot"});
  EXPECT_THAT(Sets("ASK { :Z :p :K . FILTER NOT EXISTS { :Z :p :K . :Z2 a :Bot } }"),
              ElementsAre("-Z2 a Bot"));
  EXPECT_TRUE(answer_.whole);
  EXPECT_THAT(WhyNotText("ASK { :Z :p :K . FILTER NOT EXISTS { :Z :p :K . :Z2 a :Bot } }"),
              HasSubstr("in the way  :Z2 a :Bot   (there must be no { :Z :p :K . :Z2 a :Bot })"));
}

TEST_F(WhyNotSets, TheOrderOfPatternsInTheGroupDoesNotMatter) {
  Tell({"R1 at Hall", "R1 fault F1"});
  for (const char* group : {"?r :at ?a . ?r :fault ?f", "?r :fault ?f . ?r :at ?a"}) {
    EXPECT_THAT(Sets(absl::StrCat("ASK { ?r :at ?a . FILTER NOT EXISTS { ", group, " } }")),
                ElementsAre("-R1 fault F1", "+urn:docent:example:r at urn:docent:example:a"));
  }
}

TEST_F(WhyNotSets, EachFactOfTheGroupMayGo) {
  Tell({"X1 at2 K", "X2 at2 K", "X2 a Bot"});
  EXPECT_THAT(Sets("ASK { :X1 :at2 ?a . FILTER NOT EXISTS { ?p :at2 ?a . ?p a :Bot } }"),
              ElementsAre("-X2 at2 K", "-X2 a Bot", "+X1 at2 urn:docent:example:a"));
}

TEST_F(WhyNotSets, WhatMustNotBeInOneGraphIsWithdrawnFromThatOneOnly) {
  Tell({"Z p K", "R fault F1 @g", "R fault F1 @h"});
  const auto graphs = [this] {
    std::vector<std::string> all;
    for (const TermQuad& quad : answer_.repairs.at(0).in_the_way.at(0).withdraw)
      all.push_back(Text(dictionary.Intern(quad.graph)));
    return all;
  };
  EXPECT_THAT(Sets("ASK { :Z :p :K . FILTER NOT EXISTS { GRAPH :g { :R :fault ?f } } }"),
              ElementsAre("-R fault F1"));
  EXPECT_THAT(graphs(), ElementsAre("g"));
  EXPECT_THAT(WhyNotText("ASK { :Z :p :K . FILTER NOT EXISTS { GRAPH :g { :R :fault ?f } } }"),
              AllOf(HasSubstr("  in the way  :R :fault :F1   (there must be no { GRAPH :g {"),
                    HasSubstr("; told by :g)\n")));
  EXPECT_THAT(Sets("ASK { :Z :p :K . FILTER NOT EXISTS { :R :fault ?f } }"), ElementsAre("-R fault F1"));
  EXPECT_THAT(graphs(), UnorderedElementsAre("g", "h"));
}

TEST_F(WhyNotSets, APathInAGraphIsBrokenAndClosedInThatGraph) {
  Tell({"Z p K", "R1 in City @other", "R1 in Hall @map", "Hall in City @map"});
  EXPECT_THAT(Sets("ASK { :Z :p :K . FILTER NOT EXISTS { GRAPH :map { :R1 :in+ :City } } }"),
              UnorderedElementsAre("-R1 in Hall", "-Hall in City"));
  EXPECT_TRUE(answer_.whole);
  for (const char* graph : {":map", "?g"}) {
    EXPECT_THAT(Sets(absl::StrCat("ASK { :Z :p :K . FILTER NOT EXISTS { ?r :in :Hall . GRAPH ", graph,
                                  " { ?r :in+ :City . :Hall :in :City } } }")),
                UnorderedElementsAre("-R1 in Hall", "-Hall in City"));
  }
  EXPECT_THAT(Sets("ASK { GRAPH :map { :City :in+ :Fair } }"), Contains("+City in Fair"));
  EXPECT_THAT(Sets("ASK { GRAPH :other { :R1 :in+ :Fair } }"),
              UnorderedElementsAre("+R1 in Fair", "+City in Fair"));
}

TEST_F(WhyNotSets, AGraphIsThereOnceItHoldsAFact) {
  Tell({"Z p K", "R1 in Hall @map", "Hall in City @map"});
  EXPECT_THAT(Sets("ASK { GRAPH :none { BIND(1 AS ?x) } }"),
              ElementsAre("+urn:docent:example:s urn:docent:example:p urn:docent:example:o"));
  EXPECT_THAT(Sets("ASK { :Z :p :K . FILTER NOT EXISTS { GRAPH :none { FILTER(true) } } }"),
              testing::IsEmpty());
  EXPECT_THAT(Sets("ASK { FILTER NOT EXISTS { GRAPH :map { FILTER(true) } } }"),
              ElementsAre("-Hall in City, -R1 in Hall"));
}

TEST_F(WhyNotSets, ValuesThatPassFiltersOfTimesAndTextsAreFound) {
  Tell({"R1 a Bot"});
  const auto missing = [this](const std::string& filter) {
    return Sets("ASK { :R1 :has ?t FILTER(" + filter + ") }");
  };
  EXPECT_THAT(missing("?t > \"2026-01-01T00:00:00Z\"^^xsd:dateTime"),
              ElementsAre("+R1 has 2026-01-02T00:00:00+00:00"));
  EXPECT_THAT(missing("?t < \"2026-01-01T10:00:00.5\"^^xsd:dateTime"),
              ElementsAre("+R1 has 2025-12-31T10:00:00.5"));
  EXPECT_THAT(missing("?t > \"2026-02-28\"^^xsd:date"), ElementsAre("+R1 has 2026-03-01"));
  EXPECT_THAT(missing("LANG(?t) = \"de\""), ElementsAre("+R1 has 'example"));
  EXPECT_THAT(missing("STRSTARTS(STR(?t), \"http://example.org/\")"), ElementsAre("+R1 has example"));
  EXPECT_THAT(missing("STRSTARTS(?t, \"abc\")"), ElementsAre("+R1 has 'abc"));
}

TEST_F(WhyNotSets, AllDerivationsOfWhatIsInTheWayHaveToGo) {
  Rules("bad.rules", "RULE { ?r a :Bad } WHERE { ?r :fault ?f }");
  Tell({"Z p K", "R fault F1", "R fault F2"});
  const std::string ask = "ASK { :Z :p :K . FILTER NOT EXISTS { :R a :Bad } }";
  EXPECT_THAT(Sets(ask), ElementsAre("-R fault F1, -R fault F2"));
  EXPECT_TRUE(answer_.whole);
  EXPECT_THAT(WhyNotText(ask), HasSubstr("  in the way  :R a :Bad   (there must be no { :R a :Bad })\n"
                                         "  withdraw    :R :fault :F1   (it is inferred from this)\n"
                                         "  withdraw    :R :fault :F2   (it is inferred from this)\n"));
}

TEST_F(WhyNotSets, ADerivationGoesAlsoByWhatItsRuleForbids) {
  Rules("bad.rules", "RULE { ?r a :Bad } WHERE { ?r :fault ?f . FILTER NOT EXISTS { ?f :ack true } }");
  Tell({"Z p K", "R fault F1", "R fault F2"});
  const std::string ask = "ASK { :Z :p :K . FILTER NOT EXISTS { :R a :Bad } }";
  EXPECT_THAT(Sets(ask), UnorderedElementsAre("-R fault F1, -R fault F2", "+F1 ack true, -R fault F2",
                                              "+F2 ack true, -R fault F1", "+F1 ack true, +F2 ack true"));
  EXPECT_TRUE(answer_.whole);
  EXPECT_THAT(WhyNotText(ask, 9),
              HasSubstr("missing     :F1 :ack true   (for there to be no { :R a :Bad })"));
}

TEST_F(WhyNotSets, WhatIsMissingMayItselfClearTheWay) {
  Rules("bad.rules", "RULE { ?r a :Bad } WHERE { ?r :fault ?f . FILTER NOT EXISTS { ?f :ack true } }");
  Tell({"R fault F1"});
  EXPECT_THAT(Sets("ASK { ?f :ack true . FILTER NOT EXISTS { :R a :Bad } }"), ElementsAre("+F1 ack true"));
}

TEST_F(WhyNotSets, AnAbsenceInAnAbsenceIsFilled) {
  Tell({"R fault F1"});
  EXPECT_THAT(Sets("ASK { FILTER NOT EXISTS { ?r :fault ?f . FILTER NOT EXISTS { ?f :ack ?by } } }"),
              ElementsAre("-R fault F1", "+F1 ack urn:docent:example:by"));
}

TEST_F(WhyNotSets, AnAbsenceInAnAbsenceInAnAbsenceIsClearedAgain) {
  Rules("deep.rules",
        "RULE { ?f a :Settled } WHERE { ?f :ack :yes . FILTER NOT EXISTS { ?f :reopened :yes } }\n"
        "RULE { ?r a :Bad } WHERE { ?r :fault ?f . FILTER NOT EXISTS { ?f a :Settled } }");
  Tell({"R fault F1", "F1 ack yes", "F1 reopened yes"});
  EXPECT_THAT(Sets("ASK { FILTER NOT EXISTS { :R a :Bad } }"),
              UnorderedElementsAre("-R fault F1", "-F1 reopened yes"));
}

TEST_F(WhyNotSets, OneChangeForManyMatchesComesFirst) {
  Tell({"R fault F1", "R fault F2", "R fault F3", "R a Robot"});
  EXPECT_THAT(Sets("ASK { FILTER NOT EXISTS { ?r a :Robot ; :fault ?f } }"), ElementsAre("-R a Robot"));
}

TEST_F(WhyNotSets, MoreInTheWayThanTheLimitIsNotSaidToBeTheWhole) {
  for (int i = 0; i < 9; ++i) Tell({absl::StrCat("R fault F", i)});
  EXPECT_THAT(Sets("ASK { FILTER NOT EXISTS { ?r :fault ?f } }"), ElementsAre());
  EXPECT_FALSE(answer_.whole);
}

TEST_F(WhyNotSets, OfARecursivePathAStepIsMissing) {
  EXPECT_THAT(Sets("ASK { :Hall :in+ :City }"), ElementsAre("+Hall in City"));
  EXPECT_TRUE(answer_.whole);
  EXPECT_THAT(Sets("ASK { :Hall (:in|:partOf)+ :City }"), ElementsAre("+Hall in City", "+Hall partOf City"));
  EXPECT_THAT(Sets("ASK { :Hall :in? :City }"), ElementsAre("+Hall in City"));
  EXPECT_THAT(Sets("ASK { :Hall :in*/:name ?n }"), UnorderedElementsAre("+Hall name urn:docent:example:n"));
}

TEST_F(WhyNotSets, OfARecursivePathTheStepBetweenTwoChainsIsMissing) {
  Tell({"R1 in Hall", "Hall in Fair", "City in Land", "Other in Place"});
  EXPECT_THAT(Sets("ASK { :R1 :in+ :Land }"), ElementsAre("+R1 in Land", "+Fair in City", "+Fair in Land",
                                                          "+Hall in City", "+Hall in Land", "+R1 in City"));
  EXPECT_TRUE(answer_.whole);
}

// A set of six; five are enough by another match, and of these four.
TEST_F(WhyNotSets, ALargeSetIsMadeAsSmallAsItCanBe) {
  Rules("rules",
        "RULE { ?x :q ?z } WHERE { ?x :q ?y . ?y :q ?z }\n"
        "RULE { ?y :q ?x } WHERE { ?x :q ?y . ?x :p1 ?z }\n"
        "RULE { ?x :p2 ?y } WHERE { ?x :p1 ?y . FILTER(?y > 2) }\n"
        "RULE { ?x :p2 ?y } WHERE { { ?x :p0 ?y } UNION { ?y :p1 ?x } }\n"
        "RULE { ?x a :Thing } WHERE { ?x :p0 ?y . FILTER EXISTS { ?y :p0 ?w } }\n"
        "RULE { ?x a :Other } WHERE { ?x a :Thing . MINUS { ?x :p3 ?y } }\n"
        "RULE { ?x a :Bad } WHERE { ?x :p0 ?y . FILTER NOT EXISTS { ?y :p1 ?z } }\n");
  Tell({"n0 p2 n2 @g1", "n1 p0 n3", "n1 p1 0.1", "n1 p2 4", "n1 p3 n1", "n2 p0 n0 @g0", "n2 p2 n0 @g1",
        "n2 p3 0.1f @g0", "n3 p0 3", "n3 p0 n2", "n3 p0 n2 @g0", "n3 p1 n3", "n3 p2 n2", "n4 p0 n0",
        "n4 p0 n3", "n4 p1 n0 @g0", "n4 p2 1 @g0", "n4 p3 '2"});
  const explain::WhyNotAnswer answer = WhyNot(
      "ASK { :n3 :p3 :n4 . ?z :p1 ?y . ?y :p3 :n1 . ?y a :Other . FILTER NOT EXISTS { :n1 :p0 ?x . ?z :p1 ?z "
      ". } ?z (:p0/:p1)* ?x . }",
      4);
  ASSERT_FALSE(answer.repairs.empty());
  EXPECT_EQ(answer.repairs[0].size(), 4u);
}

TEST_F(WhyNotSets, WhatAnAggregateLacksIsNotSaidToBeKnown) {
  Tell({"a in b"});
  const std::string ask = "ASK { { SELECT (COUNT(?x) AS ?n) WHERE { ?x :in ?y } HAVING (COUNT(?x) > 4) } }";
  EXPECT_THAT(Sets(ask), ElementsAre());
  EXPECT_FALSE(answer_.whole);
  EXPECT_THAT(answer_.failed_part, HasSubstr("HAVING"));
}

constexpr char kVisitorsOfABooth[] = "{ SELECT ?b (COUNT(?v) AS ?n) WHERE { ?v :at ?b } GROUP BY ?b }";

TEST_F(WhyNotSets, WhatACountLacksIsToldOrWithdrawn) {
  Tell({"v1 at B", "B a Booth"});
  const auto ask = [](const std::string& filter) {
    return absl::StrCat("ASK { ?b a :Booth . ", kVisitorsOfABooth, " FILTER(", filter, ") }");
  };
  EXPECT_THAT(Sets(ask("?n >= 2")), ElementsAre("+urn:docent:example:v at B"));
  EXPECT_TRUE(answer_.whole);
  EXPECT_THAT(WhyNotText(ask("?n >= 2")), HasSubstr("missing     ?v :at :B"));
  Tell({"v2 at B", "v3 at B"});
  EXPECT_THAT(Sets(ask("?n < 3")), UnorderedElementsAre("-v1 at B", "-v2 at B", "-v3 at B"));
  EXPECT_EQ(Sets(ask("1 = ?n")).size(), 3u);
  EXPECT_THAT(Sets(ask("?n > 3")), ElementsAre("+urn:docent:example:v at B"));
}

TEST_F(WhyNotSets, ARuleThatTellsTheCountIsFollowed) {
  Rules("r.rules", absl::StrCat("RULE { ?b :visitors ?n } WHERE { ?b :open :Yes . ", kVisitorsOfABooth,
                                " FILTER(?n >= 2) }"));
  Tell({"v1 at B", "v2 at B"});
  EXPECT_THAT(Sets("ASK { :B :visitors 2 }"), Contains("+B open Yes"));
  EXPECT_FALSE(answer_.whole);
}

TEST_F(WhyNotSets, WhatTheCountOfARuleLacksIsTold) {
  Rules("crowd.rules",
        absl::StrCat("RULE { ?b :state :Crowded } WHERE { ", kVisitorsOfABooth, " FILTER(?n >= 3) }\n",
                     "RULE { ?b :state :Empty } WHERE { ?b a :Booth FILTER NOT EXISTS { ", kVisitorsOfABooth,
                     " FILTER(?n >= 1) } }"));
  Tell({"v1 at B", "B a Booth", "C a Booth"});
  EXPECT_THAT(Sets("ASK { :B :state :Crowded }"),
              ElementsAre("+urn:docent:example:v at B, +urn:docent:example:v2 at B"));
  Tell({"v2 at B", "v3 at B"});
  EXPECT_THAT(Why("ASK { :B :state :Crowded }"), HasSubstr("COUNT(?v)"));
  EXPECT_THAT(Sets("ASK { FILTER NOT EXISTS { :B :state :Crowded } }"),
              UnorderedElementsAre("-v1 at B", "-v2 at B", "-v3 at B"));
}

class WhyNotOwl : public ExplainWorld {
 protected:
  WhyNotOwl() { BuiltIn("owl2rl"); }

  // The first set of missing facts, a fact a line, sorted.
  std::string Missing(const std::vector<std::string>& told, const std::string& ask) {
    Tell(told);
    const explain::WhyNotAnswer answer = WhyNot(ask);
    if (answer.repairs.empty()) return "";
    std::vector<std::string> facts;
    for (const explain::ToTell& tell : answer.repairs[0].tell) {
      const auto word = [&](const Term& term) { return Text(dictionary.Intern(term)); };
      facts.push_back(word(tell.example.subject) + " " + word(tell.example.predicate) + " " +
                      word(tell.example.object) + "\n");
    }
    std::sort(facts.begin(), facts.end());
    return absl::StrJoin(facts, "");
  }
};

TEST_F(WhyNotOwl, AFactAboutTheThingComesBeforeAnAxiom) {
  // one axiom about servesAt would be enough, too: its domain, a superclass of Machine, that R1 is R2
  EXPECT_EQ(Missing({"R1 servesAt B1", "R1 a Machine", "R2 a Robot"}, "ASK { :R1 a :Robot }"),
            "R1 a Robot\n");
  EXPECT_EQ(Missing({"R1 knows B1", "R2 isAt B1"}, "ASK { :R1 :isAt :B1 }"), "R1 isAt B1\n");
}

TEST_F(WhyNotOwl, NothingIsMadeAMemberOfNothing) {
  Tell({"Pizza a owl:Class", "p knows q"});
  const explain::WhyNotAnswer answer = WhyNot("ASK { :p a :Pizza }", 9);
  ASSERT_EQ(answer.repairs.size(), 1u) << WhyNotText("ASK { :p a :Pizza }", 9);
  EXPECT_EQ(answer.repairs[0].inferred.size(), 0u);
}

TEST_F(WhyNotOwl, TwoFactsAboutThingsComeBeforeOneAxiom) {
  EXPECT_EQ(Missing({"R2 isAt B1", "R2 a Robot", "R1 knows R2"}, "ASK { :R1 a :Robot . :R1 :isAt :B1 }"),
            "R1 a Robot\nR1 isAt B1\n");
}

TEST_F(WhyNotOwl, WhatTheConditionSaysComesBeforeAnAxiomHoweverLongTheSearch) {
  std::vector<std::string> told;
  for (int i = 0; i < 40; ++i) {
    const std::string n = absl::StrCat(i);
    told.insert(told.end(),
                {"p" + n + " rdfs:domain C" + n, "C" + n + " rdfs:subClassOf D" + n,
                 "x" + n + " p" + n + " y" + n, "q" + n + " rdfs:subPropertyOf p" + n, "z" + n + " a C" + n});
  }
  EXPECT_THAT(Missing(told, "ASK { ?e a :Event . ?e :operation 1 . :O6 :confirmedBy ?guest }"),
              AllOf(HasSubstr(" a Event"), Not(HasSubstr("rdf-schema#"))));
}

TEST_F(WhyNotOwl, AnAxiomThatTheQuestionAsksForIsNamed) {
  EXPECT_EQ(Missing({"R1 a Guide"}, "ASK { :R1 a ?c . ?c rdfs:subClassOf :Robot }"),
            "Guide http://www.w3.org/2000/01/rdf-schema#subClassOf Robot\n");
}

}  // namespace
}  // namespace docent
