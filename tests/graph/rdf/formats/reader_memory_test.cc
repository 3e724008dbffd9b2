// What a document says counts in the memory of the request that sends it, in each format.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <malloc.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <functional>

#include "graph/base/memory_budget.h"
#include "graph/rdf/formats/located_parser.h"
#include "graph/rdf/formats/parser.h"

namespace docent {
namespace {

using testing::HasSubstr;

struct Document {
  RdfFormat format;
  std::string first, more, last;  // N in `more`: a number

  std::string Text(int times) const {
    std::string text = first;
    for (int i = 0; i < times; ++i) {
      for (const char c : more) text += c == 'N' ? std::to_string(i) : std::string(1, c);
    }
    return text + last;
  }
};

const Document kDocuments[] = {
    {RdfFormat::kTurtle, "", "<u:a> <u:b> N .\n", ""},
    {RdfFormat::kTurtle, "<u:a> <u:b> 0", ", N", " ."},
    {RdfFormat::kTurtle, "<u:a> <u:b> (", " N", " ) ."},
    {RdfFormat::kTurtle, "", "[] <u:b> [] .\n", ""},
    {RdfFormat::kTurtle, "", "@prefix pN: <u:N> .\n", ""},
    {RdfFormat::kTriG, "", "<u:N> { <u:a> <u:b> 1 }\n", ""},
    {RdfFormat::kNTriples, "", "<u:a> <u:b> <u:N> .\n", ""},
    {RdfFormat::kNQuads, "", "<u:a> <u:b> <u:N> <u:g> .\n", ""},
    {RdfFormat::kRdfXml,
     "<rdf:RDF xmlns:rdf=\"http://www.w3.org/1999/02/22-rdf-syntax-ns#\" xmlns:e=\"u:e\">",
     "<rdf:Description rdf:about=\"u:a\"><e:b>N</e:b></rdf:Description>\n", "</rdf:RDF>"},
    {RdfFormat::kRdfXml,
     "<rdf:RDF xmlns:rdf=\"http://www.w3.org/1999/02/22-rdf-syntax-ns#\" xmlns:e=\"u:e\">",
     "<rdf:Description rdf:about=\"u:a\"><e:b rdf:ID=\"iN\">N</e:b></rdf:Description>\n", "</rdf:RDF>"},
};

ParsedRdf Parse(const Document& document, int times, MemoryUse* memory) {
  ParseRdfOptions options;
  options.base_iri = "http://e/";
  options.memory = memory;
  return ParseRdf(document.Text(times), document.format, options);
}

TEST(ReaderMemory, EachFormatCountsWhatItReads) {
  for (const Document& document : kDocuments) {
    MemoryUse enough(64 << 20), little(1 << 20);
    const ParsedRdf parsed = Parse(document, 10000, &enough);
    ASSERT_TRUE(parsed.ok()) << document.more << Render(parsed.diagnostics, "");
    EXPECT_GE(enough.used() + (128 << 10), parsed.quads.size() * sizeof(TermQuad)) << document.more;
    EXPECT_GT(enough.used(), 10000 * 200u) << document.more;
    const ParsedRdf refused = Parse(document, 10000, &little);
    EXPECT_EQ(refused.stopped.code(), absl::StatusCode::kResourceExhausted) << document.more;
    EXPECT_THAT(std::string(refused.stopped.message()), HasSubstr("query_memory_bytes")) << document.more;
    EXPECT_THAT(refused.quads, testing::IsEmpty());
    EXPECT_TRUE(Parse(document, 10, &enough).ok());
  }
}

TEST(ReaderMemory, AnOverloadOfAllIsTold) {
  MemoryBudget all("all_bytes", 2 << 20);
  MemoryUse memory(64 << 20, &all);
  const ParsedRdf refused = Parse(kDocuments[0], 20000, &memory);
  EXPECT_EQ(refused.stopped, all.Refusal());
}

TEST(ReaderMemory, PlacesCountToo) {
  ParseRdfOptions options;
  MemoryUse plain(64 << 20), located(64 << 20);
  options.memory = &plain;
  const std::string text = kDocuments[0].Text(10000);
  EXPECT_TRUE(ParseRdf(text, RdfFormat::kTurtle, options).ok());
  options.memory = &located;
  EXPECT_TRUE(ParseLocatedRdf(text, RdfFormat::kTurtle, options).rdf.ok());
  EXPECT_GT(located.used(), plain.used() + 10000 * sizeof(QuadPlace) / 2);
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // which take memory of their own
// By how much a process of its own grows that does `work`, at most.
size_t MostMemoryOf(const std::function<void()>& work) {
  const auto grown = [](const std::function<void()>& what) {
    const pid_t child = fork();
    if (child == 0) {
      mallopt(M_MMAP_THRESHOLD, 1 << 20);  // large arrays go back at once, as with the programs' allocator
      const bool failed_before = testing::Test::HasFailure();
      what();
      _exit(!failed_before && testing::Test::HasFailure() ? 1 : 0);
    }
    rusage use{};
    int status = 0;
    EXPECT_EQ(wait4(child, &status, 0, &use), child);
    EXPECT_EQ(status, 0);
    return static_cast<size_t>(use.ru_maxrss) << 10;
  };
  const size_t idle = grown([] {});
  return grown(work) - idle;
}

// An array that grows by doubling is there twice for a while, which nothing counts.
TEST(ReaderMemory, ADocumentTakesNoMoreThanIsCounted) {
  std::string text = "<u:a> <u:b> <u:c>";
  for (int i = 0; i < 1000000; ++i) text += ", <u:c>";
  for (const size_t quads : {270000, 520000}) {  // just beyond, and just within, a power of two
    MemoryUse memory(SIZE_MAX);
    const std::string document = text.substr(0, 17 + 7 * quads) + " .";
    const auto parse = [&] {
      ParseRdfOptions options;
      options.memory = &memory;
      return ParseRdf(document, RdfFormat::kTurtle, options);
    };
    const size_t most = MostMemoryOf([&] { EXPECT_EQ(parse().quads.size(), quads + 1); });
    EXPECT_TRUE(parse().ok());
    EXPECT_LT(most, memory.used() + memory.used() / 4) << quads;
  }
  // What does not fit is refused before it is there.
  const size_t limit = 100u << 20;
  EXPECT_LT(MostMemoryOf([&] {
              MemoryUse memory(limit);
              ParseRdfOptions options;
              options.memory = &memory;
              EXPECT_EQ(ParseRdf(text + " .", RdfFormat::kTurtle, options).stopped.code(),
                        absl::StatusCode::kResourceExhausted);
            }),
            limit + limit / 4);
}
#endif

// Graphs and labels that no triple uses take memory, too.
TEST(ReaderMemory, WhatNoTripleUsesCountsOrIsNotKept) {
  ParseRdfOptions options;
  std::string labels, brackets;
  for (int i = 1; i < 40000; ++i) {
    labels += "_:b" + std::to_string(i) + "{}\n";
    brackets += "[]{}\n";
  }
  MemoryUse little(1 << 20), other(1 << 20);
  options.memory = &little;
  EXPECT_EQ(ParseRdf(labels, RdfFormat::kTriG, options).stopped.code(), absl::StatusCode::kResourceExhausted);
  options.memory = &other;
  EXPECT_TRUE(ParseRdf(brackets, RdfFormat::kTriG, options).ok());
}

}  // namespace
}  // namespace docent
