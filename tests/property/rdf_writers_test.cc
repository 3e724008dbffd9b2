// Random terms, all that RDF allows and many that look like something else: what each writer of graphs and of results writes is
// read back as the same, or refused where the format cannot say it.
#include <gtest/gtest.h>

#include <random>
#include <set>

#include "absl/strings/str_cat.h"
#include "graph/base/text.h"
#include "graph/rdf/formats/parser.h"
#include "graph/rdf/formats/serializer.h"
#include "graph/rdf/term_check.h"
#include "graph/rdf/vocabulary.h"
#include "graph/sparql/results/results.h"
#include "tests/conformance/rdf/isomorphism.h"
#include "tests/conformance/sparql/result_files.h"

namespace docent {
namespace {

using Prefixes = std::vector<std::pair<std::string, std::string>>;

// Characters that some format treats in a way of its own; none of ASCII is left out.
constexpr std::string_view kPieces[] = {"a",
                                        "Z",
                                        "0",
                                        "9",
                                        "_",
                                        "-",
                                        ".",
                                        ":",
                                        "%41",
                                        "~",
                                        "/",
                                        "#",
                                        "?",
                                        "&",
                                        "=",
                                        ",",
                                        ";",
                                        "'",
                                        "(",
                                        "@",
                                        "$",
                                        "!",
                                        "*",
                                        "+",
                                        "\x7F",
                                        "\xC3\xA9",
                                        "\xC2\xB7",
                                        "\xC2\x85",
                                        "\xCC\x80",
                                        "\xE2\x80\xBF",
                                        "\xE2\x80\xA8",
                                        "\xEF\xB7\xB0",
                                        "\xF0\x9F\x98\x80"};
// Only literals hold these.
constexpr std::string_view kTextPieces[] = {
    " ", "\t",  "\n",      "\r",   "\"",   "\\",           "<",           ">", "{", "}", "|", "^",
    "`", "]]>", "\\u0041", "\x01", "\x1B", "\xEF\xBF\xBE", "\xEF\xBF\xBF"};
constexpr std::string_view kSpaces[] = {"http://e/",
                                        "http://e/a",
                                        "urn:x:",
                                        "http://e/#",
                                        kRdfNs,
                                        kXsdNs,
                                        "http://www.w3.org/1999/02/22-rdf-syntax-ns#a#",
                                        "http://www.w3.org/XML/1998/namespace",
                                        "http://www.w3.org/2000/xmlns/"};
constexpr std::string_view kNames[] = {"li",   "about", "type",  "_1", "Description",
                                       "true", "1",     "xmlns", "a.b"};
constexpr std::string_view kNumbers[] = {"1",     "-1",   "+1",   "01",  "1.",   ".5",  "-.5", "1.5.",
                                         "1.2.3", "1e5",  "1.e5", ".e5", "1E-5", "INF", "NaN", "true",
                                         "false", "TRUE", "",     "-",   "+.",   "1 "};
constexpr std::string_view kTypes[] = {kXsdInteger, kXsdDecimal, kXsdDouble, kXsdBoolean};
constexpr std::string_view kLanguages[] = {"en", "EN", "de-AT", "x-a-1", "a-1", "zh-Hant-TW"};

class RandomTerms {
 public:
  explicit RandomTerms(uint32_t seed) : random_(seed) {}

  Term Iri() { return Below(4) == 0 ? Term::Iri(Space() + One(kNames)) : Term::Iri(Space() + Text(false)); }
  Term Blank() {
    for (;;) {
      const Term term = Term::Blank(Text(false));
      if (CheckTerm(term, 1000).ok()) return term;
    }
  }
  Term Object() {
    switch (Below(6)) {
      case 0:
        return Iri();
      case 1:
        return Blank();
      case 2:
        return Term::Literal(One(kNumbers), One(kTypes));
      case 3:
        return Term::LangString(Text(true), One(kLanguages));
      case 4:
        return Term::Literal(Text(true), Iri().lexical);
      default:
        return Term::Literal(Text(true));
    }
  }
  // Of as many subjects, at most.
  std::vector<TermQuad> Quads(bool graphs, size_t subjects) {
    std::vector<TermQuad> quads;
    for (size_t n = 1 + Below(subjects); n > 0; --n) {
      const Term subject = Below(3) == 0 ? Blank() : Iri();
      for (size_t k = 1 + Below(3); k > 0; --k) {
        Term graph;
        if (graphs && Below(2) == 0) graph = Below(4) == 0 ? Blank() : Iri();
        quads.push_back({subject, Iri(), Object(), graph});
      }
    }
    return quads;
  }
  Prefixes SomePrefixes() {
    Prefixes prefixes;
    for (size_t n = Below(4); n > 0; --n)
      prefixes.emplace_back(Below(3) == 0 ? One(kNames) : Text(false), Space());
    return prefixes;
  }
  size_t Below(size_t n) { return random_() % n; }

 private:
  template <size_t kCount>
  std::string One(const std::string_view (&of)[kCount]) {
    return std::string(of[Below(kCount)]);
  }
  std::string Space() { return One(kSpaces); }
  std::string Text(bool literal) {
    std::string text;
    for (size_t n = Below(5); n > 0; --n) text += literal && Below(3) == 0 ? One(kTextPieces) : One(kPieces);
    return text;
  }

  std::mt19937 random_;
};

TEST(RdfWritersTest, WhatAWriterOfGraphsWritesIsReadBack) {
  int refused = 0;
  for (uint32_t seed = 0; seed < 2000; ++seed) {
    for (const RdfFormat format : {RdfFormat::kTurtle, RdfFormat::kTriG, RdfFormat::kNTriples,
                                   RdfFormat::kNQuads, RdfFormat::kRdfXml}) {
      RandomTerms random(seed);
      const bool graphs = format == RdfFormat::kTriG || format == RdfFormat::kNQuads;
      // Every second triple is one that RDF/XML cannot say: larger graphs would all be refused.
      const auto quads = random.Quads(graphs, format == RdfFormat::kRdfXml ? 2 : 5);
      for (const TermQuad& quad : quads) ASSERT_TRUE(CheckQuad(quad, 1000).ok()) << CheckQuad(quad, 1000);
      const auto text = SerializeRdf(quads, format, random.SomePrefixes());
      if (!text.ok()) {
        ASSERT_EQ(format, RdfFormat::kRdfXml) << text.status();
        ASSERT_EQ(text.status().code(), absl::StatusCode::kInvalidArgument);
        ++refused;
        continue;
      }
      const ParsedRdf back = ParseRdf(*text, format);
      ASSERT_TRUE(back.ok()) << seed << "\n" << *text << Render(back.diagnostics, *text);
      ASSERT_TRUE(Isomorphism::Holds(quads, back.quads)) << seed << "\n" << *text;
    }
  }
  EXPECT_GT(refused, 100);
  EXPECT_LT(refused, 1900);
}

// XML 1.0 section 2.2.
bool FitsXml(const std::string& text) {
  return text.find_first_of("\x01\x1B") == std::string::npos &&
         text.find("\xEF\xBF\xBE") == std::string::npos && text.find("\xEF\xBF\xBF") == std::string::npos;
}

TEST(RdfWritersTest, WhatAWriterOfResultsWritesIsReadBack) {
  for (uint32_t seed = 0; seed < 2000; ++seed) {
    RandomTerms random(seed);
    std::vector<std::vector<std::optional<Term>>> rows;
    bool xml = true;
    for (size_t n = random.Below(4); n > 0; --n) {
      auto& row = rows.emplace_back();
      for (int i = 0; i < 2; ++i) {
        row.push_back(random.Below(5) == 0 ? std::nullopt : std::optional(random.Object()));
        if (row.back()) xml = xml && FitsXml(row.back()->lexical);
      }
    }
    for (const auto format :
         {sparql::ResultFormat::kJson, sparql::ResultFormat::kXml, sparql::ResultFormat::kTsv}) {
      if (format == sparql::ResultFormat::kXml && !xml) continue;
      std::string out;
      const auto writer = sparql::ResultWriter::Make(format, &out);
      writer->Begin({"a", "b"});
      for (const auto& row : rows) writer->Row(row);
      writer->End();
      const Answer back = format == sparql::ResultFormat::kJson  ? ReadJsonResult(out)
                          : format == sparql::ResultFormat::kXml ? ReadXmlResult(out)
                                                                 : ReadTsvResult(out);
      ASSERT_EQ(back.rows.size(), rows.size()) << out;
      for (size_t r = 0; r < rows.size(); ++r) {
        for (size_t i = 0; i < 2; ++i) {
          const auto it = back.rows[r].find(i == 0 ? "a" : "b");
          ASSERT_EQ(it != back.rows[r].end(), rows[r][i].has_value()) << out;
          if (!rows[r][i]) continue;
          ASSERT_EQ(it->second, *rows[r][i]) << seed << "\n" << out;
        }
      }
    }
  }
}

// CSV says texts alone: they come back by the rules of RFC 4180.
TEST(RdfWritersTest, CsvKeepsTheTexts) {
  for (uint32_t seed = 0; seed < 2000; ++seed) {
    RandomTerms random(seed);
    const std::vector<std::optional<Term>> row = {random.Object(), random.Object()};
    std::string out;
    const auto writer = sparql::ResultWriter::Make(sparql::ResultFormat::kCsv, &out);
    writer->Begin({"a", "b"});
    writer->Row(row);
    writer->End();
    std::vector<std::string> cells(1);
    bool quoted = false;
    const std::string_view line = std::string_view(out).substr(5);
    for (size_t i = 0; i < line.size(); ++i) {
      if (line[i] == '"' && !quoted) {
        quoted = true;
      } else if (line[i] == '"' && i + 1 < line.size() && line[i + 1] == '"') {
        cells.back() += line[++i];
      } else if (line[i] == '"') {
        quoted = false;
      } else if (line[i] == ',' && !quoted) {
        cells.emplace_back();
      } else {
        cells.back() += line[i];
      }
    }
    for (size_t i = 0; i < 2; ++i) {
      const std::string text = (row[i]->IsBlank() ? "_:" : "") + row[i]->lexical;
      ASSERT_EQ(cells[i], i == 1 ? text + "\r\n" : text) << out;
    }
  }
}

}  // namespace
}  // namespace docent
