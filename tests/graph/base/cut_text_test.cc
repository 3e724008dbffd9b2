#include "graph/base/cut_text.h"

#include "gtest/gtest.h"

namespace docent {
namespace {

TEST(CutTextTest, ALongTextIsCutBetweenCharacters) {
  EXPECT_EQ(CutText("abcd", 4), "abcd");
  EXPECT_EQ(CutText("abcde", 4), "abcd… (cut, of 5 bytes)");
  EXPECT_EQ(CutText("abcäe", 4), "abc… (cut, of 6 bytes)");
  EXPECT_EQ(CutText("", 0), "");
}

TEST(CutTextTest, ALineHasNoBreaks) {
  EXPECT_EQ(OneLine("a\r\nb\x1b ä"), "a  b  ä");
}

}  // namespace
}  // namespace docent
