// Terms that expressions make: each can be written and read again, or the expression is an error.
#include <gtest/gtest.h>

#include "graph/rdf/term_check.h"
#include "tests/graph/sparql/test_graph.h"

namespace docent::sparql {
namespace {

TEST(MadeTerms, AnIriHoldsNoForbiddenCharacter) {
  TestGraph g;
  for (const char* text : {"urn:a", "http://e/\u00E4", "urn:a%20b", "urn:\u0085", "urn:\u007F"}) {
    EXPECT_TRUE(g.Ask("ASK { BIND(IRI(\"" + std::string(text) + "\") AS ?i) FILTER(isIRI(?i)) }")) << text;
  }
  for (const char* text :
       {"urn:\\u0001a", "urn:a\\u001F", "urn:\\t", "urn:\\n", "urn:\\u000B", "urn:a b", "urn:<", "urn:a>",
        "urn:\\\"", "urn:{", "urn:}", "urn:|", "urn:^", "urn:`", "urn:\\\\", "", "a", "\\u0001"}) {
    const std::string call = "(\"" + std::string(text) + "\")";
    EXPECT_FALSE(g.Ask("ASK { BIND(IRI" + call + " AS ?i) FILTER(BOUND(?i)) }")) << text;
    EXPECT_FALSE(g.Ask("ASK { BIND(URI" + call + " AS ?i) FILTER(BOUND(?i)) }")) << text;
  }
  // Relative to a base.
  EXPECT_TRUE(g.Ask("BASE <http://e/x/> ASK { FILTER(IRI(\"../a\") = <http://e/a>) }"));
  EXPECT_FALSE(g.Ask("BASE <http://e/x/> ASK { BIND(IRI(\"\\u0002\") AS ?i) FILTER(BOUND(?i)) }"));
}

// What is no IRI is no datatype either.
TEST(MadeTerms, EachCanBeReadAgain) {
  TestGraph g("ex:a ex:p \"\\u0001 x\", \"en \\u0002\", \"a b\", \"\", \"ok\" .");
  const auto query = g.Prepare(
      "CONSTRUCT { ?i ex:i ?b . ?b ex:d ?d ; ex:l ?l ; ex:u ?u ; ex:e ?e ; ex:r ?r } WHERE { ex:a ex:p ?t "
      "BIND(BNODE(?t) AS ?b) BIND(IRI(CONCAT(\"urn:\", ?t)) AS ?i) BIND(STRDT(?t, IRI(CONCAT(\"urn:\", ?t))) "
      "AS ?d) "
      "BIND(STRLANG(?t, ?t) AS ?l) BIND(UUID() AS ?u) BIND(ENCODE_FOR_URI(?t) AS ?e) BIND(REPLACE(?t, \"x\", "
      "?t) AS ?r) }");
  const auto triples = query->Construct(g.Run());
  ASSERT_TRUE(triples.ok()) << triples.status();
  EXPECT_GT(triples->size(), 15u);
  for (const TermQuad& quad : *triples)
    EXPECT_TRUE(CheckQuad(quad, 1 << 20).ok()) << CheckQuad(quad, 1 << 20);
}

}  // namespace
}  // namespace docent::sparql
