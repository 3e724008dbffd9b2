#include "workflow/xml/formatter.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "tests/workflow/xml/same_document.h"

namespace docent::xml {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

std::string Formatted(const std::string& text) {
  const FormattedXml out = FormatXml(text, "f");
  EXPECT_TRUE(out.ok()) << Render(out.diagnostics, text);
  EXPECT_EQ(FormatXml(out.text, "f").text, out.text) << "formatting twice changes something";
  EXPECT_EQ(Content(out.text), Content(text));
  return out.text;
}

TEST(Formatter, IndentsWhatStandsOverSeveralLines) {
  EXPECT_EQ(Formatted("<?xml version='1.0'?><a  x = \"1\"   y='2' >\n<b />\n      <c><d\n/></c></a>"),
            "<?xml version='1.0'?>\n<a x=\"1\" y='2'>\n  <b/>\n  <c>\n    <d/>\n  </c>\n</a>\n");
}

TEST(Formatter, WhatStandsOnOneLineStaysThereWhileItFits) {
  EXPECT_EQ(Formatted("<a>\n<b> <c x='1'/> <d>text</d> </b></a>"),
            "<a>\n  <b><c x='1'/><d>text</d></b>\n</a>\n");
  const std::string word(49, 'w');
  EXPECT_EQ(Formatted("<a><b>" + word + "</b><c>" + word + "</c></a>"),
            "<a><b>" + word + "</b><c>" + word + "</c></a>\n");
  EXPECT_EQ(Formatted("<a><b>" + word + "</b><c>" + word + word + "</c></a>"),
            "<a>\n  <b>" + word + "</b>\n  <c>" + word + word + "</c>\n</a>\n");
}

TEST(Formatter, LinesAreAsLongAsTheyMayBe) {
  const std::string fits(kFormatWidth - std::string("<a><b></b></a>").size(), 'w');
  EXPECT_EQ(Formatted("<a><b>" + fits + "</b></a>"), "<a><b>" + fits + "</b></a>\n");
  EXPECT_EQ(Formatted("<a><b>" + fits + "w</b></a>"), "<a>\n  <b>" + fits + "w</b>\n</a>\n");
  const std::string value(kFormatWidth - std::string("<a x='1' y=''/>").size(), 'v');
  EXPECT_EQ(Formatted("<a x='1' y='" + value + "'/>"), "<a x='1' y='" + value + "'/>\n");
  EXPECT_EQ(Formatted("<a x='1' y='" + value + "v'/>"), "<a x='1'\n   y='" + value + "v'/>\n");
}

TEST(Formatter, LineEndsBetweenAttributesStayWhereTheyWere) {
  EXPECT_EQ(
      Formatted(
          "<CAWL name='T' version='1'\n xmlns:a='urn:a'   xmlns:b='urn:b'\n\n  xmlns:c='urn:c'\n>\n</CAWL>"),
      "<CAWL name='T' version='1'\n      xmlns:a='urn:a' xmlns:b='urn:b'\n      xmlns:c='urn:c'></CAWL>\n");
}

TEST(Formatter, OneEmptyLineMayStandBetweenPieces) {
  EXPECT_EQ(Formatted("\n<!-- top -->\n\n\n<a>\n\n\n<b/>\n\n\n<c/>\n\n</a>\n\n\n"),
            "<!-- top -->\n\n<a>\n\n  <b/>\n\n  <c/>\n</a>\n");
}

TEST(Formatter, CommentsStayBehindWhatTheyStandBehind) {
  EXPECT_EQ(Formatted("<a><!-- of a -->\n<b/>   <!-- of b -->\n   <!-- of\n c --><c/>\n<?pi x?></a>"),
            "<a> <!-- of a -->\n  <b/> <!-- of b -->\n  <!-- of\n c -->\n  <c/>\n  <?pi x?>\n</a>\n");
}

TEST(Formatter, TextAndReferencesAreKept) {
  const char* kept[] = {"<a>\n  <b> &lt; 1 &#10; x</b>\n</a>\n",   "<a>\n  <b>\n two\n lines </b>\n</a>\n",
                        "<a>\n  <b><![CDATA[ <x> ]]></b>\n</a>\n", "<a>\n  <b>?x<!-- c --></b>\n</a>\n",
                        "<a>\n  <b x='&quot;\n &lt; 2'/>\n</a>\n", "<a>\n  <b>&#32;</b>\n</a>\n"};
  for (const char* text : kept) EXPECT_EQ(Formatted(text), text);
}

TEST(Formatter, DocumentationAndForeignElementsAreLeftAsWritten) {
  const char* kept[] = {"<a>\n  <documentation  lang='en'>\n <p> a  b </p> </documentation>\n</a>\n",
                        "<a xmlns:l='urn:l'>\n  <l:box   x='1'>\n <l:in/>   </l:box>\n</a>\n",
                        "<a>\n  <b xml:space='preserve'> <c/>  <d/> </b>\n</a>\n",
                        "<a>\n  <b>text  <c/>  more</b>\n</a>\n"};
  for (const char* text : kept) EXPECT_EQ(Formatted(text), text);
  EXPECT_EQ(Formatted("<l:a xmlns:l='urn:l'>\n<l:b   x='1'/>\n</l:a>"),
            "<l:a xmlns:l='urn:l'>\n  <l:b x='1'/>\n</l:a>\n")
      << "the root element's namespace is the document's own";
}

TEST(Formatter, LineEndsAndByteOrderMarkAreThoseOfTheFile) {
  EXPECT_EQ(Formatted("\xEF\xBB\xBF<a>\r\n<b/>\r\n</a>"), "\xEF\xBB\xBF<a>\r\n  <b/>\r\n</a>\r\n");
}

TEST(Formatter, WidthCountsCharacters) {
  std::string umlauts;
  for (int i = 0; i < 100; ++i) umlauts += "ö";
  EXPECT_EQ(Formatted("<a><b>" + umlauts + "</b></a>"), "<a><b>" + umlauts + "</b></a>\n");
}

TEST(Formatter, WhatIsNotWellFormedIsToldAndNotFormatted) {
  const FormattedXml out = FormatXml("<a>\n<b></a>", "f");
  EXPECT_FALSE(out.ok());
  EXPECT_EQ(out.text, "");
  EXPECT_THAT(out.diagnostics[0].message, StartsWith("XML:"));
  EXPECT_THAT(FormatXml("<!DOCTYPE a><a/>", "f").diagnostics[0].message,
              HasSubstr("document type definition"));
}

// Random documents: nested elements with blanks, comments, instructions, texts and foreign elements anywhere.
class RandomDocument {
 public:
  explicit RandomDocument(uint32_t seed) : random_(seed) {}

  std::string Make() {
    std::string out = Pick({"", "<?xml version='1.0'?>", "\xEF\xBB\xBF<?xml version=\"1.0\"?>\r\n"});
    Misc(&out);
    Element(0, &out);
    Misc(&out);
    return out;
  }

 private:
  size_t Below(size_t limit) { return random_() % limit; }
  std::string Pick(const std::vector<std::string>& from) { return from[Below(from.size())]; }
  std::string Blank() { return Pick({"", "", " ", "\n", "\n\n\n", "\r\n", "\t ", "  \n  ", "\r"}); }
  std::string Name() { return Pick({"flow", "node", "l:box", "documentation", "subject", "x:y", "b"}); }

  void Misc(std::string* out) {
    for (size_t i = Below(3); i > 0; --i) {
      *out += Blank() + Pick({"<!-- c -->", "<!--a\n  b-->", "<?pi <a> ?>"});
      *out += Blank();
    }
  }

  void Element(size_t depth, std::string* out) {
    const std::string name = depth == 0 ? "CAWL" : Name();
    *out += "<" + name;
    if (depth == 0) *out += " xmlns:l='urn:l' xmlns:x=\"https://w3id.org/docent/expo#\"";
    const char* attributes[] = {"name", "l:x", "xml:space", "operation", "ext"};
    for (const char* attribute : attributes) {
      if (Below(4) != 0) continue;
      *out += Pick({" ", "\n", "  ", "\n\n   ", "\r\n"}) + attribute + Pick({"=", " = ", "\n="});
      *out +=
          Pick({"'1'", "\"a > b\"", "'&lt;\n\"'", "\"preserve\"", "'" + std::string(Below(150), 'w') + "'"});
    }
    *out += Pick({"", " ", "\n"});
    if (Below(4) == 0) {
      *out += "/>";
      return;
    }
    *out += ">";
    for (size_t i = Below(depth < 5 ? 6 : 2); i > 0; --i) {
      *out += Blank();
      switch (Below(depth < 5 ? 6 : 4)) {
        case 0:
          *out += Pick({"text", "&amp;", " &#32; ", "a\nb", "ö"});
          break;
        case 1:
          *out += Pick({"<![CDATA[ x ]]>", "<!-- c -->", "<!--\n-->"});
          break;
        case 2:
          *out += Pick({"<?pi?>", "<!-- - -->"});
          break;
        case 3:
          break;
        default:
          Element(depth + 1, out);
      }
    }
    *out += Blank() + "</" + name + Pick({">", " >", "\n>"});
  }

  std::mt19937 random_;
};

TEST(Formatter, RandomDocumentsStayTheSameDocuments) {
  for (uint32_t seed = 1; seed <= 3000; ++seed) {
    const std::string text = RandomDocument(seed).Make();
    ASSERT_NE(Content(text), "not well-formed") << "seed " << seed << "\n" << text;
    const FormattedXml once = FormatXml(text, "f");
    ASSERT_TRUE(once.ok()) << "seed " << seed;
    ASSERT_EQ(Content(once.text), Content(text)) << "seed " << seed << "\n"
                                                 << text << "\n-- became\n"
                                                 << once.text;
    ASSERT_EQ(FormatXml(once.text, "f").text, once.text) << "seed " << seed << "\n" << text;
  }
}

}  // namespace
}  // namespace docent::xml
