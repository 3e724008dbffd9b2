#include "kb_server/cli/display_width.h"

#include "gtest/gtest.h"

namespace docent::server {
namespace {

TEST(DisplayWidthTest, WideCharactersTakeTwoColumnsAndMarksNone) {
  EXPECT_EQ(DisplayWidth(""), 0u);
  EXPECT_EQ(DisplayWidth("abc"), 3u);
  EXPECT_EQ(DisplayWidth("Zähler"), 6u);
  EXPECT_EQ(DisplayWidth("e\xCC\x81"), 1u);  // e and a combining acute accent
  EXPECT_EQ(DisplayWidth("展示ブース"), 10u);
  EXPECT_EQ(DisplayWidth("한글"), 4u);
  EXPECT_EQ(DisplayWidth("ﾊﾝ"), 2u);  // halfwidth
  EXPECT_EQ(DisplayWidth("🤖"), 2u);
  EXPECT_EQ(DisplayWidth("a\u200Db"), 2u);  // zero width joiner
}

TEST(DisplayWidthTest, ATextIsCutToColumns) {
  EXPECT_EQ(CutToWidth("abcdef", 6), "abcdef");
  EXPECT_EQ(CutToWidth("abcdef", 5), "abcd…");
  EXPECT_EQ(CutToWidth("abcdef", 1), "…");
  EXPECT_EQ(CutToWidth("abcdef", 0), "");
  EXPECT_EQ(CutToWidth("", 0), "");
}

TEST(DisplayWidthTest, ACutNeverSplitsAWideCharacterOrAMarkFromItsLetter) {
  EXPECT_EQ(CutToWidth("展示ブース", 10), "展示ブース");
  EXPECT_EQ(CutToWidth("展示ブース", 9), "展示ブー…");
  EXPECT_EQ(CutToWidth("展示ブース", 8), "展示ブ…");
  EXPECT_EQ(CutToWidth("ae\xCC\x81xyz", 3), "ae\xCC\x81…");
}

TEST(DisplayWidthTest, WhatIsPrintedCannotCommandATerminal) {
  EXPECT_EQ(Printable("a\nb\tc\r"), "a b c ");
  EXPECT_EQ(Printable("\x1b[31mred\x07"), "�[31mred�");
  EXPECT_EQ(Printable("\xC2\x9B"), "�");    // the one-character form of ESC [
  EXPECT_EQ(Printable("a\u202Eb"), "a�b");  // right-to-left override
  EXPECT_EQ(Printable("a\xFF"
                      "b\xC3"),
            "a�b�");  // not UTF-8
  EXPECT_EQ(Printable("Zähler 展"), "Zähler 展");
  EXPECT_EQ(Printable("a\u200Fb\u2028c\uFEFF"), "a�b�c�");
  EXPECT_EQ(Printable("\u0646\u200C\u0647"), "\u0646\u200C\u0647");  // tells letters of some scripts apart
  EXPECT_EQ(Printable("a\u200Db"), "a\uFFFDb");                      // and none of these
  EXPECT_EQ(Printable("\U0001F469\u200D\U0001F52C \u2764\uFE0F"), "\U0001F469\u200D\U0001F52C \u2764\uFE0F");
  for (const char* hidden : {"\u00AD", "\u034F", "\u180E", "\u200B", "\u2060", "\u2064", "\u3164", "\uFE00",
                             "\uFFA0", "\uFFF9", "\U0001D173", "\U000E0001", "\U000E0100"})
    EXPECT_EQ(Printable(std::string("a") + hidden + "b"), "a\uFFFDb");
  EXPECT_EQ(PrintableLines("a\n\tb\r\x1b]0;x\x07"), "a\n\tb��]0;x�");
}

TEST(DisplayWidthTest, JsonMeansTheSameAfterwards) {
  EXPECT_EQ(PrintableJson("{\"a\": \"ä\u202Eb\x7F\"}\n"), "{\"a\": \"ä\\u202eb\\u007f\"}\n");
  EXPECT_EQ(PrintableJson("\U000E0041"), "\\udb40\\udc41");
}

}  // namespace
}  // namespace docent::server
