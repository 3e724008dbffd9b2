#include "workflow/xml/xml_document.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "absl/strings/str_cat.h"

namespace docent::xml {
namespace {

using ::testing::HasSubstr;
using ::testing::SizeIs;

std::string Bytes(std::string_view source, const SourceSpan& span) {
  return std::string(source.substr(span.offset, span.length));
}

// libxml2's own limit is 10 MB.
TEST(XmlDocument, IsAsLargeAsADocumentMayBe) {
  const std::string text(12u << 20, 'x');
  for (const std::string& source : {"<a><!--" + text + "--></a>", "<a b='" + text + "'/>",
                                    "<a>" + text + "</a>", "<a>" + text + "<b/>" + text + "</a>"}) {
    const ParsedXml parsed = ParseXml(source, "f.xml");
    EXPECT_TRUE(parsed.diagnostics.empty()) << parsed.diagnostics.front().message;
    EXPECT_TRUE(parsed.root != nullptr);
  }
  EXPECT_FALSE(ParseXml("<a>" + text + "</b>", "f.xml").diagnostics.empty());
}

TEST(XmlDocument, KnowsTheBytesOfEverything) {
  const std::string source =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!-- é --><a:root xmlns:a='urn:a'\n   x = \"1 &lt; 2\">\n"
      "  <kind  name='bö'/> text &amp; more<!-- c --> end <![CDATA[<raw>]]>\n</a:root>\n";
  ParsedXml parsed = ParseXml(source, "f.xml");
  ASSERT_TRUE(parsed.root != nullptr) << Render(parsed.diagnostics, source);
  const Element& root = *parsed.root;
  EXPECT_EQ(root.prefix, "a");
  EXPECT_EQ(root.name, "root");
  EXPECT_EQ(root.namespace_iri, "urn:a");
  EXPECT_EQ(root.name_span.line, 2);
  EXPECT_EQ(root.name_span.column, 12);  // columns count characters, not bytes
  EXPECT_EQ(Bytes(source, root.name_span), "a:root");
  ASSERT_THAT(root.attributes, SizeIs(1));
  EXPECT_EQ(root.attributes[0].value.value, "1 < 2");
  EXPECT_EQ(Bytes(source, root.attributes[0].value.span), "1 &lt; 2");
  EXPECT_EQ(root.attributes[0].value.span.line, 3);
  EXPECT_EQ(root.attributes[0].value.span.column, 9);
  ASSERT_THAT(root.children, SizeIs(1));
  EXPECT_EQ(Bytes(source, root.children[0]->span), "<kind  name='bö'/>");
  EXPECT_EQ(root.children[0]->Find("name")->value.value, "bö");
  EXPECT_EQ(root.text.value, "text & more end <raw>");
  EXPECT_EQ(Bytes(source, root.text.span).substr(0, 10), "text &amp;");
  EXPECT_EQ(source[root.text_offsets[5]], '&');
  EXPECT_EQ(Bytes(source, root.span).substr(0, 7), "<a:root");
  EXPECT_TRUE(Bytes(source, root.span).ends_with("</a:root>"));
}

TEST(XmlDocument, NamespacesFollowTheScope) {
  ParsedXml parsed =
      ParseXml("<r xmlns='urn:d' xmlns:p='urn:1'><c xmlns:p='urn:2' p:x='1'/><d p:x='2' q:y='3'/></r>", "");
  ASSERT_TRUE(parsed.root != nullptr);
  EXPECT_EQ(parsed.root->children[0]->namespace_iri, "urn:d");
  EXPECT_EQ(parsed.root->children[0]->attributes[0].namespace_iri, "urn:2");
  EXPECT_EQ(parsed.root->children[1]->attributes[0].namespace_iri, "urn:1");
  EXPECT_EQ(parsed.root->children[1]->attributes[1].namespace_iri, "");
  EXPECT_EQ(parsed.root->children[0]->namespaces->at("p"), "urn:2");
  EXPECT_EQ(parsed.root->children[1]->namespaces->at("p"), "urn:1");
}

TEST(XmlDocument, RefusesADocumentTypeDefinitionWithItsLine) {
  ParsedXml parsed = ParseXml(
      "<?xml version='1.0'?>\n<!DOCTYPE a [<!ENTITY x SYSTEM 'file:///etc/passwd'>]>\n<a>&x;</a>", "f");
  EXPECT_EQ(parsed.root, nullptr);
  ASSERT_THAT(parsed.diagnostics, SizeIs(1));
  EXPECT_EQ(parsed.diagnostics[0].span.line, 2);
  EXPECT_EQ(parsed.diagnostics[0].span.column, 1);
  EXPECT_THAT(parsed.diagnostics[0].message, HasSubstr("document type definition"));
}

TEST(XmlDocument, RefusesAnEntityReference) {
  ParsedXml parsed = ParseXml("<a>\n &bomb;</a>", "f");
  EXPECT_EQ(parsed.root, nullptr);
  ASSERT_FALSE(parsed.diagnostics.empty());
  EXPECT_EQ(parsed.diagnostics[0].span.line, 2);
  EXPECT_THAT(parsed.diagnostics[0].message, HasSubstr("bomb"));
}

TEST(XmlDocument, TellsMalformedTextWithItsPlace) {
  ParsedXml parsed = ParseXml("<a>\n  <b>\n</a>", "f");
  EXPECT_EQ(parsed.root, nullptr);
  ASSERT_FALSE(parsed.diagnostics.empty());
  EXPECT_EQ(parsed.diagnostics[0].span.line, 3);
  EXPECT_THAT(parsed.diagnostics[0].message, HasSubstr("mismatch"));
  for (std::string bad : {"", " ", "<", "<a", "<a/><b/>", "<a b=1/>", "<a b='1' b='2'/>", "<a>&#0;</a>",
                          "<a>\xff</a>", "text", "<a>]]></a>", "<a b='<'/>"}) {
    ParsedXml p = ParseXml(bad, "f");
    EXPECT_EQ(p.root, nullptr) << bad;
    EXPECT_FALSE(p.diagnostics.empty()) << bad;
  }
  EXPECT_EQ(ParseXml(std::string("<a>\0</a>", 8), "f").root, nullptr);
}

TEST(XmlDocument, OnlyUtf8) {
  EXPECT_EQ(ParseXml("<?xml version='1.0' encoding='ISO-8859-1'?><a/>", "f").root, nullptr);
  EXPECT_EQ(ParseXml("\xFF\xFE<\0a\0/\0>\0", "f").root, nullptr);
  EXPECT_NE(ParseXml("\xEF\xBB\xBF<a/>", "f").root, nullptr);
}

TEST(XmlDocument, LimitsOnSizeAndNesting) {
  Limits limits;
  limits.xml_nesting = 8;
  auto nested = [](int depth) {
    std::string text;
    for (int i = 0; i < depth; ++i) text += "<a>";
    for (int i = 0; i < depth; ++i) text += "</a>";
    return text;
  };
  EXPECT_NE(ParseXml(nested(8), "f", limits).root, nullptr);
  ParsedXml deep = ParseXml(nested(9), "f", limits);
  EXPECT_EQ(deep.root, nullptr);
  ASSERT_THAT(deep.diagnostics, SizeIs(1));
  EXPECT_THAT(deep.diagnostics[0].message, HasSubstr("xml_nesting = 8"));
  EXPECT_EQ(deep.diagnostics[0].span.offset, 24u);
  limits.xml_elements = 3;
  EXPECT_NE(ParseXml("<a><b/><b/></a>", "f", limits).root, nullptr);
  EXPECT_THAT(ParseXml("<a><b/><b/><b/></a>", "f", limits).diagnostics[0].message,
              HasSubstr("xml_elements = 3"));
  std::string text = "<a/>";
  limits.document_bytes = text.size();
  EXPECT_NE(ParseXml(text, "f", limits).root, nullptr);
  EXPECT_THAT(ParseXml(text + " ", "f", limits).diagnostics[0].message, HasSubstr("document_bytes = 4"));
}

TEST(XmlDocument, LimitsOnAttributesAndNamespaces) {
  auto with = [](int attributes, const std::string& before = "") {
    std::string text = "<!-- <a ' --><?p \" ?><r>" + before + "<a";
    for (int i = 0; i < attributes; ++i) absl::StrAppend(&text, " x", i, "='>'");
    return text + "/></r>";
  };
  EXPECT_NE(ParseXml(with(256), "f").root, nullptr);
  EXPECT_THAT(ParseXml(with(257), "f").diagnostics[0].message, HasSubstr("more than 256 attributes"));
  EXPECT_THAT(ParseXml(with(257, "it's <![CDATA[<a b=\"]]>"), "f").diagnostics[0].message,
              HasSubstr("256 attributes"));
  auto declarations = [](int count) {
    std::string text = "<r>";
    for (int i = 0; i < count; ++i) absl::StrAppend(&text, "<a xmlns:p", i, "='urn:x'/>");
    return text + "</r>";
  };
  EXPECT_NE(ParseXml(declarations(1000), "f").root, nullptr);
  EXPECT_THAT(ParseXml(declarations(1001), "f").diagnostics[0].message,
              HasSubstr("namespace declarations than 1000"));
}

TEST(XmlDocument, Durations) {
  int64_t ms = 0;
  EXPECT_TRUE(ParseDurationMs("30s", &ms));
  EXPECT_EQ(ms, 30000);
  EXPECT_TRUE(ParseDurationMs(" 1.5 h ", &ms));
  EXPECT_EQ(ms, 5400000);
  EXPECT_TRUE(ParseDurationMs("500ms", &ms));
  EXPECT_EQ(ms, 500);
  EXPECT_TRUE(ParseDurationMs("5min", &ms));
  EXPECT_EQ(ms, 300000);
  for (const char* bad : {"", "30", "s", "-1s", "0s", "1e9h", "721h", "30 sec", "1..2s"}) {
    EXPECT_FALSE(ParseDurationMs(bad, &ms)) << bad;
  }
}

}  // namespace
}  // namespace docent::xml
