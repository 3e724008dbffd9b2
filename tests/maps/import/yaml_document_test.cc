// YAML with places: what is read, and what is refused with its place.
#include "maps/import/yaml_document.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace docent::maps {
namespace {

using testing::HasSubstr;

std::optional<YamlValue> Parse(const std::string& text, std::string* said = nullptr, MapLimits limits = {}) {
  Diagnostics diagnostics;
  std::optional<YamlValue> document = ParseYaml(text, "f.yaml", &diagnostics, limits);
  EXPECT_EQ(document.has_value(), diagnostics.empty());
  if (said != nullptr) *said = Render(diagnostics, text);
  return document;
}

std::string Said(const std::string& text, MapLimits limits = {}) {
  std::string said;
  EXPECT_FALSE(Parse(text, &said, limits).has_value()) << text;
  return said;
}

TEST(YamlDocumentTest, KeepsValuesWithTheirPlaces) {
  const auto document =
      Parse("image: floor.pgm\norigin: [-1.5, 2, 0]\nnodes:\n  - name: 'A b'\n    edges: {}\n");
  ASSERT_TRUE(document);
  EXPECT_EQ(document->Find("image")->text, "floor.pgm");
  EXPECT_EQ(document->Find("image")->span.line, 1);
  EXPECT_EQ(document->Find("image")->span.column, 8);
  const YamlValue* origin = document->Find("origin");
  ASSERT_TRUE(origin->IsList());
  EXPECT_EQ(origin->items[1].text, "2");
  EXPECT_EQ(origin->items[1].span.column, 16);
  const YamlValue* node = &document->Find("nodes")->items[0];
  EXPECT_EQ(node->Find("name")->text, "A b");
  EXPECT_TRUE(node->Find("edges")->IsMap());
  EXPECT_EQ(node->Find("other"), nullptr);
  EXPECT_EQ(origin->Find("x"), nullptr);
}

// They are counted on from value to value.
TEST(YamlDocumentTest, PlacesAreThoseOfTheWholeText) {
  const std::string text =
      "ä: [ö, 'é', [ü, {a: b, 展: ブ}], 1]\nb:\n  - x\n  - ñ: [1,\n 2, 3]\n    z: \"ß\"\nlast: [a, b, c]\n";
  const auto document = Parse(text);
  ASSERT_TRUE(document);
  size_t values = 0;
  const auto check = [&](const auto& self, const YamlValue& value) -> void {
    const SourceSpan expected = SpanAt(text, value.span.offset, value.span.length);
    EXPECT_EQ(value.span.line, expected.line) << value.text;
    EXPECT_EQ(value.span.column, expected.column) << value.text;
    ++values;
    for (const YamlValue& item : value.items) self(self, item);
  };
  check(check, *document);
  EXPECT_EQ(values, 22u);
}

TEST(YamlDocumentTest, RefusesWithThePlace) {
  EXPECT_THAT(Said("a:\n\t- 1\n"), HasSubstr("f.yaml:2:1: error: a tab stands in the indentation"));
  EXPECT_THAT(Said("a:\n\tb: 1\n"), HasSubstr("tab"));
  EXPECT_THAT(Said("a: &x 1\nb: 2\n"),
              HasSubstr("f.yaml:1:4: error: anchors (&) and aliases (*) are not read"));
  EXPECT_THAT(Said("a: [1, *x]\n"), HasSubstr("f.yaml:1:8: error"));
  EXPECT_THAT(Said("a: 1\nb: 2\na: 3\n"), HasSubstr("f.yaml:3:1: error: the key a stands twice"));
  EXPECT_THAT(Said("a: [1, 2\n"), HasSubstr("no YAML"));
  EXPECT_THAT(Said("? [1, 2]\n: 3\n"), HasSubstr("a key that is no text"));
  EXPECT_THAT(Said(""), HasSubstr("the file is empty"));
}

TEST(YamlDocumentTest, AliasesThatGrowWithoutEndAreRefusedAtTheFirst) {
  EXPECT_THAT(Said("a: &a [x, x]\nb: &b [*a, *a]\nc: &c [*b, *b]\n"), HasSubstr("f.yaml:1:4"));
}

TEST(YamlDocumentTest, LimitsHold) {
  MapLimits limits;
  limits.map_yaml_nesting = 3;
  EXPECT_TRUE(Parse("[[[1]]]", nullptr, limits));
  EXPECT_THAT(Said("[[[[1]]]]", limits), HasSubstr("the limit map_yaml_nesting is 3"));
  EXPECT_THAT(Said(std::string(100000, '[')), HasSubstr("error"));
  EXPECT_THAT(Said(std::string(100000, '{')), HasSubstr("error"));
  limits.map_yaml_values = 4;
  EXPECT_TRUE(Parse("[1, 2, 3]", nullptr, limits));
  EXPECT_THAT(Said("[1, 2, 3, 4]", limits), HasSubstr("the limit map_yaml_values is 4"));
  limits.map_yaml_bytes = 9;
  EXPECT_TRUE(Parse("[1, 2, 3]", nullptr, limits));
  EXPECT_THAT(Said("[1, 2, 3] ", limits), HasSubstr("the limit map_yaml_bytes is 9"));
}

TEST(YamlFieldsTest, NumbersAreFinite) {
  Diagnostics diagnostics;
  YamlFields fields("f", &diagnostics);
  const auto document = Parse("[1.5, nan, .inf, x, [], -3.4e-18, 2, 7, -1]");
  ASSERT_TRUE(document);
  EXPECT_EQ(fields.Number(document->items[0], "n"), 1.5);
  for (const size_t bad : {1, 2, 3, 4}) EXPECT_EQ(fields.Number(document->items[bad], "n"), std::nullopt);
  EXPECT_TRUE(fields.Number(document->items[5], "n").has_value());
  EXPECT_EQ(diagnostics.size(), 4u);
  EXPECT_EQ(fields.Index(document->items[6], "vertex", 3), 2u);
  for (const size_t bad : {0, 7, 8}) EXPECT_EQ(fields.Index(document->items[bad], "vertex", 3), std::nullopt);
}

}  // namespace
}  // namespace docent::maps
