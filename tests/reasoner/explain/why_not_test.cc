// Why-not beside the rules of OWL: what a person would name comes first.
#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "reasoner/explain/explainer.h"
#include "reasoner/rules/rule_engine.h"
#include "reasoner/rules/rule_sets.h"
#include "tests/reasoner/test_world.h"

namespace docent {
namespace {

class WhyNotOwl : public testing::Test {
 protected:
  // The first set of what is missing, a fact a line, sorted.
  std::string Missing(const std::vector<std::string>& told, const std::string& ask) {
    const auto text = std::make_shared<const std::string>(BuiltInRuleSet("owl2rl"));
    RuleEngine rules(world_.dictionary);
    EXPECT_TRUE(rules.PutRules("owl2rl", *text).empty());
    EXPECT_TRUE(rules.Update(world_.writer, world_.Apply(told)).ok());
    explain::Explainer::Settings settings;
    settings.version = world_.writer.Freeze(Revision(1));
    settings.dictionary = &world_.dictionary;
    settings.rules = {{"owl2rl", text}};
    auto explainer = explain::Explainer::Make(settings);
    EXPECT_TRUE(explainer.ok()) << explainer.status();
    const auto answer = (*explainer)->WhyNot(world_.Parse(ask), 3);
    EXPECT_TRUE(answer.ok()) << answer.status();
    if (!answer.ok() || answer->repairs.empty()) return "";
    std::vector<std::string> facts;
    for (const explain::ToTell& tell : answer->repairs[0].tell) {
      const auto word = [&](const Term& term) { return world_.Text(world_.dictionary.Intern(term)); };
      facts.push_back(word(tell.example.subject) + " " + word(tell.example.predicate) + " " +
                      word(tell.example.object) + "\n");
    }
    std::sort(facts.begin(), facts.end());
    std::string all;
    for (const std::string& fact : facts) all += fact;
    return all;
  }

  TestWorld world_;
};

TEST_F(WhyNotOwl, AFactAboutTheThingComesBeforeAnAxiom) {
  // one axiom about servesAt would do it, too: its domain, a superclass of Machine, that R1 is R2
  EXPECT_EQ(Missing({"R1 servesAt B1", "R1 a Machine", "R2 a Robot"}, "ASK { :R1 a :Robot }"),
            "R1 a Robot\n");
  EXPECT_EQ(Missing({"R1 knows B1", "R2 isAt B1"}, "ASK { :R1 :isAt :B1 }"), "R1 isAt B1\n");
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
