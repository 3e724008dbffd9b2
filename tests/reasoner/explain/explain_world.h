// A TestWorld with rule sets and explanations of its facts.
#ifndef DOCENT_TESTS_REASONER_EXPLAIN_EXPLAIN_WORLD_H_
#define DOCENT_TESTS_REASONER_EXPLAIN_EXPLAIN_WORLD_H_

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "reasoner/explain/explainer.h"
#include "reasoner/explain/explanation_text.h"
#include "reasoner/rules/rule_engine.h"
#include "reasoner/rules/rule_sets.h"
#include "tests/reasoner/test_world.h"

namespace docent {

class ExplainWorld : public testing::Test, public TestWorld {
 protected:
  ExplainWorld() : engine_(dictionary) {
    prefixes_ = sparql::WellKnownPrefixes();
    prefixes_.emplace_back("", std::string(kExampleNs));
  }

  void Rules(const std::string& name, const std::string& text) {
    settings_.rules.push_back(
        {name, std::make_shared<const std::string>("PREFIX : <http://example.org/>\n" + text)});
    EXPECT_TRUE(engine_.PutRules(name, *settings_.rules.back().text).empty());
  }
  void BuiltIn(const std::string& name) { Rules(name, rules::BuiltInRuleSet(name)); }

  void Tell(const std::vector<std::string>& facts) {
    const absl::StatusOr<Delta> delta = engine_.Update(writer, Apply(facts));
    EXPECT_TRUE(delta.ok()) << delta.status();
  }

  // For the facts asserted so far.
  std::unique_ptr<explain::Explainer> Explain() {
    settings_.version = writer.Freeze(Revision(1));
    settings_.dictionary = &dictionary;
    settings_.prefixes = prefixes_;
    auto made = explain::Explainer::Make(settings_);
    EXPECT_TRUE(made.ok()) << made.status();
    return *std::move(made);
  }
  std::string Why(const std::string& ask) {
    const auto proof = Explain()->WhyAsk(Parse(ask));
    EXPECT_TRUE(proof.ok()) << proof.status();
    return proof.ok() && proof->has_value() ? explain::ToText(**proof, prefixes_) : "";
  }
  explain::WhyNotAnswer WhyNot(const std::string& ask, size_t sets = 3) {
    auto answer = Explain()->WhyNot(Parse(ask), sets);
    EXPECT_TRUE(answer.ok()) << answer.status();
    return answer.ok() ? *std::move(answer) : explain::WhyNotAnswer();
  }
  std::string WhyNotText(const std::string& ask, size_t sets = 3) {
    return explain::ToText(WhyNot(ask, sets), prefixes_);
  }

  explain::Explainer::Settings settings_;

 private:
  rules::RuleEngine engine_;
  explain::Prefixes prefixes_;
};

}  // namespace docent

#endif  // DOCENT_TESTS_REASONER_EXPLAIN_EXPLAIN_WORLD_H_
