// Our scanner against libxml2's own tree: the same elements, attributes and text for every accepted text.
#include <gtest/gtest.h>
#include <libxml/parser.h>
#include <libxml/tree.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>

#include "tests/fuzz/mutator.h"
#include "workflow/xml/xml_document.h"

namespace docent::xml {
namespace {

std::string Text(const xmlChar* text) {
  return text == nullptr ? "" : reinterpret_cast<const char*>(text);
}

std::string Trim(const std::string& text) {
  size_t first = text.find_first_not_of(" \t\n\r");
  if (first == std::string::npos) return "";
  return text.substr(first, text.find_last_not_of(" \t\n\r") - first + 1);
}

std::string NameOf(const std::string& prefix, const std::string& name) {
  return prefix.empty() ? name : prefix + ":" + name;
}
// libxml2 keeps a prefix that is not declared in the name.
std::string NameOf(const xmlNs* ns, const xmlChar* name) {
  return NameOf(ns == nullptr ? "" : Text(ns->prefix), Text(name));
}

std::string Dump(const Element& element) {
  std::string out = "<" + NameOf(element.prefix, element.name) + "|" + element.namespace_iri;
  for (const Attribute& a : element.attributes) {
    out += " " + NameOf(a.prefix, a.name) + "|" + a.namespace_iri + "=[" + a.value.value + "]";
  }
  out += ">[" + element.text.value + "]";
  for (const auto& child : element.children) out += Dump(*child);
  return out + "</>";
}

std::string Dump(const xmlNode* node) {
  std::string out =
      "<" + NameOf(node->ns, node->name) + "|" + (node->ns == nullptr ? "" : Text(node->ns->href));
  for (const xmlAttr* a = node->properties; a != nullptr; a = a->next) {
    std::string value;
    for (const xmlNode* part = a->children; part != nullptr; part = part->next) value += Text(part->content);
    out +=
        " " + NameOf(a->ns, a->name) + "|" + (a->ns == nullptr ? "" : Text(a->ns->href)) + "=[" + value + "]";
  }
  std::string text, children;
  for (const xmlNode* child = node->children; child != nullptr; child = child->next) {
    if (child->type == XML_TEXT_NODE || child->type == XML_CDATA_SECTION_NODE) text += Text(child->content);
    if (child->type == XML_ELEMENT_NODE) children += Dump(child);
  }
  return out + ">[" + Trim(text) + "]" + children + "</>";
}

// Checks that elements, attributes and texts are where their spans point.
void CheckSpans(const Element& element, const std::string& source) {
  auto bytes = [&](const SourceSpan& span) { return source.substr(span.offset, span.length); };
  ASSERT_EQ(bytes(element.name_span), NameOf(element.prefix, element.name));
  ASSERT_TRUE(bytes(element.span).starts_with("<"));
  ASSERT_TRUE(bytes(element.span).ends_with(">"));
  ASSERT_EQ(element.text_offsets.size(), element.text.value.size());
  for (const Attribute& a : element.attributes) {
    ASSERT_EQ(bytes(a.name_span), NameOf(a.prefix, a.name));
    char quote = source[a.value.span.offset - 1];
    ASSERT_TRUE(quote == '"' || quote == '\'');
    ASSERT_EQ(source[a.value.span.offset + a.value.span.length], quote);
  }
  for (const auto& child : element.children) CheckSpans(*child, source);
}

TEST(Scanner, AgreesWithLibxml2OnMutatedDocuments) {
  namespace fs = std::filesystem;
  std::vector<std::string> corpus = {
      "<a xmlns='u' xmlns:b=\"v\" b:c='&lt;&#65;' d=\"\n'\">t<b:e/> &amp;<![CDATA[<x>&]]><!-- c --><?p "
      "i?>u</a>"};
  for (const auto& entry :
       fs::recursive_directory_iterator(fs::path(DOCENT_SOURCE_DIR) / "tests/golden/cawl")) {
    if (entry.path().filename() != "input.xml") continue;
    std::ifstream in(entry.path(), std::ios::binary);
    corpus.emplace_back(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
  }
  fuzz::Mutator mutator(
      7, corpus,
      {" x='1'", "<e>", "</e>", "<e/>", "&lt;", "&#x1F600;", "&#13;", "\r\n", "\r", "<![CDATA[", "]]>",
       "<!--", "-->", "<?x y?>", " xmlns=''", " xmlns:p='urn:p'", "p:", "é", "\t"});
  int accepted = 0;
  for (int i = 0; i < 20000; ++i) {
    std::string text = i < static_cast<int>(corpus.size()) ? corpus[i] : mutator.Next();
    ParsedXml ours = ParseXml(text, "f");
    if (ours.root == nullptr) {
      ASSERT_FALSE(ours.diagnostics.empty()) << text;
      ASSERT_EQ(ours.diagnostics[0].message.find("not understood"), std::string::npos) << text;
      continue;
    }
    ++accepted;
    std::unique_ptr<xmlDoc, void (*)(xmlDocPtr)> theirs(
        xmlReadMemory(text.data(), static_cast<int>(text.size()), nullptr, "UTF-8",
                      XML_PARSE_NONET | XML_PARSE_NOERROR | XML_PARSE_NOWARNING),
        xmlFreeDoc);
    ASSERT_NE(theirs, nullptr) << text;
    ASSERT_EQ(Dump(*ours.root), Dump(xmlDocGetRootElement(theirs.get()))) << text;
    CheckSpans(*ours.root, text);
    if (HasFatalFailure()) FAIL() << text;
  }
  EXPECT_GT(accepted, 500);
  std::printf("%d of 20000 texts accepted\n", accepted);
}

}  // namespace
}  // namespace docent::xml
