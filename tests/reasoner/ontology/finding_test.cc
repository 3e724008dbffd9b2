#include "reasoner/ontology/finding.h"

#include <gtest/gtest.h>

namespace docent::ontology {
namespace {

TEST(FindingsTest, ManyWarningsHideNoError) {
  Findings findings("f", 2);
  for (int i = 0; i < 4; ++i) findings.Warning("doubtful", {}, "doubtful", "");
  findings.Error("wrong", {}, "wrong", "");
  findings.Error("wrong", {}, "wrong again", "");
  EXPECT_EQ(findings.left_out(), 3u);
  const std::vector<Finding> told = findings.Take();
  ASSERT_EQ(told.size(), 3u);
  EXPECT_EQ(std::count_if(told.begin(), told.end(), [](const Finding& one) { return one.rule == "wrong"; }),
            1);
}

}  // namespace
}  // namespace docent::ontology
