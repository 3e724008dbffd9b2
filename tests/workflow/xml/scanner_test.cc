#include "workflow/xml/scanner.h"

#include <gtest/gtest.h>

namespace docent::xml {
namespace {

TEST(LineIndex, AgreesWithSpanAt) {
  std::string text = "a\nbé\r\n\n日本 x\n";
  for (int i = 0; i < 300; ++i) text += "é日";
  text += "\n" + std::string(1024 - text.size() % 256, 'x');
  LineIndex index(text);
  for (size_t offset = 0; offset <= text.size(); ++offset) {
    SourceSpan expected = SpanAt(text, offset, 1), actual = index.Span(offset, 1);
    EXPECT_EQ(actual.line, expected.line) << offset;
    EXPECT_EQ(actual.column, expected.column) << offset;
  }
}

TEST(Scanner, EndsQuietlyOnWhatIsNotXml) {
  const std::string whole =
      "<?p q?><!-- c --><a b='1&#x41;' xmlns:n=\"u\"><n:c/>t&lt;<![CDATA[d]]></a ><!--e-->";
  ASSERT_NE(ScanXml(whole), nullptr);
  for (size_t length = 0; length < whole.size() - 9; ++length) {
    EXPECT_EQ(ScanXml(std::string_view(whole).substr(0, length)), nullptr) << length;
  }
  for (const char* bad :
       {"<a>&unknown;</a>", "<a>&#x110000;</a>", "<a>&#;</a>", "<a></b>", "<a b></a>", "<a/>x"}) {
    EXPECT_EQ(ScanXml(bad), nullptr) << bad;
  }
}

TEST(Scanner, LineEndsAreOneLineFeed) {
  auto root = ScanXml("<a b='1\r\n2\t3'>x\r\ny\rz<![CDATA[\r\nq]]></a>");
  ASSERT_NE(root, nullptr);
  EXPECT_EQ(root->attributes[0].value.value, "1 2 3");
  EXPECT_EQ(root->text.value, "x\ny\nz\nq");
}

}  // namespace
}  // namespace docent::xml
