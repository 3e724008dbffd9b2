// Golden cases of tests/golden/rules: the diagnostics of a wrong rule document; the inferences of a correct
// one, turn by turn.
//
// turns.txt: one change a line in the text of TestWorld ("+ann at b1", "-ann at b1"), an empty line ends a
// turn. expected.txt: the diagnostics; or for each turn the facts that docent:inferred gained (+) and lost
// (-).
#include <gtest/gtest.h>

#include <sstream>

#include "absl/strings/str_cat.h"
#include "reasoner/rules/rule_engine.h"
#include "tests/golden/golden_file.h"
#include "tests/reasoner/test_world.h"

namespace docent {
namespace {

class RulesGolden : public testing::TestWithParam<std::string> {};

std::string Infer(rules::RuleEngine& engine, TestWorld& world, const std::string& turns) {
  std::string out;
  std::vector<std::string> add, remove, before;
  int turn = 0;
  const auto end_turn = [&] {
    if (add.empty() && remove.empty()) return;
    const absl::StatusOr<Delta> delta = engine.Update(world.writer, world.Apply(add, remove));
    add.clear();
    remove.clear();
    absl::StrAppend(&out, "turn ", ++turn, "\n");
    if (!delta.ok()) {
      absl::StrAppend(&out, std::string(delta.status().message()), "\n");
      engine.Rollback();
      world.writer.Rollback();
    } else {
      engine.Commit();
      world.writer.Freeze(Revision(static_cast<uint64_t>(turn)));
    }
    const std::vector<std::string> after = world.Inferred();
    for (const std::string& t : before) {
      if (!std::binary_search(after.begin(), after.end(), t)) absl::StrAppend(&out, "  - ", t, "\n");
    }
    for (const std::string& t : after) {
      if (!std::binary_search(before.begin(), before.end(), t)) absl::StrAppend(&out, "  + ", t, "\n");
    }
    before = after;
  };
  std::istringstream lines(turns);
  for (std::string line; std::getline(lines, line);) {
    if (line.empty()) {
      end_turn();
    } else {
      (line[0] == '+' ? add : remove).push_back(line.substr(1));
    }
  }
  end_turn();
  return out;
}

TEST_P(RulesGolden, SaysAndInfersAsExpected) {
  const std::filesystem::path folder =
      std::filesystem::path(DOCENT_SOURCE_DIR) / "tests/golden/rules" / GetParam();
  const std::string text = golden::ReadFile(folder / "input.rules");
  TestWorld world;
  Limits limits;
  limits.rule_rounds = 100;
  rules::RuleEngine engine(world.dictionary, limits);
  const Diagnostics diagnostics = engine.PutRules("input.rules", text);
  golden::Compare(folder, HasErrors(diagnostics)
                              ? Render(diagnostics, text)
                              : Infer(engine, world, golden::ReadFile(folder / "turns.txt")));
}

INSTANTIATE_TEST_SUITE_P(Cases, RulesGolden, testing::ValuesIn(golden::Cases("rules")),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace docent
