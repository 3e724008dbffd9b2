// Sequences on which the rule engine was once wrong.
#include <gtest/gtest.h>

#include "tests/property/rule_sequences.h"

namespace docent {
namespace {

std::string Try(const std::string& rules, const std::vector<Step>& steps) {
  std::string trace;
  FirstDifference(rules, steps, &trace);
  return trace;
}

constexpr char kSub[] =
    "RULE { ?x ?p2 ?y } WHERE { ?p1 rdfs:subPropertyOf ?p2 . ?x ?p1 ?y }\n"
    "RULE { ?a rdfs:subPropertyOf ?b } WHERE { ?a :like ?b }\n"
    "RULE { ?x :h ?y } WHERE { ?x :k ?y NOT { ?x :m ?y } }\n";

// Facts made too early by the order of the former axioms are removed again.
TEST(ReasonerRulesKnown, WhatWasRemadeIsTakenBackToo) {
  const std::string without = kSub;
  const std::string with = without + "RULE { ?x :u ?y } WHERE { ?x :z ?y }\n";
  EXPECT_EQ(Try(with, {{{{"a k b", "a z b"}, {}}, {}}, {{{"h like t", "t like u", "a m b"}, {}}, without}}),
            "");
}

TEST(ReasonerRulesKnown, WhatALowerStratumRemadeIsTakenBackToo) {
  const std::string rules =
      "RULE { ?x ?p2 :v } WHERE { ?p1 rdfs:subPropertyOf ?p2 . ?x ?p1 :v }\n"
      "RULE { ?a rdfs:subPropertyOf ?b } WHERE { ?a :like ?b }\n"
      "RULE { ?x :low :w } WHERE { ?x :z0 :w }\n"
      "RULE { ?x :h2 :v } WHERE { ?x :hh :v NOT { ?x :low :w } }\n"
      "RULE { ?x :u :v } WHERE { ?x :z :w }\n"
      "RULE { ?x :h :v } WHERE { ?x :k :v NOT { ?x :m :v } }\n";
  EXPECT_EQ(
      Try(rules, {{{{"a k v", "a z w"}, {}}, {}}, {{{"h like t", "t like u", "a m v"}, {"a z w"}}, {}}}), "");
}

TEST(ReasonerRulesKnown, ProofsOfAnEarlierPassAreForgotten) {
  // c1 told and made by a UNION rule; f rests on c1 and on q
  const std::string rules = std::string(kSub) +
                            "RULE { ?x :c ?y } WHERE { { ?x :z ?y } UNION { ?x :w ?y } }\n"
                            "RULE { ?x :f ?y } WHERE { ?x :c ?y }\n"
                            "RULE { ?x :f ?y } WHERE { ?x :q ?y }\n";
  EXPECT_EQ(Try(rules,
                {{{{"a k b", "a z b", "a c b", "a q b"}, {}}, {}}, {{{"h like t"}, {"a c b", "a q b"}}, {}}}),
            "");
}

TEST(ReasonerRulesKnown, WhatIsTakenBackIsNoAxiom) {
  const std::string rules =
      "RULE { ?x ?p2 :v } WHERE { ?p1 rdfs:subPropertyOf ?p2 . ?x ?p1 :v }\n"
      "RULE { ?a rdfs:subPropertyOf ?b } WHERE { ?a :like ?b }\n"
      "RULE { ?x :h :v } WHERE { ?x :k :v NOT { ?x :m :v } }\n"
      "RULE { ?x :got :w } WHERE { ?p rdfs:domain :v . ?x ?p ?y }\n";
  EXPECT_EQ(Try(rules, {{{{"pp k v", "x pp y"}, {}}, {}},
                        {{{"h like rdfs:domain", "pp m v"}, {}}, {}},
                        {{{"z pp y2"}, {}}, {}}}),
            "");
}

constexpr char kCOld[] =
    "RULE { ?x :q0 ?y } WHERE { ?x :p2 ?y NOT { ?y a :n0 } }\n"
    "RULE { ?a rdfs:subPropertyOf ?b } WHERE { ?a :like ?b }\n"
    "RULE { ?a :like ?b } WHERE { { ?a :like1 ?b } UNION { ?a :like2 ?b } }\n"
    "RULE { ?x :p0 ?y } WHERE { { ?x :p1 ?y } UNION { ?x :q0 ?y } }\n";
constexpr char kCNew[] =
    "RULE { ?x ?p2 ?y } WHERE { ?p1 rdfs:subPropertyOf ?p2 . ?x ?p1 ?y FILTER(?p1 != ?p2) }\n"
    "RULE { ?x :q3 ?y } WHERE { ?x :p1 ?y NOT { ?x :p3 ?y } NOT { ?y :q2 ?x } }\n"
    "RULE { ?a rdfs:subPropertyOf ?b } WHERE { ?a :like ?b }\n"
    "RULE { ?x :p0 ?y } WHERE { { ?x :p1 ?y } UNION { ?x :q0 ?y } }\n";

TEST(ReasonerRulesKnown, ALevelThatFalls) {
  EXPECT_EQ(Try(kCOld, {{{{"q3 like1 p1", "n1 p2 n2"}, {}}, {}}, {{{"p0 like q0"}, {}}, kCNew}}), "");
}

TEST(ReasonerRulesKnown, ALevelThatFallsRefusesNothing) {
  EXPECT_EQ(Try(kCOld, {{{{"q3 like1 p1", "h p2 m"}, {}}, {}},
                        {{{"p0 like q0"}, {}},
                         std::string(kCNew) + "RULE { ?x rdfs:subPropertyOf ?y } WHERE { ?x :q0 ?y }\n"
                                              "RULE { ?x :h ?y } WHERE { ?x :k ?y NOT { ?x :m ?y } }\n"}}),
            "");
}

TEST(ReasonerRulesKnown, ALevelThatFallsByAFact) {
  EXPECT_EQ(Try(kCNew,
                {{{{"q3 like p1", "n1 q0 n2"}, {}}, {}}, {{{"p0 like q0"}, {"q3 like p1", "n1 q0 n2"}}, {}}}),
            "");
}

TEST(ReasonerRulesKnown, APremiseThatComesBackAfterItsRuleLeft) {
  const std::string stay =
      "RULE { ?x :u ?y } WHERE { { ?x :z ?y } UNION { ?x :w ?y } }\n"
      "RULE { ?x :m ?y } WHERE { ?x :mm ?y }\n"
      "RULE { ?x :s ?y } WHERE { ?x :k ?y NOT { ?x :m ?y } }\n"
      "RULE { ?x :t ?y } WHERE { ?x :u ?y . ?x :s ?y }\n";
  const std::string leave = "RULE { ?x :u ?y } WHERE { ?x :l ?y }\nRULE { ?x :t ?y } WHERE { ?x :l ?y }\n";
  EXPECT_EQ(Try(stay + leave, {{{{"a z b", "a k b", "a l b"}, {}}, {}}, {{{"n p n"}, {}}, stay}}), "");
}

TEST(ReasonerRulesKnown, APremiseThatComesBackAfterItWasTold) {
  const std::string stay =
      "RULE { ?x :u ?y } WHERE { { ?x :z ?y } UNION { ?x :w ?y } }\n"
      "RULE { ?x :m ?y } WHERE { ?x :mm ?y }\n"
      "RULE { ?x :s ?y } WHERE { ?x :k ?y NOT { ?x :m ?y } }\n"
      "RULE { ?x :t ?y } WHERE { ?x :u ?y . ?x :s ?y }\n";
  EXPECT_EQ(Try(stay, {{{{"a z b", "a k b", "a u b", "a t b"}, {}}, {}}, {{{}, {"a t b", "a u b"}}, {}}}),
            "");
}

TEST(ReasonerRulesKnown, APremiseThatComesBack) {
  const std::string stay =
      "RULE { ?x :u ?y } WHERE { { ?x :z ?y } UNION { ?x :w ?y } }\n"
      "RULE { ?x :u ?y } WHERE { ?x :l ?y }\n"
      "RULE { ?x :t ?y } WHERE { ?x :l ?y }\n"
      "RULE { ?x :m ?y } WHERE { ?x :mm ?y }\n"
      "RULE { ?x :s ?y } WHERE { ?x :k ?y NOT { ?x :m ?y } }\n"
      "RULE { ?x :t ?y } WHERE { ?x :u ?y . ?x :s ?y }\n";
  EXPECT_EQ(Try(stay, {{{{"a z b", "a k b", "a l b"}, {}}, {}}, {{{}, {"a l b"}}, {}}}), "");
}

// It is above its premise, which is lost and made again by a fact of the same turn.
TEST(ReasonerRulesKnown, WhatRestsOnWhatIsMadeAnewIsMadeAnewToo) {
  const std::string rules = std::string(kSub) +
                            "RULE { ?x :b ?y } WHERE { ?x :c ?y }\n"
                            "RULE { ?x :a :v } WHERE { ?x :b ?y }\n"
                            "RULE { ?x :i ?y } WHERE { ?x :a ?y }\n"
                            "RULE { ?x :i ?y } WHERE { ?x :h ?y }\n";
  EXPECT_EQ(Try(rules, {{{{"x c y1"}, {}}, {}}, {{{"x c y2"}, {"x c y1"}}, {}}}), "");
}

}  // namespace
}  // namespace docent
