#include "graph/store/bulk_loader.h"

#include <gtest/gtest.h>

#include "graph/rdf/vocabulary.h"

namespace docent {
namespace {

TEST(BulkLoader, LinesAndTurtleGiveTheSameGraph) {
  const std::string lines =
      "<urn:a> <urn:p> \"caf\\u00E9\"@fr .\n"
      "<urn:a> <urn:p> <urn:b> .  # again below\n\n"
      "_:x <urn:q> \"1\"^^<http://www.w3.org/2001/XMLSchema#integer> .\n"
      "<urn:a> <urn:p> <urn:b> .\n";
  Dictionary dictionary;
  GraphWriter from_lines(nullptr), from_turtle(nullptr);
  BulkLoader loader(dictionary);
  EXPECT_TRUE(loader.Add(lines, RdfFormat::kNTriples, {}).empty());
  EXPECT_EQ(loader.size(), 4u);
  loader.Build(from_lines);
  EXPECT_TRUE(loader.Add(lines, RdfFormat::kTurtle, {}).empty());
  loader.Build(from_turtle);
  EXPECT_EQ(from_lines.current().size(), 3u);
  from_lines.current().ForEach({}, [&](const Quad& quad) {
    EXPECT_TRUE(from_turtle.current().Contains(quad));
    EXPECT_EQ(dictionary.Decode(quad.graph).lexical, kDefaultGraph);
    return true;
  });
  EXPECT_EQ(loader.size(), 0u);
}

TEST(BulkLoader, AMistakeIsReportedWithItsPlaceAndNothingOfTheDocumentIsAdded) {
  Dictionary dictionary;
  BulkLoader loader(dictionary);
  EXPECT_TRUE(loader.Add("<urn:a> <urn:p> <urn:b> <urn:g> .\n", RdfFormat::kNQuads, {}).empty());
  const Diagnostics mistakes = loader.Add(
      "<urn:a> <urn:p> <urn:c> .\n<urn:a> <urn:p> .\n<urn:a> <urn:p> <urn:d> .\n", RdfFormat::kNTriples, {});
  ASSERT_EQ(mistakes.size(), 1u);
  EXPECT_EQ(mistakes[0].span.line, 2);
  EXPECT_EQ(loader.size(), 1u);
}

}  // namespace
}  // namespace docent
