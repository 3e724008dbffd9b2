#include "graph/base/line_diff.h"

#include <gtest/gtest.h>

namespace docent {
namespace {

TEST(LineDiff, SameTextsHaveNone) {
  EXPECT_EQ(LineDiff("", "", "a", "b"), "");
  EXPECT_EQ(LineDiff("x\ny\n", "x\ny\n", "a", "b"), "");
}

TEST(LineDiff, AChangedLineStandsInItsSurroundings) {
  EXPECT_EQ(LineDiff("1\n2\n3\n4\n5\n6\n7\n8\n9\n", "1\n2\n3\n4\nfive\n6\n7\n8\n9\n", "a", "b"),
            "--- a\n+++ b\n@@ -2,7 +2,7 @@\n 2\n 3\n 4\n-5\n+five\n 6\n 7\n 8\n");
}

TEST(LineDiff, LinesAreAddedAndTakenAway) {
  EXPECT_EQ(LineDiff("", "x\n", "a", "b"), "--- a\n+++ b\n@@ -0,0 +1 @@\n+x\n");
  EXPECT_EQ(LineDiff("x\n", "", "a", "b"), "--- a\n+++ b\n@@ -1 +0,0 @@\n-x\n");
  EXPECT_EQ(LineDiff("a\nb\nc\n", "b\nc\nd\n", "a", "b"), "--- a\n+++ b\n@@ -1,3 +1,3 @@\n-a\n b\n c\n+d\n");
}

TEST(LineDiff, ChangesThatAreFarApartAreHunksOfTheirOwn) {
  std::string before, after;
  for (int i = 1; i <= 20; ++i) {
    before += std::to_string(i) + "\n";
    after += (i == 2 || i == 19 ? "x" : std::to_string(i)) + "\n";
  }
  EXPECT_EQ(LineDiff(before, after, "a", "b"),
            "--- a\n+++ b\n@@ -1,5 +1,5 @@\n 1\n-2\n+x\n 3\n 4\n 5\n@@ -16,5 +16,5 @@\n 16\n 17\n "
            "18\n-19\n+x\n 20\n");
}

TEST(LineDiff, LongTextsAreOneChange) {
  std::string before, after;
  for (int i = 0; i < 3000; ++i) {
    before += "a" + std::to_string(i) + "\n";
    after += "b" + std::to_string(i) + "\n";
  }
  const std::string diff = LineDiff(before, after, "a", "b");
  EXPECT_EQ(diff.find("+b"), diff.find("\n+b") + 1);
  EXPECT_LT(diff.find("-a2999"), diff.find("+b0"));
}

}  // namespace
}  // namespace docent
