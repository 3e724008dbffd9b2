#include "tests/conformance/sparql/suite_support.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <sstream>

#include "graph/rdf/formats/parser.h"
#include "graph/rdf/vocabulary.h"
#include "graph/store/batch_applier.h"
#include "tests/conformance/sparql/w3c_manifest.h"

namespace docent {

std::map<std::string, std::string> ReadNotes(const std::string& file) {
  std::map<std::string, std::string> out;
  std::istringstream in(ReadText(std::string(DOCENT_SOURCE_DIR) + "/tests/conformance/" + file));
  for (std::string line; std::getline(in, line);) {
    const size_t space = line.find(' ');
    if (line.empty() || line[0] == '#' || space == std::string::npos) continue;
    out[line.substr(0, space)] = line.substr(space + 1);
  }
  return out;
}

const std::map<std::string, std::string>& KnownFailures() {
  static const auto* known = new std::map<std::string, std::string>(ReadNotes("known_failures.txt"));
  return *known;
}

void JudgeOne(const std::string& name, const std::string& why) {
  if (KnownFailures().contains(name)) {
    EXPECT_NE(why, "") << name << " passes: take it out of known_failures.txt";
  } else {
    EXPECT_EQ(why, "") << name;
  }
}

void ReportSuite(const std::string& suite, size_t passed, size_t total) {
  EXPECT_GT(total, 0u) << suite;
  std::printf("conformance %s %zu %zu\n", suite.c_str(), passed, total);
}

void SuiteStore::Load(const std::string& iri, const std::string& graph) {
  ParseRdfOptions options;
  options.base_iri = iri;
  options.blank_node_scope = "d" + std::to_string(++documents_);
  const std::string text = ReadText(W3cFile(iri));
  const ParsedRdf parsed = ParseRdf(text, *FormatOfFile(iri), options);
  EXPECT_TRUE(parsed.ok()) << iri << "\n" << Render(parsed.diagnostics, text);
  const TermId name = dictionary.InternIri(graph);
  for (const TermQuad& q : parsed.quads) {
    writer_.Add(
        {dictionary.Intern(q.subject), dictionary.Intern(q.predicate), dictionary.Intern(q.object), name});
  }
}

absl::Status SuiteStore::Apply(std::vector<QuadOperation> operations) {
  BatchApplier applier(dictionary, Limits{});
  WriteBatch batch;
  batch.mode = WriteBatch::Mode::kLoad;
  batch.operations = std::move(operations);
  return applier.Apply(batch, writer_).status();
}

std::vector<TermQuad> SuiteStore::Quads() {
  std::vector<TermQuad> out;
  writer_.current().ForEach({}, [&](const Quad& q) {
    TermQuad quad{dictionary.Decode(q.subject), dictionary.Decode(q.predicate), dictionary.Decode(q.object),
                  dictionary.Decode(q.graph)};
    if (quad.graph.lexical == kDefaultGraph) quad.graph = Term{};
    out.push_back(std::move(quad));
    return true;
  });
  return out;
}

}  // namespace docent
