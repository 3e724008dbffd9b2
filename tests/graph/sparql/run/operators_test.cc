// Properties of the operators beyond correct answers: hash tables for many lookups, first rows without a full
// sort, paths that do not explode, and plans that report the execution.
#include <gtest/gtest.h>

#include "tests/graph/sparql/test_graph.h"

namespace docent::sparql {
namespace {

// n people in a ring of `knows`, each at one of ten places.
std::string People(int n) {
  std::string text;
  for (int i = 0; i < n; ++i) {
    const std::string who = "ex:p" + std::to_string(i);
    text += who + " ex:knows ex:p" + std::to_string((i + 1) % n) + " ; ex:at ex:B" + std::to_string(i % 10) +
            " ; ex:age " + std::to_string(i * 7919 % n) + " .\n";
  }
  return text;
}

std::string Explained(TestGraph& g, const std::string& query) {
  const auto plan = g.Prepare(query)->ExplainRun(g.Run());
  EXPECT_TRUE(plan.ok()) << plan.status();
  return plan.ok() ? *plan : "";
}

// Each of n people likes another, far from one to the next.
std::string Likes(int n) {
  std::string text;
  for (int i = 0; i < n; ++i)
    text += "ex:p" + std::to_string(i) + " ex:likes ex:p" + std::to_string(i * 7919 % n) + " .\n";
  return text;
}

TEST(SparqlOperators, ManyLookupsFarFromEachOtherGoOverToAHashTableAndGiveTheSame) {
  TestGraph g(People(2000) + Likes(2000));
  const std::string query = "SELECT ?a ?c { ?a ex:likes ?b . ?b ex:likes ?c . ?c ex:at ex:B3 }";
  EXPECT_EQ(g.Rows(query).size(), 200u);
  const std::string three = "SELECT ?a ?c { ?a ex:likes ?b . ?b ex:likes ?c . ?c ex:at ?d }";
  EXPECT_EQ(g.Rows(three).size(), 2000u);
  const std::string plan = Explained(g, three);
  EXPECT_NE(plan.find("by hash"), std::string::npos) << plan;
  EXPECT_NE(plan.find("| 2000 rows"), std::string::npos) << plan;
}

TEST(SparqlOperators, LookupsBesideEachOtherStayWithTheIndex) {
  TestGraph g(People(2000));
  const std::string plan = Explained(g, "SELECT ?a ?b ?c { ?a ex:knows ?b . ?b ex:knows ?c }");
  EXPECT_NE(plan.find("| 2000 rows"), std::string::npos) << plan;
  EXPECT_EQ(plan.find("by hash"), std::string::npos) << plan;
}

TEST(SparqlOperators, ATableOfFarMoreMatchesThanLookupsToComeIsNotMade) {
  std::string some;
  for (int i = 0; i < 500; ++i) some += "ex:p" + std::to_string(i) + " a ex:Guest .\n";
  for (const int people : {1000, 1300, 2000}) {
    TestGraph g(People(people) + some);
    const std::string plan = Explained(g, "SELECT ?a ?x { ?a a ex:Guest . ?a ex:age ?x }");
    EXPECT_NE(plan.find("| 500 rows"), std::string::npos) << plan;
    EXPECT_EQ(plan.find("by hash"), std::string::npos) << plan;
  }
}

TEST(SparqlOperators, AHashTableIsMadeAnewForAnotherVersion) {
  TestGraph g(People(2000) + Likes(2000));
  const auto query = g.Prepare("SELECT ?a ?c { ?a ex:likes ?b . ?b ex:likes ?c . ?c ex:at ?d }");
  const auto count = [&] {
    size_t rows = 0;
    EXPECT_TRUE(query->Select(g.Run(), {}, [&](absl::Span<const TermId>) { return ++rows > 0; }).ok());
    return rows;
  };
  EXPECT_EQ(count(), 2000u);
  g.Add("ex:p5 ex:at ex:B77 . ex:new ex:likes ex:p5 .");
  EXPECT_EQ(count(), 2002u);
}

TEST(SparqlOperators, OptionalAndNotExistsOverManyRows) {
  TestGraph g(People(1500) + "ex:p3 ex:name \"three\" . ex:p4 ex:name \"four\" .");
  EXPECT_EQ(g.Rows("SELECT ?a ?n { ?a ex:knows ?b OPTIONAL { ?b ex:name ?n } }").size(), 1500u);
  EXPECT_EQ(g.Rows("SELECT ?a { ?a ex:knows ?b FILTER NOT EXISTS { ?b ex:name ?n } }").size(), 1498u);
  EXPECT_EQ(g.Rows("SELECT ?a { ?a ex:knows ?b FILTER EXISTS { ?b ex:name ?n } }").size(), 2u);
  EXPECT_EQ(g.Rows("SELECT ?a { ?a ex:knows ?b MINUS { ?b ex:name ?n } }").size(), 1498u);
}

TEST(SparqlOperators, FirstRowsAreThoseOfAWholeSort) {
  TestGraph g(People(1000));
  const std::string order = "SELECT ?a ?x { ?a ex:age ?x } ORDER BY DESC(?x) ?a";
  const std::vector<std::string> all = g.Rows(order, {}, true);
  const std::vector<std::string> some = g.Rows(order + " LIMIT 7 OFFSET 5", {}, true);
  EXPECT_EQ(some, std::vector<std::string>(all.begin() + 5, all.begin() + 12));
  EXPECT_TRUE(g.Rows(order + " LIMIT 0").empty());
  EXPECT_EQ(g.Rows(order + " LIMIT 5000", {}, true), all);
  // equal keys: in input order, with and without the limit
  const std::vector<std::string> by_place = g.Rows("SELECT ?a { ?a ex:at ?b } ORDER BY ?b", {}, true);
  EXPECT_EQ(g.Rows("SELECT ?a { ?a ex:at ?b } ORDER BY ?b LIMIT 120", {}, true),
            std::vector<std::string>(by_place.begin(), by_place.begin() + 120));
}

// A computed number is the same term as an asserted one with the same text; a computed number that fits into
// no id is a term, too.
TEST(SparqlOperators, ComputedNumbersAreTerms) {
  TestGraph g(
      "ex:a ex:n 3 . ex:b ex:n 3.0 . ex:c ex:n 1.50 . ex:d ex:n 1.5 . ex:e ex:n 0 . ex:f ex:n "
      "\"003\"^^xsd:integer .");
  using Rows = std::vector<std::string>;
  const auto same = [&g](const std::string& e) {
    return g.Rows("SELECT ?s { BIND(" + e + " AS ?n) ?s ex:n ?n } ORDER BY ?s", {}, true);
  };
  EXPECT_EQ(same("1 + 2"), (Rows{"a"}));
  EXPECT_EQ(same("1.0 + 2"), (Rows{}));  // "3"^^xsd:decimal
  EXPECT_EQ(same("3.0 / 2"), (Rows{"d"}));
  EXPECT_EQ(same("-(-1.50)"), (Rows{"d"}));
  EXPECT_EQ(same("2 - 2"), (Rows{"e"}));
  EXPECT_EQ(same("xsd:integer(\"3\")"), (Rows{"a"}));
  EXPECT_EQ(
      g.Rows("SELECT ?x { VALUES (?a ?b) { (1 3) (-2 3) (576460752303423487 1) (576460752303423488 1) } "
             "BIND(?a / ?b AS ?x) }",
             {}, true),
      (Rows{"0.333333333333333333", "-0.666666666666666666", "576460752303423487", "576460752303423488"}));
  EXPECT_EQ(g.Rows("SELECT ?x { VALUES ?a { 576460752303423487 -576460752303423489 9223372036854775807 } "
                   "BIND(?a + 1 AS ?x) }",
                   {}, true),
            (Rows{"576460752303423488", "-576460752303423488", "9223372036854775808"}));
  EXPECT_EQ(g.Rows("SELECT (AVG(?n) AS ?m) (SUM(?n) AS ?t) (COUNT(?n) AS ?c) (COUNT(*) AS ?r) { ?s ex:n ?n }",
                   {}, true),
            (Rows{"2 12 6 6"}));
}

// Texts from the dictionary, from the query and computed ones, with and without language.
TEST(SparqlOperators, TextsAreTestedWhereverTheyStand) {
  TestGraph g(
      "ex:a ex:n \"abc\" . ex:b ex:n \"abc\"@en . ex:c ex:n \"\" . ex:d ex:n 12 . ex:e ex:n ex:abc . ex:f "
      "ex:n \"abc\"^^ex:t . "
      "ex:g ex:n \"bc\" . ex:a ex:part \"b\" . ex:b ex:part \"b\"@en . ex:c ex:part \"b\"@fr .");
  const auto rows = [&g](const std::string& filter) {
    return g.Rows("SELECT ?s { ?s ex:n ?n FILTER(" + filter + ") } ORDER BY ?s", {}, true);
  };
  using Rows = std::vector<std::string>;
  EXPECT_EQ(rows("CONTAINS(?n, \"b\")"), (Rows{"a", "b", "g"}));
  EXPECT_EQ(rows("!CONTAINS(?n, \"b\")"), (Rows{"c"}));
  EXPECT_EQ(rows("CONTAINS(?n, \"\")"), (Rows{"a", "b", "c", "g"}));
  EXPECT_EQ(rows("STRSTARTS(?n, \"ab\")"), (Rows{"a", "b"}));
  EXPECT_EQ(rows("STRENDS(?n, \"bc\")"), (Rows{"a", "b", "g"}));
  EXPECT_EQ(rows("STRENDS(\"abcd bc\", ?n)"), (Rows{"c", "g"}));
  EXPECT_EQ(rows("CONTAINS(?n, \"b\"@en)"), (Rows{"b"}));
  EXPECT_EQ(rows("CONTAINS(?n, \"abcd\")"), (Rows{}));
  EXPECT_EQ(rows("CONTAINS(?n, ?none)"), (Rows{}));
  EXPECT_EQ(rows("CONTAINS(STR(?n), \"1\") || CONTAINS(?n, \"g\")"), (Rows{"d"}));
  EXPECT_EQ(g.Rows("SELECT ?s { ?s ex:n ?n ; ex:part ?p FILTER(CONTAINS(?n, ?p)) } ORDER BY ?s", {}, true),
            (Rows{"a", "b"}));
  EXPECT_EQ(
      g.Rows("SELECT ?s { ?s ex:n ?n BIND(CONCAT(?n, \"x\") AS ?x) FILTER(STRENDS(?x, \"cx\")) } ORDER BY ?s",
             {}, true),
      (Rows{"a", "b", "g"}));
}

// Keys of all kinds, in both directions: decided by ids, and by values.
TEST(SparqlOperators, FirstRowsOfMixedKeysAreThoseOfAWholeSort) {
  std::string data;
  const char* const values[] = {
      "%",     "%.0",  "\"0%\"^^xsd:integer", "\"%.5E0\"^^xsd:double",    "\"%\"", "\"%\"@en",
      "ex:v%", "_:b%", "\"NaN\"^^xsd:double", "\"20%%-01-01\"^^xsd:date", "true",  "\"%.25\"^^xsd:float"};
  for (int i = 0; i < 600; ++i) {
    std::string value = values[i * 7 % 12];
    for (size_t at; (at = value.find('%')) != std::string::npos;)
      value.replace(at, 1, std::to_string(10 + i * 31 % 80));
    data += "ex:s" + std::to_string(i) + " ex:v " + value + " . ex:s" + std::to_string(i) + " ex:w " +
            std::to_string(i % 5) + " .\n";
  }
  TestGraph g(data);
  for (const char* order : {"?v", "DESC(?v)", "?w DESC(?v)", "DESC(?w) ?v", "?none ?v", "STR(?v) ?w",
                            "DESC(?w + 1) STRLEN(STR(?v)) ?v", "DESC(?copy) ?w"}) {
    const std::string query =
        std::string(
            "SELECT ?s ?v { ?s ex:v ?v ; ex:w ?w BIND(CONCAT(STR(?v), STR(?w)) AS ?copy) } ORDER BY ") +
        order;
    const std::vector<std::string> all = g.Rows(query, {}, true);
    ASSERT_EQ(all.size(), 600u);
    for (const size_t limit : {1, 3, 70, 200, 599}) {
      EXPECT_EQ(g.Rows(query + " LIMIT " + std::to_string(limit), {}, true),
                std::vector<std::string>(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(limit)))
          << query;
    }
  }
}

TEST(SparqlOperators, FirstRowsNeedTheMemoryOfTheFirstRowsOnly) {
  TestGraph g(People(3000));
  PrepareOptions little;
  little.memory_bytes = 20000;
  EXPECT_EQ(g.Rows("SELECT ?a { ?a ex:age ?x } ORDER BY ?x LIMIT 3", little).size(), 3u);
}

// If a hash table is much larger than an older version's counts promised, the table is given up, not the
// query.
TEST(SparqlOperators, APatternThatGrewSinceThePlanIsLookedUp) {
  std::string small, more;
  for (int i = 0; i < 3000; ++i) {
    const std::string n = std::to_string(i);
    small += "ex:a" + n + " ex:q ex:b" + n + " .\n";
    more += "ex:b" + n + " ex:p ex:c" + n + " .\n";
  }
  TestGraph g(small + "ex:b0 ex:p ex:c0 . ex:b1 ex:p ex:c1 .");
  PrepareOptions little;
  little.memory_bytes = 60000;
  const auto query = g.Prepare("SELECT ?c { ?a ex:q ?b OPTIONAL { ?b ex:p ?c } }", little);
  for (const int wanted : {2, 2900}) {
    if (wanted > 2) g.Add(more.substr(0, more.find("ex:b2900 ")));
    int found = 0;
    const absl::Status status = query->Select(g.Run(), {}, [&](absl::Span<const TermId> row) {
      found += row[0].IsNone() ? 0 : 1;
      return true;
    });
    EXPECT_TRUE(status.ok()) << status;
    EXPECT_EQ(found, wanted);
  }
}

TEST(SparqlOperators, PathsBetweenKnownAndUnknownEnds) {
  TestGraph g("ex:a ex:p ex:b . ex:b ex:p ex:c . ex:c ex:p ex:a . ex:x ex:p ex:y . ex:b ex:q ex:z .");
  EXPECT_TRUE(g.Ask("ASK { ex:a ex:p+ ex:a }"));
  EXPECT_TRUE(g.Ask("ASK { ex:a ex:p+ ex:c }"));
  EXPECT_FALSE(g.Ask("ASK { ex:a ex:p+ ex:y }"));
  EXPECT_FALSE(g.Ask("ASK { ex:x ex:p+ ex:x }"));
  EXPECT_TRUE(g.Ask("ASK { ex:x ex:p* ex:x }"));
  EXPECT_TRUE(g.Ask("ASK { ex:nowhere ex:p* ex:nowhere }"));
  EXPECT_TRUE(g.Ask("ASK { ex:a (ex:p|ex:q)+ ex:z }"));
  EXPECT_TRUE(g.Ask("ASK { ex:z ^(ex:p|ex:q)+ ex:c }"));
  EXPECT_FALSE(g.Ask("ASK { ex:z (ex:p|ex:q)+ ex:c }"));
  EXPECT_EQ(g.Rows("SELECT * { ?s ex:p+ ?o }").size(), 10u);        // 3 x 3 of the ring, x to y
  EXPECT_EQ(g.Rows("SELECT * { ?s (ex:p/ex:q)+ ?o }").size(), 1u);  // a to z
  EXPECT_EQ(g.Rows("SELECT * { ?s ^ex:p+ ?o }").size(), 10u);
  EXPECT_EQ(g.Rows("SELECT * { ?s ex:q* ?o }").size(), 7u);  // each node to itself, b to z
  EXPECT_EQ(g.Rows("SELECT * { ?s (ex:q+)? ?o }").size(), 7u);
  EXPECT_EQ(g.Rows("SELECT * { ?s (ex:p+|ex:q)+ ?o }"), g.Rows("SELECT * { ?s (ex:p|ex:q)+ ?o }"));
}

TEST(SparqlOperators, ClosuresInsideClosuresAreOneSearch) {
  TestGraph g(People(3000));
  Cancellation soon(std::chrono::milliseconds(5000));
  RunOptions run = g.Run();
  run.cancellation = &soon;
  size_t rows = 0;
  const auto query = g.Prepare("SELECT ?x { ex:p0 (((ex:knows+)*)+|(ex:knows*)?)* ?x }");
  EXPECT_TRUE(query->Select(run, {}, [&](absl::Span<const TermId>) { return ++rows > 0; }).ok());
  EXPECT_EQ(rows, 3000u);
}

TEST(SparqlOperators, CountsSumsAndDistinctOfIds) {
  TestGraph g(People(100) + "ex:p5 ex:age 2.5 .");
  EXPECT_EQ(g.Rows("SELECT (COUNT(?x) AS ?n) (SUM(?x) AS ?s) { ?p ex:age ?x }"),
            std::vector<std::string>{"101 4952.5"});
  EXPECT_EQ(g.Rows("SELECT (COUNT(DISTINCT ?b) AS ?n) { ?p ex:at ?b }"), std::vector<std::string>{"10"});
  EXPECT_EQ(g.Rows("SELECT (AVG(?x) AS ?m) { ?p ex:age ?x FILTER(?x != 2.5) }"),
            std::vector<std::string>{"49.5"});
  EXPECT_EQ(g.Rows("SELECT DISTINCT ?b { ?p ex:at ?b }").size(), 10u);
  EXPECT_EQ(g.Rows("SELECT ?b (COUNT(*) AS ?n) { ?p ex:at ?b } GROUP BY ?b").size(), 10u);
}

// If only the number of rows matters, they are not produced: for a pattern, a join, a union; in one graph and
// in several.
TEST(SparqlOperators, RowsAreCountedWithoutMakingThem) {
  TestGraph g(People(2000) + Likes(2000) +
              "ex:p1 ex:twin ex:p1 . ex:p2 ex:twin ex:p1 . ex:g { ex:p1 ex:at ex:B1 . ex:p7 ex:at ex:B1 }");
  using Rows = std::vector<std::string>;
  const std::string count = "SELECT (COUNT(*) AS ?n) ";
  EXPECT_EQ(g.Rows(count + "{ ?p ex:at ?b }"), Rows{"2001"});  // the same triple in two graphs is one
  EXPECT_EQ(g.Rows(count + "{ GRAPH ?g { ?p ex:at ?b } }"), Rows{"2002"});
  EXPECT_EQ(g.Rows(count + "FROM ex:g { ?p ex:at ?b }"), Rows{"2"});
  EXPECT_EQ(g.Rows(count + "{ ?p ex:at ?b }", {.default_graph = DefaultGraph::kStrict}), Rows{"2000"});
  EXPECT_EQ(g.Rows(count + "{ ?p ex:twin ?p }"), Rows{"1"});
  EXPECT_EQ(g.Rows(count + "{ ?p ex:unknown ?b }"), Rows{"0"});
  EXPECT_EQ(
      g.Rows("SELECT (COUNT(?a) AS ?n) (COUNT(*) AS ?m) { ?a ex:likes ?b . ?b ex:likes ?c . ?c ex:at ?d }"),
      Rows{"2001 2001"});
  EXPECT_EQ(g.Rows("SELECT (COUNT(?p) AS ?n) (COUNT(?q) AS ?m) (COUNT(*) AS ?k) { { ?p ex:at ex:B3 } UNION { "
                   "?q ex:at ex:B4 . ?q ex:age ?a } }"),
            Rows{"200 200 400"});
  EXPECT_EQ(g.Rows(count + "{ ?p ex:at ex:B3 FILTER(?p != ex:p3) }"), Rows{"199"});
  EXPECT_EQ(g.Rows("SELECT ?b ?n { VALUES ?b { ex:B3 ex:B77 } { SELECT (COUNT(*) AS ?n) { ?p ex:at ?c } } }"),
            (Rows{"B3 2001", "B77 2001"}));
  EXPECT_EQ(g.Rows(count + "FROM ex:g FROM <https://w3id.org/docent#default> { ?p ex:at ?b }"), Rows{"2001"});
  EXPECT_EQ(g.Rows(count + "FROM NAMED ex:g { GRAPH ?g { ?p ex:at ?b } }"), Rows{"2"});
}

TEST(SparqlOperators, ExplainSaysWhichPathsConditionsAndValues) {
  TestGraph g;
  const std::string plan = g.Prepare(
                                "SELECT ?c { ?a ex:knows/ex:likes* ?b . ?b ex:age ?n FILTER(?n > 1 && EXISTS "
                                "{ ?b ex:at ?x }) BIND(?n + 1 AS ?c) }")
                               ->Explain(*g.version);
  EXPECT_THAT(plan, ::testing::HasSubstr("path ?_p0 (<http://example.org/likes>)* ?b"));
  EXPECT_THAT(plan, ::testing::HasSubstr("if (?n > 1)"));
  EXPECT_THAT(plan, ::testing::HasSubstr("if EXISTS {"));
  EXPECT_THAT(plan, ::testing::HasSubstr("extend ?c := (?n + 1)"));
}

TEST(SparqlOperators, ExplainSaysWhatWasEstimatedAndWhatCame) {
  TestGraph g(People(50));
  const auto query =
      g.Prepare("SELECT ?a { ?a ex:at ex:B1 . ?a ex:age ?x FILTER(?x > 10) } ORDER BY ?x LIMIT 2");
  const auto plan = query->ExplainRun(g.Run());
  ASSERT_TRUE(plan.ok());
  EXPECT_NE(plan->find("order, first 2"), std::string::npos) << *plan;
  EXPECT_NE(plan->find("1 condition"), std::string::npos) << *plan;
  EXPECT_NE(plan->find("| 2 rows"), std::string::npos) << *plan;
  EXPECT_LT(plan->find("B1"), plan->find("age"));
  EXPECT_EQ(query->Explain(*g.version).find("| "), std::string::npos);
  // measuring does not change the results of later runs
  size_t rows = 0;
  EXPECT_TRUE(query->Select(g.Run(), {}, [&](absl::Span<const TermId>) { return ++rows > 0; }).ok());
  EXPECT_EQ(rows, 2u);
}

}  // namespace
}  // namespace docent::sparql
