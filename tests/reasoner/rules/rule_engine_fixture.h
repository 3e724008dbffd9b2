// A rule engine over a small world, turn by turn, for the tests of this folder.
#ifndef DOCENT_TESTS_REASONER_RULES_RULE_ENGINE_FIXTURE_H_
#define DOCENT_TESTS_REASONER_RULES_RULE_ENGINE_FIXTURE_H_

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "reasoner/rules/rule_engine.h"
#include "tests/reasoner/test_world.h"

namespace docent::rules {

class RuleEngineTest : public ::testing::Test {
 protected:
  void Put(const std::string& text, const std::string& name = "test.rules") {
    const std::string document = "PREFIX : <http://example.org/>\n" + text;
    const Diagnostics diagnostics = engine_.PutRules(name, document);
    ASSERT_THAT(diagnostics, ::testing::IsEmpty()) << Render(diagnostics, document);
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

}  // namespace docent::rules

#endif  // DOCENT_TESTS_REASONER_RULES_RULE_ENGINE_FIXTURE_H_
