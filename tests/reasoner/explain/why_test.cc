// Proofs of facts that no rule head makes: the reports of checks.
#include <algorithm>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "gmock/gmock.h"
#include "tests/reasoner/explain/explain_world.h"

namespace docent {
namespace {

using ::testing::AllOf;
using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::UnorderedElementsAre;

constexpr char kTwoNames[] = "RULE :twoNames { } WHERE { ?x :name ?a . ?x :name ?b . FILTER(?a < ?b) }";
constexpr char kLost[] =
    "RULE { } WHERE { { ?x :at ?p } UNION { ?x :near ?p } FILTER NOT EXISTS { ?p a :Place } }";

class WhyInconsistency : public ExplainWorld {
 protected:
  // The asserted facts under each report's proof, a report an element: "i name 1, i name 2".
  std::vector<std::string> ToldUnderReports() {
    auto explainer = Explain();
    const TermId inconsistency = dictionary.InternIri(DocentIri("Inconsistency"));
    std::vector<std::string> all;
    for (const TermQuad& report : Inferred({.object = inconsistency})) {
      const auto proof = explainer->WhyFact(report);
      EXPECT_TRUE(proof.ok() && proof->has_value()) << proof.status();
      std::vector<std::string> told;
      for (const explain::ProofStep& step : (*proof)->steps) {
        if (!step.told.empty()) told.push_back(TextOf(step.fact));
      }
      std::sort(told.begin(), told.end());
      all.push_back(absl::StrJoin(told, ", "));
    }
    return all;
  }
  std::vector<TermQuad> Inferred(QuadPattern pattern = {}) {
    std::vector<TermQuad> facts;
    pattern.graph = dictionary.InternIri(kInferredGraph);
    writer.current().ForEach(pattern, [&](const Quad& quad) {
      facts.push_back({dictionary.Decode(quad.subject), dictionary.Decode(quad.predicate),
                       dictionary.Decode(quad.object), Term()});
      return true;
    });
    return facts;
  }
  std::string TextOf(const TermQuad& fact) {
    const auto word = [this](const Term& term) { return Text(dictionary.Intern(term)); };
    return absl::StrCat(word(fact.subject), " ", word(fact.predicate), " ", word(fact.object));
  }
};

TEST_F(WhyInconsistency, IsExplainedByItsCheckAndWhatThatMatched) {
  Rules("names.rules", kTwoNames);
  Tell({"i name 1", "i name 2", "k name 1"});
  EXPECT_THAT(Why("ASK { ?i a docent:Inconsistency }"),
              HasSubstr(" a docent:Inconsistency\n"
                        "  by names.rules twoNames (line 2), ?x = :i, ?a = 1, ?b = 2\n"
                        "  and (1 < 2)\n"
                        "  :i :name 1\n"
                        "    told by docent:default\n"
                        "  :i :name 2\n"
                        "    told by docent:default\n"));
}

TEST_F(WhyInconsistency, EveryFactOfAReportIsExplained) {
  Rules("names.rules", kTwoNames);
  Rules("lost.rules", kLost);
  Tell({"i name 1", "i name 2", "k name 1", "k name 2", "r1 at p1", "r2 near p2"});
  auto explainer = Explain();
  const std::vector<TermQuad> facts = Inferred();
  EXPECT_GE(facts.size(), 2u * (2 + 2 * 4) + 2u * 2);
  for (const TermQuad& fact : facts) {
    const auto proof = explainer->WhyFact(fact);
    ASSERT_TRUE(proof.ok() && proof->has_value()) << proof.status();
    EXPECT_THAT((*proof)->steps[(*proof)->roots[0]].rule,
                AnyOf("names.rules twoNames (line 2)", "lost.rules rule 1 (line 2)"))
        << TextOf(fact);
  }
}

TEST_F(WhyInconsistency, EachReportRestsOnWhatItMatched) {
  Rules("names.rules", kTwoNames);
  Tell({"i name 1", "i name 2", "i name 3", "k name 1", "k name 2"});
  EXPECT_THAT(ToldUnderReports(), UnorderedElementsAre("i name 1, i name 2", "i name 1, i name 3",
                                                       "i name 2, i name 3", "k name 1, k name 2"));
}

TEST_F(WhyInconsistency, AReportWithoutEvidenceRestsOnItsSolution) {
  Rules("lost.rules", kLost);
  Tell({"r1 at p1", "r2 near p2", "r3 at p3", "p3 a Place"});
  EXPECT_THAT(ToldUnderReports(), UnorderedElementsAre("r1 at p1", "r2 near p2"));
  EXPECT_THAT(Why("ASK { ?i a docent:Inconsistency ; docent:rule ?r }"),
              AllOf(HasSubstr("by lost.rules rule 1 (line 2), "), HasSubstr("  and no { :p")));
}

TEST_F(WhyInconsistency, ChecksOfTheSameNameAreToldApart) {
  Rules("b.rules", "RULE :odd { } WHERE { ?x :name 2 }");
  Rules("a.rules", "RULE :odd { } WHERE { ?x :name 1 }");
  Tell({"i name 1", "k name 2"});
  EXPECT_THAT(ToldUnderReports(), UnorderedElementsAre("i name 1", "k name 2"));
  EXPECT_THAT(Why("ASK { ?i docent:evidence/rdf:subject :k }"),
              HasSubstr("by b.rules odd (line 2), ?x = :k"));
}

TEST_F(WhyInconsistency, OfOwlIsExplainedDownToWhoToldIt) {
  BuiltIn("owl2rl");
  Tell({"Man owl:disjointWith Woman", "Groom rdfs:subClassOf Man", "w1 a Groom @crm", "w1 a Woman"});
  const std::string text = Why("ASK { ?i a docent:Inconsistency ; docent:rule 'cax-dw' }");
  EXPECT_THAT(text, AllOf(HasSubstr("by owl2rl cax-dw (line "), HasSubstr(":Man owl:disjointWith :Woman"),
                          HasSubstr("  :w1 a :Man\n    by owl2rl cax-sco (line "),
                          HasSubstr("    :w1 a :Groom\n      told by :crm"),
                          HasSubstr("  :w1 a :Woman\n    told by")));
}

// A report would match these patterns, too, and is the first match in some orders.
TEST_F(WhyInconsistency, NoProofRestsOnAReport) {
  Rules("names.rules", kTwoNames);
  Rules("open.rules",
        "RULE { :all :names ?x } WHERE { ?s rdf:subject ?x }\n"
        "RULE { :all :has ?y } WHERE { ?x ?p ?y FILTER(?p != :has && ?p != :names) }\n"
        "RULE { :all :counts ?n } WHERE { { SELECT (COUNT(*) AS ?n) WHERE { ?s rdf:object ?y } } }");
  Tell({"i name 1", "i name 2", "s rdf:subject i", "s rdf:object 1"});
  for (const char* fact : {":all :names :i", ":all :has 1", ":all :counts 1"}) {
    EXPECT_THAT(Why(absl::StrCat("ASK { ", fact, " }")),
                AllOf(HasSubstr("by open.rules"), Not(HasSubstr("urn:docent:inconsistency:"))))
        << fact;
  }
  EXPECT_THAT(Why("ASK { { SELECT (COUNT(*) AS ?n) WHERE { ?i a docent:Inconsistency } } FILTER(?n = 1) }"),
              HasSubstr("by names.rules twoNames"))
      << "a question sees reports";
}

TEST_F(WhyInconsistency, ItsLeavesAreWhatToWithdraw) {
  Rules("names.rules", kTwoNames);
  Tell({"i name 1", "i name 2"});
  const explain::WhyNotAnswer answer = WhyNot("ASK { FILTER NOT EXISTS { ?i a docent:Inconsistency } }");
  ASSERT_FALSE(answer.repairs.empty());
  ASSERT_EQ(answer.repairs[0].in_the_way.size(), 1u);
  ASSERT_EQ(answer.repairs[0].in_the_way[0].withdraw.size(), 1u);
  EXPECT_EQ(TextOf(answer.repairs[0].in_the_way[0].withdraw[0]), "i name 1");
}

class WhyParts : public ExplainWorld {};

TEST_F(WhyParts, AnAggregateRestsOnTheFactsOfItsGroup) {
  Rules("load.rules",
        "RULE { ?r :load ?n } WHERE { { SELECT ?r (COUNT(?t) AS ?n) WHERE { ?r :task ?t } GROUP BY ?r } }");
  Tell({"R1 task t1", "R1 task t2", "R2 task t3"});
  const std::string text = Why("ASK { :R1 :load ?n }");
  EXPECT_THAT(text, HasSubstr(":R1 :load 2\n"
                              "  by load.rules rule 1 (line 2), ?r = :R1, ?n = 2\n"
                              "  and { SELECT ?r (COUNT(?t) AS ?n) WHERE { ?r :task ?t . } GROUP BY ?r }\n"
                              "  :R1 :task :t1\n"
                              "    told by docent:default\n"
                              "  :R1 :task :t2\n"
                              "    told by docent:default\n"));
  EXPECT_THAT(text, Not(HasSubstr("t3")));
}

TEST_F(WhyParts, OfManyFactsOfAGroupSomeAreShown) {
  for (int i = 0; i < 30; ++i) Tell({absl::StrCat("R1 task t", i)});
  EXPECT_THAT(
      Why("ASK { { SELECT ?r (COUNT(?t) AS ?n) WHERE { ?r :task ?t } GROUP BY ?r HAVING (COUNT(?t) > 3) } }"),
      AllOf(HasSubstr("?r = :R1, ?n = 30\n"), HasSubstr("GROUP BY ?r HAVING ((COUNT(?t) > 3))"),
            HasSubstr("(by 10 facts that are shown, and 20 more)")));
}

TEST_F(WhyParts, APathRestsOnAChainOfFacts) {
  Tell({"R1 in Hall", "Hall in Fair", "Fair in City", "R1 in Lobby", "Lobby in Annex", "Annex in Fair"});
  EXPECT_EQ(Why("ASK { :R1 :in+ :City }"),
            "and { :R1 (:in)+ :City }\n"
            ":R1 :in :Hall\n  told by docent:default\n"
            ":Hall :in :Fair\n  told by docent:default\n"
            ":Fair :in :City\n  told by docent:default\n");
}

TEST_F(WhyParts, APathInAGraphRestsOnFactsOfThatGraph) {
  Tell({"R1 in City @other", "R1 in Hall @map", "Hall in City @map"});
  EXPECT_EQ(Why("ASK { GRAPH :map { :R1 :in+ :City } }"),
            "and { GRAPH :map { :R1 (:in)+ :City . } }\n"
            ":R1 :in :Hall\n  told by :map\n"
            ":Hall :in :City\n  told by :map\n");
  EXPECT_THAT(Why("ASK { GRAPH ?g { ?g :is ?x } GRAPH ?g { :R1 :in+ :City } }"), "");
  Tell({"map is plan @map"});
  EXPECT_THAT(Why("ASK { GRAPH ?g { ?g :is ?x } GRAPH ?g { :R1 :in+ :City } }"),
              AllOf(HasSubstr(":R1 :in :Hall\n"), HasSubstr("GRAPH :map { :R1 (:in)+ :City . }")));
  EXPECT_THAT(Why("ASK { GRAPH ?g { ?r :in+ :City . ?r :in :Hall } }"),
              AllOf(HasSubstr("?g = :map"), HasSubstr("?r = :R1"),
                    HasSubstr("and { GRAPH :map { :R1 (:in)+ :City"), HasSubstr(":Hall :in :City\n")));
  EXPECT_THAT(
      Why("ASK { GRAPH :map { { SELECT (COUNT(?x) AS ?n) WHERE { ?x :in ?y } HAVING (COUNT(?x) = 2) } } }"),
      AllOf(HasSubstr(":R1 :in :Hall\n"), HasSubstr(":Hall :in :City\n"), Not(HasSubstr(":R1 :in :City\n"))));
}

TEST_F(WhyParts, PathsOfAllKindsHaveTheirFacts) {
  Tell({"a p b", "c q b", "c p d", "d r e"});
  EXPECT_THAT(Why("ASK { :a (:p/^:q)+/:p?/!(:p|:q)* :e }"),
              HasSubstr("and { :a ((:p/^:q))+ :c }\nand { :c (:p)? :d }\nand { :d (!(:p|:q))* :e }\n"));
  for (const char* fact : {":a :p :b\n", ":c :q :b\n", ":c :p :d\n", ":d :r :e\n"})
    EXPECT_THAT(Why("ASK { :a (:p/^:q)+/:p?/!(:p|:q)* :e }"), HasSubstr(fact));
  EXPECT_THAT(Why("ASK { :e ^(:p+/:r) :c }"), AllOf(HasSubstr(":c :p :d\n"), HasSubstr(":d :r :e\n")));
}

TEST_F(WhyParts, AChainIsOfToldFactsWhereThereIsOne) {
  Rules("in.rules", "RULE { ?x :in ?z } WHERE { ?x :in ?y . ?y :in ?z }");
  Tell({"R1 in Hall", "Hall in Fair", "Fair in City"});
  EXPECT_EQ(Why("ASK { :R1 :in+ :City }"),
            "and { :R1 (:in)+ :City }\n"
            ":R1 :in :Hall\n  told by docent:default\n"
            ":Hall :in :Fair\n  told by docent:default\n"
            ":Fair :in :City\n  told by docent:default\n");
}

TEST_F(WhyParts, PathsOneAfterTheOtherMeet) {
  Tell({"x p y", "y q e", "a p b", "b q c"});
  EXPECT_THAT(Why("ASK { ?v :p+/:q+ :c }"),
              HasSubstr("?v = :a\nand { :a (:p)+ :b }\nand { :b (:q)+ :c }\n:a :p :b\n"));
}

TEST_F(WhyParts, WhatIsInTheWayByAPathIsEachFactOfTheChain) {
  Tell({"R1 in Hall", "Hall in City"});
  const explain::WhyNotAnswer answer = WhyNot("ASK { FILTER NOT EXISTS { :R1 :in+ :City } }");
  ASSERT_EQ(answer.repairs.size(), 2u);
  EXPECT_TRUE(answer.whole);
}

// Every pair of a class rests on many others, so a search through all of them did not end for a large class.
class WhyEqual : public ExplainWorld {
 protected:
  WhyEqual() { BuiltIn("owl2rl"); }
};

TEST_F(WhyEqual, IsAWayOverToldPairs) {
  Tell({"a owl:sameAs b", "c owl:sameAs b", "c owl:sameAs d", "b likes x"});
  EXPECT_THAT(Why("ASK { :a owl:sameAs :c }"),
              HasSubstr(":a owl:sameAs :c\n"
                        "  by owl2rl eq-trans (line 15), ?x = :a, ?y = :b, ?z = :c\n"
                        "  :a owl:sameAs :b\n"
                        "    told by docent:default\n"
                        "  :b owl:sameAs :c\n"
                        "    by owl2rl eq-sym (line 14), ?x = :c, ?y = :b\n"
                        "    :c owl:sameAs :b\n"
                        "      told by docent:default\n"));
  EXPECT_THAT(Why("ASK { :d :likes :x }"), AllOf(HasSubstr("by owl2rl eq-rep-s"), HasSubstr(":b :likes :x"),
                                                 HasSubstr("told by docent:default")));
  EXPECT_THAT(Why("ASK { :a owl:sameAs :a }"),
              AllOf(HasSubstr("by owl2rl eq-trans"), HasSubstr(":a owl:sameAs :b")));
}

TEST_F(WhyEqual, IsFoundInALargeClass) {
  std::vector<std::string> told = {"e7 likes x"};
  for (int i = 0; i < 300; ++i) told.push_back(absl::StrCat("e", i, " owl:sameAs e", i + 1));
  Tell(told);
  const std::string why = Why("ASK { :e0 owl:sameAs :e300 }");
  EXPECT_THAT(why, AllOf(HasSubstr(":e0 owl:sameAs :e1\n"), HasSubstr(":e299 owl:sameAs :e300\n")));
  EXPECT_THAT(Why("ASK { :e300 :likes :x }"), HasSubstr(":e7 :likes :x"));
}

TEST_F(WhyEqual, MayRestOnOtherRules) {
  Tell({"badge a owl:InverseFunctionalProperty", "a badge 7", "b badge 7", "c owl:sameAs b", "c likes x",
        "home a owl:FunctionalProperty", "w home d", "w home a"});
  EXPECT_THAT(
      Why("ASK { :a owl:sameAs :c }"),
      AllOf(HasSubstr("by owl2rl prp-ifp"), HasSubstr(":c owl:sameAs :b"), Not(HasSubstr("unknown"))));
  EXPECT_THAT(Why("ASK { :d :likes :x }"), AllOf(HasSubstr("by owl2rl prp-fp"), HasSubstr(":c :likes :x")));
}

TEST_F(WhyEqual, ReachesLiteralsAndProperties) {
  Tell({"a owl:sameAs b", "b owl:sameAs 5", "s likes a", "likes owl:sameAs loves"});
  EXPECT_THAT(Why("ASK { :a owl:sameAs 5 }"), HasSubstr(":b owl:sameAs 5\n"));
  EXPECT_THAT(Why("ASK { :s :loves 5 }"), AllOf(HasSubstr("by owl2rl eq-rep"), HasSubstr(":s :likes :a")));
}

}  // namespace
}  // namespace docent
