#include "kb_server/cli/part_loader.h"

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/kb_server/server_world.h"

namespace docent::server {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::string Lines(int count) {
  std::string text;
  for (int i = 0; i < count; ++i) {
    absl::StrAppend(&text, "<urn:w:s", i, "> <urn:w:next> _:n", (i + 1) % 50, " .\n");
  }
  return text;
}

TEST(CutDocumentTest, LinesAreCutAtTheirEnds) {
  const std::string text =
      "<urn:a> <urn:p> \"1\" .\n# a comment\n<urn:a> <urn:p> \"2\" .\n<urn:a> <urn:p> \"3\" .";
  const auto document = CutDocument(text, RdfFormat::kNTriples, "f", 10);
  EXPECT_THAT(document->parts, ElementsAre("<urn:a> <urn:p> \"1\" .\n", "# a comment\n",
                                           "<urn:a> <urn:p> \"2\" .\n", "<urn:a> <urn:p> \"3\" ."));
  EXPECT_EQ(document->statements, 3u);
  EXPECT_EQ(document->bytes, text.size());
  EXPECT_EQ(document->media_type, "application/n-triples");
}

TEST(CutDocumentTest, OtherSyntaxesBecomeNQuads) {
  const std::string text = "@prefix : <urn:w:> . :a :p :b , :c . :g { :d :p [] }";
  const auto document = CutDocument(text, RdfFormat::kTriG, "f", 1);
  EXPECT_EQ(document->media_type, "application/n-quads");
  EXPECT_EQ(document->statements, 3u);
  EXPECT_EQ(document->parts.size(), 3u);
  EXPECT_EQ(document->parts[2].substr(0, 19), "<urn:w:d> <urn:w:p>");
}

TEST(CutDocumentTest, AMistakeAnywhereLeavesNoParts) {
  const std::string text = Lines(100) + "<urn:a> oops\n";
  const auto document = CutDocument(text, RdfFormat::kNTriples, "f", 100);
  EXPECT_THAT(document->parts, IsEmpty());
  ASSERT_EQ(document->diagnostics.size(), 1u);
  EXPECT_EQ(document->diagnostics[0].span.line, 101);
}

class PartLoaderTest : public test::ServerTest {};

TEST_F(PartLoaderTest, AllPartsAreInTheGraphAndBlankNodesAreThoseOfTheDocument) {
  StartServer();
  const std::string text = Lines(400);
  const auto document = CutDocument(text, RdfFormat::kNTriples, "f", 500);
  ASSERT_GT(document->parts.size(), 20u);
  v1::LoadRequest request;
  request.set_name("f");
  request.set_graph("urn:w:graph");
  size_t seen = 0;
  const PartsOutcome outcome = LoadParts(channel_, *document, request, [&](size_t bytes) {
    EXPECT_GT(bytes, seen);
    seen = bytes;
  });
  ASSERT_TRUE(outcome.status.ok()) << outcome.status.error_message();
  EXPECT_EQ(outcome.added, 400u);
  EXPECT_EQ(outcome.parts, document->parts.size());
  EXPECT_EQ(seen, text.size());
  EXPECT_EQ(outcome.revision, Revision());
  EXPECT_THAT(Query("SELECT (COUNT(DISTINCT ?o) AS ?n) { GRAPH <urn:w:graph> { ?s <urn:w:next> ?o } }").rows,
              ElementsAre("\"50\""));
  // Again: nothing new.
  const PartsOutcome again = LoadParts(channel_, *document, request, [](size_t) {});
  EXPECT_TRUE(again.status.ok());
  EXPECT_EQ(again.added, 0u);
}

TEST_F(PartLoaderTest, APartThatIsRefusedEndsTheLoad) {
  StartServer();
  const std::string text = Lines(400);
  const auto document = CutDocument(text, RdfFormat::kNTriples, "f", 500);
  v1::LoadRequest request;
  request.set_name("f");
  request.set_graph(std::string(kInferredGraph));  // which only the server writes
  const PartsOutcome outcome = LoadParts(channel_, *document, request, [](size_t) {});
  EXPECT_EQ(outcome.status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_THAT(outcome.status.error_message(), HasSubstr("graph"));
  EXPECT_EQ(outcome.parts, 0u);
}

}  // namespace
}  // namespace docent::server
