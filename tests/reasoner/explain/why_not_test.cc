// Why-not: what a person would name comes first, and what is named is enough.
#include <algorithm>
#include <string>
#include <vector>

#include "absl/strings/str_join.h"
#include "gmock/gmock.h"
#include "tests/reasoner/explain/explain_world.h"

namespace docent {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

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
  EXPECT_THAT(WhyNotText("ASK { :r1 a :Free ; :goes ?t }"),
              AllOf(HasSubstr("missing     :r1 :goes ?t"), HasSubstr("(there must be no { :r1 :task ?t2 })")));
}

TEST_F(WhyNotTest, WhatMustNotBeOfAnOpenVariableIsAConditionOnIt) {
  // with :c1 or :c2 for ?b, following the answer would not make it true
  Tell({"c1 edge c2", "c2 edge c1"});
  const std::string ask = "ASK { :c3 :edge ?b FILTER NOT EXISTS { ?b :edge ?c } }";
  const explain::WhyNotAnswer answer = WhyNot(ask, 9);
  ASSERT_EQ(answer.repairs.size(), 1u);
  EXPECT_THAT(answer.repairs[0].conditions, ElementsAre("there is no { ?b :edge ?c }"));
  EXPECT_THAT(WhyNotText(ask), HasSubstr("  missing     :c3 :edge ?b\n  where       there is no { ?b :edge ?c }\n"));
}

TEST_F(WhyNotTest, WhatMustNotBeIsAskedForOnceWhateverItsAlternatives) {
  Tell({"p1 a Place"});
  EXPECT_THAT(WhyNot("ASK { :r1 :at ?p MINUS { { ?p :taken ?by } UNION { ?p a :Closed } } }").repairs[0].conditions,
              ElementsAre("there is no { { ?p :taken ?by . } UNION { ?p a :Closed . } }"));
}

TEST_F(WhyNotTest, WhatARuleForbidsOfAnOpenVariableIsSaidInTheQuestionsNames) {
  Rules("free.rules", "RULE { ?r a :Free } WHERE { ?r a :Robot FILTER NOT EXISTS { ?r :task ?t } }");
  const explain::WhyNotAnswer answer = WhyNot("ASK { ?t a :Free ; :at :Hall }", 9);
  ASSERT_EQ(answer.repairs.size(), 1u);
  EXPECT_THAT(answer.repairs[0].conditions, ElementsAre("there is no { ?t :task ?t2 }"));
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
  // who asks for it is told
  EXPECT_EQ(WhyNot("ASK { :p a :Impossible }").repairs.size(), 1u);
}

class WhyNotOwl : public ExplainWorld {
 protected:
  WhyNotOwl() { BuiltIn("owl2rl"); }

  // The first set of what is missing, a fact a line, sorted.
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
  // one axiom about servesAt would do it, too: its domain, a superclass of Machine, that R1 is R2
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

TEST_F(WhyNotOwl, AnAxiomThatTheQuestionAsksForIsNamed) {
  EXPECT_EQ(Missing({"R1 a Guide"}, "ASK { :R1 a ?c . ?c rdfs:subClassOf :Robot }"),
            "Guide http://www.w3.org/2000/01/rdf-schema#subClassOf Robot\n");
}

}  // namespace
}  // namespace docent
