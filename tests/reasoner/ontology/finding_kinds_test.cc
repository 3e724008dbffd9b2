#include "reasoner/ontology/finding_kinds.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace docent::ontology {
namespace {

TEST(FindingKindsTest, EachIsThereOnceAndIsExplained) {
  const auto& kinds = FindingKinds();
  EXPECT_TRUE(std::is_sorted(kinds.begin(), kinds.end(),
                             [](const FindingKind& a, const FindingKind& b) { return a.rule < b.rule; }));
  for (size_t i = 0; i < kinds.size(); ++i) {
    const FindingKind& kind = kinds[i];
    EXPECT_TRUE(i == 0 || kinds[i - 1].rule != kind.rule) << kind.rule;
    EXPECT_TRUE(kind.meaning.ends_with(".") && kind.remedy.ends_with(".") && !kind.files.empty())
        << kind.rule;
    EXPECT_TRUE(kind.severity == "error" || kind.severity == "warning" || kind.severity == "error or warning")
        << kind.rule;
    EXPECT_TRUE(IsFindingKind(kind.rule));
  }
  EXPECT_FALSE(IsFindingKind("undefined"));
}

}  // namespace
}  // namespace docent::ontology
