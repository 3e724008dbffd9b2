#include "graph/rdf/formats/text_input.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "graph/base/gzip.h"

namespace docent {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

class TextInputTest : public testing::Test {
 protected:
  void SetUp() override {
    const testing::TestInfo* test = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::path(testing::TempDir()) / test->name() / "text input";
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_.parent_path()); }

  std::string File(const std::string& name, const std::string& bytes) {
    const std::string path = folder_ / name;
    std::ofstream(path, std::ios::binary) << bytes;
    return path;
  }

  std::filesystem::path folder_;
};

constexpr char kTurtle[] = "<#a> <p> <> .";

TEST_F(TextInputTest, AFileIsItsOwnBase) {
  const auto rdf = ReadRdf(File("a b#1.ttl", kTurtle), "");
  ASSERT_TRUE(rdf.ok()) << rdf.status();
  EXPECT_THAT(rdf->base_iri, StartsWith("file:///"));
  EXPECT_THAT(rdf->base_iri, testing::EndsWith("/text%20input/a%20b%231.ttl"));
  const ParsedRdf parsed = ParseRdf(rdf->text, rdf->format, rdf->Options("f"));
  ASSERT_TRUE(parsed.ok()) << Render(parsed.diagnostics, "");
  EXPECT_EQ(parsed.quads[0].object.lexical, rdf->base_iri);
  EXPECT_EQ(parsed.quads[0].subject.lexical, rdf->base_iri + "#a");
  EXPECT_EQ(ReadRdf(File("a.ttl", kTurtle), "http://e/b")->base_iri, "http://e/b");
}

TEST_F(TextInputTest, PackedFilesAreReadByWhatTheyHold) {
  for (const char* name : {"a.ttl.gz", "a.TTL.GZ", "a.ttl"}) {
    const auto rdf = ReadRdf(File(name, Gzip(kTurtle)), "");
    ASSERT_TRUE(rdf.ok()) << rdf.status();
    EXPECT_EQ(rdf->text, kTurtle);
    EXPECT_EQ(rdf->format, RdfFormat::kTurtle);
  }
  EXPECT_EQ(ReadRdf(File("b.nt.gz", "<urn:a> <urn:b> 1 ."), "")->format, RdfFormat::kNTriples)
      << "not packed after all";
  EXPECT_EQ(*ReadText(File("r.rules.gz", Gzip("RULE"))), "RULE");
  const std::string cut = Gzip(kTurtle);
  const auto damaged = ReadRdf(File("c.ttl.gz", cut.substr(0, cut.size() - 4)), "");
  EXPECT_THAT(std::string(damaged.status().message()), HasSubstr("c.ttl.gz: the gzip data ends too early"));
}

TEST_F(TextInputTest, ReadingAndUnpackingStopAtTheLimit) {
  const TextLimit limit{1000, "some_bytes"};
  EXPECT_EQ(ReadText(File("a.rules", std::string(1000, 'x')), limit)->size(), 1000u);
  EXPECT_EQ(ReadText(File("a.rules.gz", Gzip(std::string(1000, 'x'))), limit)->size(), 1000u);
  const auto plain = ReadText(File("b.rules", std::string(1001, 'x')), limit);
  EXPECT_EQ(plain.status().code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(std::string(plain.status().message()),
              HasSubstr("b.rules has more bytes than the limit some_bytes = 1000"));
  const auto packed = ReadText(File("b.rules.gz", Gzip(std::string(1001, 'x'))), limit);
  EXPECT_EQ(packed.status().code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(std::string(packed.status().message()), HasSubstr("than the limit some_bytes = 1000"));
  EXPECT_EQ(ReadRdf(File("c.ttl", std::string(1001, ' ')), "", "", limit).status().code(),
            absl::StatusCode::kResourceExhausted);
}

TEST_F(TextInputTest, OtherEncodingsBecomeUtf8) {
  const std::string xml =
      "<?xml version='1.0' encoding='ISO-8859-1'?><r:RDF "
      "xmlns:r='http://www.w3.org/1999/02/22-rdf-syntax-ns#'>"
      "<r:Bag r:about='urn:a'><r:li>\xE9</r:li></r:Bag></r:RDF>";
  const auto rdf = ReadRdfToSend(File("a.owl", xml), "");
  ASSERT_TRUE(rdf.ok()) << rdf.status();
  const ParsedRdf parsed = ParseRdf(rdf->text, rdf->format, rdf->Options("f"));
  ASSERT_TRUE(parsed.ok()) << Render(parsed.diagnostics, rdf->text);
  EXPECT_EQ(parsed.quads.at(1).object.lexical, "\xC3\xA9");
  const auto broken = ReadRdfToSend(File("b.ttl", "<urn:a> <urn:b> \"\xE9\" ."), "");
  EXPECT_THAT(std::string(broken.status().message()),
              HasSubstr("b.ttl:1:18: error: the byte 0xE9 here is not UTF-8"));
  const std::string odd = File("c.rdf", "<?xml version='1.0' encoding='UTF-7'?><a/>");
  EXPECT_THAT(std::string(ReadRdfToSend(odd, "").status().message()),
              HasSubstr("the encoding \"utf-7\" is not read"));
  EXPECT_TRUE(ReadRdf(odd, "").ok()) << "the parser says what is wrong";
}

TEST_F(TextInputTest, FormatsThatAreNotReadAreNamed) {
  for (const char* name : {"a.jsonld", "a.n3", "a.json.gz", "a.trix"}) {
    const absl::Status unread = ReadRdf(File(name, kTurtle), "").status();
    EXPECT_THAT(std::string(unread.message()), HasSubstr(std::string(name) + ":1:1: error: this is "))
        << name;
    EXPECT_THAT(std::string(unread.message()), HasSubstr("RDF/XML (.rdf, .owl, .xml) are")) << name;
  }
  EXPECT_TRUE(ReadRdf(File("b.n3", kTurtle), "", "ttl").ok()) << "the format is given";
  EXPECT_TRUE(ReadRdf(File("c.data", kTurtle), "").ok());
}

}  // namespace
}  // namespace docent
