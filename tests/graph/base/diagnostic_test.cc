#include "graph/base/diagnostic.h"

#include <gtest/gtest.h>

namespace docent {
namespace {

TEST(DiagnosticTest, SpanCountsLinesAndCodePoints) {
  std::string text = "one\ntw\xC3\xB6 x\n";
  SourceSpan span = SpanAt(text, text.find('x'), 1);
  EXPECT_EQ(span.line, 2);
  EXPECT_EQ(span.column, 5);  // ö is one column
  EXPECT_EQ(span.offset, 9u);
  EXPECT_EQ(SpanAt(text, 1000).line, 3);  // past the end: the end
}

TEST(DiagnosticTest, RenderShowsLineCaretAndHint) {
  std::string text = "first\n\t\xC3\xA4 wrong here\nlast";
  Diagnostic diagnostic{"f.ttl", SpanAt(text, text.find("wrong"), 5), "it is wrong", "make it right"};
  EXPECT_EQ(Render({diagnostic}, text),
            "f.ttl:2:4: error: it is wrong\n"
            "  \t\xC3\xA4 wrong here\n"
            "  \t  ^\n"
            "  hint: make it right\n");
}

TEST(DiagnosticTest, RenderShowsTheNeighbourhoodOfAPlaceInALongLine) {
  std::string text = std::string(1000, 'a') + "X" + std::string(1000000, 'b');
  Diagnostic diagnostic{"", SpanAt(text, 1000, 1), "bad", ""};
  EXPECT_EQ(Render({diagnostic}, text), "1:1001: error: bad\n  …" + std::string(100, 'a') + "X" +
                                            std::string(60, 'b') + "…\n  " + std::string(101, ' ') + "^\n");
  std::string umlauts;
  for (int i = 0; i < 300; ++i) umlauts += "ä";
  diagnostic.span = SpanAt(umlauts, 400);  // code point 201
  EXPECT_NE(Render({diagnostic}, umlauts).find("\n  " + std::string(101, ' ') + "^\n"), std::string::npos);
}

TEST(DiagnosticTest, RenderWithoutSourceOrPlace) {
  Diagnostic placed{"f.ttl", {3, 7, 0, 0}, "bad", ""};
  EXPECT_EQ(Render({placed}, ""), "f.ttl:3:7: error: bad\n");
  Diagnostic warning{"", {}, "old", "", Diagnostic::Severity::kWarning};
  EXPECT_EQ(Render({warning}, ""), "warning: old\n");
}

TEST(DiagnosticTest, OnlyErrorsMakeAStatus) {
  Diagnostic warning{"", {}, "old", "", Diagnostic::Severity::kWarning};
  EXPECT_TRUE(ToStatus({warning}, "").ok());
  Diagnostic error{"", {}, "bad", ""};
  absl::Status status = ToStatus({warning, error}, "");
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_NE(status.message().find("bad"), absl::string_view::npos);
}

TEST(DiagnosticTest, NearestWord) {
  std::vector<std::string> words = {"isAt", "status", "heading"};
  EXPECT_EQ(Nearest("isat", words), "isAt");
  EXPECT_EQ(Nearest("headings", words), "heading");
  EXPECT_EQ(Nearest("colour", words), "");
  EXPECT_EQ(Nearest("Ev1", {"Eve"}), "") << "a digit is no slip for a letter";
  EXPECT_EQ(Nearest("Rogion1", {"Region1"}), "Region1");
  EXPECT_EQ(Nearest("Hall3", {"Hall03"}), "Hall03");
  EXPECT_EQ(Nearest("usr", {"user"}), "user");
}

TEST(DiagnosticTest, WhatIsNoTextIsShownAsReplacementCharacters) {
  const std::string source = "a \xFF b \xC3( \xE2\x82\xAC \xED\xA0\x80 \x1B[2J";
  Diagnostic diagnostic;
  diagnostic.span = {1, 3, 2, 1};
  diagnostic.message = "this byte is not UTF-8";
  EXPECT_EQ(Render({diagnostic}, source),
            "1:3: error: this byte is not UTF-8\n  a \uFFFD b \uFFFD( \u20AC \uFFFD\uFFFD\uFFFD \uFFFD[2J\n  "
            "  ^\n");
}

Diagnostic WithFix(std::vector<TextEdit> fix) {
  Diagnostic d;
  d.fix = std::move(fix);
  return d;
}

TEST(ApplyFixesTest, MakesThemInTheirOrder) {
  size_t applied = 0;
  EXPECT_EQ(
      ApplyFixes("one two three", {WithFix({{8, 5, "3"}}), WithFix({{0, 3, "1"}, {4, 0, "+ "}})}, &applied),
      "1 + two 3");
  EXPECT_EQ(applied, 2u);
  EXPECT_EQ(ApplyFixes("one", {WithFix({}), WithFix({{3, 0, " more"}})}, nullptr), "one more");
  EXPECT_EQ(ApplyFixes("one", {}, &applied), "one");
  EXPECT_EQ(applied, 0u);
}

TEST(ApplyFixesTest, WhatOverlapsIsLeftOutWhole) {
  size_t applied = 0;
  EXPECT_EQ(ApplyFixes("abcdef", {WithFix({{1, 3, "X"}}), WithFix({{0, 1, "Y"}, {3, 2, "Z"}})}, &applied),
            "aXef");
  EXPECT_EQ(applied, 1u);
  EXPECT_EQ(ApplyFixes("ab", {WithFix({{1, 0, "X"}}), WithFix({{1, 0, "Y"}})}, &applied), "aXb")
      << "their order would be a guess";
  EXPECT_EQ(applied, 1u);
  EXPECT_EQ(ApplyFixes("abcd", {WithFix({{0, 2, "X"}}), WithFix({{2, 2, "Y"}})}, &applied), "XY")
      << "neighbours";
}

TEST(ApplyFixesTest, OneEditOfTwoFixesIsMadeOnce) {
  size_t applied = 0;
  EXPECT_EQ(
      ApplyFixes("<a b c>", {WithFix({{2, 0, " x"}, {3, 1, "B"}}), WithFix({{2, 0, " x"}, {5, 1, "C"}})},
                 &applied),
      "<a x B C>");
  EXPECT_EQ(applied, 2u);
}

TEST(ApplyFixesTest, WhatReachesOutsideIsLeftOut) {
  size_t applied = 0;
  EXPECT_EQ(ApplyFixes("abc", {WithFix({{2, 2, "X"}}), WithFix({{4, 0, "X"}}), WithFix({{1, SIZE_MAX, "X"}})},
                       &applied),
            "abc");
  EXPECT_EQ(applied, 0u);
}

}  // namespace
}  // namespace docent
