#include "graph/wire/text_cut.h"

#include <gtest/gtest.h>

#include <string>

#include "docent/v1/workflows.pb.h"

namespace docent {
namespace {

TEST(TextCutTest, EveryTextOfAMessageIsCut) {
  v1::Run run;
  run.set_reason(std::string(100, 'r'));
  run.set_workflow("W");
  run.add_variables()->mutable_value()->mutable_literal()->set_lexical(std::string(100, 'v'));
  run.add_nodes()->add_invocations()->set_reason(std::string(100, 'i'));
  ASSERT_TRUE(CutTexts(&run, 10));
  EXPECT_EQ(run.reason(), "rrrrrrrrrr… (cut, of 100 bytes)");
  EXPECT_EQ(run.variables(0).value().literal().lexical(), "vvvvvvvvvv… (cut, of 100 bytes)");
  EXPECT_EQ(run.nodes(0).invocations(0).reason(), "iiiiiiiiii… (cut, of 100 bytes)");
  EXPECT_EQ(run.workflow(), "W");
  EXPECT_FALSE(CutTexts(&run, 100));
}

TEST(TextCutTest, AMessageThatDoesNotFitIsCutMore) {
  v1::Run run;
  for (int i = 0; i < 100; ++i) run.add_nodes()->set_reason(std::string(1000, 'r'));
  v1::Run whole = run;
  EXPECT_FALSE(CutToFit(&whole, 1000, 200000));
  EXPECT_EQ(whole.nodes(0).reason().size(), 1000u);
  EXPECT_TRUE(CutToFit(&run, 1000, 50000));
  EXPECT_LE(run.ByteSizeLong(), 50000u);
  EXPECT_TRUE(run.nodes(99).reason().starts_with("rrr"));
}

}  // namespace
}  // namespace docent
