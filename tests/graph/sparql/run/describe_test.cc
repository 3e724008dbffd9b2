#include "graph/sparql/run/describe.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/graph/sparql/test_graph.h"

namespace docent::sparql {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

std::vector<std::string> DescribeText(const TestGraph& graph, const std::string& text,
                                      const PrepareOptions& options = {}) {
  const Query query = graph.Parse(text);
  auto prepared = PreparedQuery::Prepare(query, graph.dictionary, options);
  EXPECT_TRUE(prepared.ok()) << prepared.status();
  auto quads = Describe(**prepared, query, graph.dictionary, options, graph.Run());
  EXPECT_TRUE(quads.ok()) << quads.status();
  std::vector<std::string> out;
  for (const TermQuad& q : *quads) {
    const auto name = [](const Term& t) {
      return t.IsBlank() ? "_" : t.lexical.substr(t.lexical.find_last_of('/') + 1);
    };
    out.push_back(name(q.subject) + " " + name(q.predicate) + " " + name(q.object));
  }
  std::sort(out.begin(), out.end());
  return out;
}

constexpr char kData[] =
    "ex:a ex:p ex:b ; ex:card [ ex:name \"A\" ; ex:next [ ex:loop ex:a ] ] . ex:b ex:p ex:c . ex:c ex:p ex:a "
    ". "
    "GRAPH ex:g { ex:a ex:p ex:b , ex:d }";

TEST(Describe, TriplesOfTheResourceAndOfTheBlankNodesReached) {
  const TestGraph graph(kData);
  EXPECT_THAT(DescribeText(graph, "DESCRIBE ex:a"),
              ElementsAre("_ loop a", "_ name A", "_ next _", "a card _", "a p b", "a p d"));
  EXPECT_THAT(DescribeText(graph, "DESCRIBE ex:b ex:none"), ElementsAre("b p c"));
  EXPECT_THAT(DescribeText(graph, "DESCRIBE ?x WHERE { ?x ex:p ex:c }"), ElementsAre("b p c"));
  EXPECT_THAT(DescribeText(graph, "DESCRIBE * WHERE { ?x ex:p ?y FILTER(?x = ex:b) }"),
              ElementsAre("b p c", "c p a"));
  EXPECT_THAT(DescribeText(graph, "DESCRIBE ex:b WHERE { ex:none ?p ?o }"), IsEmpty());
}

TEST(Describe, OnlyTheDataSetsDefaultGraph) {
  const TestGraph graph(kData);
  PrepareOptions strict;
  strict.default_graph = DefaultGraph::kStrict;
  EXPECT_THAT(DescribeText(graph, "DESCRIBE ex:a FROM ex:g"), ElementsAre("a p b", "a p d"));
  EXPECT_THAT(DescribeText(graph, "DESCRIBE ex:a", strict), testing::Not(testing::Contains("a p d")));
  EXPECT_THAT(DescribeText(graph, "DESCRIBE ex:a FROM NAMED ex:g", strict), IsEmpty());
}

TEST(Describe, ACycleOfBlankNodesEnds) {
  const TestGraph graph("ex:a ex:p _:x . _:x ex:p _:y . _:y ex:p _:x .");
  EXPECT_THAT(DescribeText(graph, "DESCRIBE ex:a"), ElementsAre("_ p _", "_ p _", "a p _"));
}

TEST(Describe, TooMuchIsRefusedWithTheLimit) {
  const TestGraph graph(kData);
  const Query query = graph.Parse("DESCRIBE ex:a");
  PrepareOptions options;
  options.memory_bytes = 100;
  auto prepared = PreparedQuery::Prepare(query, graph.dictionary, options);
  const auto quads = Describe(**prepared, query, graph.dictionary, options, graph.Run());
  EXPECT_EQ(quads.status().code(), absl::StatusCode::kResourceExhausted);
}

}  // namespace
}  // namespace docent::sparql
