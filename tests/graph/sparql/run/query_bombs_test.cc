// Queries that would take endless time or all memory: each ends at its limit and names it, and the next run
// of the same prepared query has all its memory again.
#include <gtest/gtest.h>

#include <chrono>

#include "graph/base/memory_budget.h"
#include "graph/sparql/syntax/algebra_walk.h"
#include "tests/graph/sparql/test_graph.h"

namespace docent::sparql {
namespace {

class QueryBombs : public testing::Test {
 protected:
  QueryBombs() {
    std::string text;
    for (int i = 0; i < 300; ++i) {
      text += "ex:n" + std::to_string(i) + " ex:p ex:n" + std::to_string(i * 7 % 300) + " , ex:n" +
              std::to_string((i + 1) % 300) + " ; ex:name \"" + std::string(200, 'a') + std::to_string(i) +
              "\" .\n";
    }
    g_.Add(text);
  }

  absl::Status Run(const std::string& text, int timeout_ms,
                   size_t memory_bytes = Limits{}.query_memory_bytes) {
    PrepareOptions options;
    options.memory_bytes = memory_bytes;
    const auto query = g_.Prepare(text, options);
    Cancellation cancellation{std::chrono::milliseconds(timeout_ms)};
    RunOptions run = g_.Run();
    run.cancellation = &cancellation;
    const auto begun = std::chrono::steady_clock::now();
    const absl::Status status = query->Select(run, {}, [](absl::Span<const TermId>) { return true; });
    took_ = std::chrono::steady_clock::now() - begun;
    return status;
  }
  void ExpectTimeout(const std::string& text) {
    const absl::Status status = Run(text, 100);
    EXPECT_EQ(status.code(), absl::StatusCode::kDeadlineExceeded) << text << status;
    EXPECT_NE(status.message().find("query_timeout_ms = 100"), std::string::npos) << status;
    EXPECT_LT(took_, std::chrono::seconds(20)) << text;
  }
  // Has no solution, which is known only after the whole product.
  const std::string kNever =
      "?d ?e ?f . ?g ?h ?i . ?j ?k ?l FILTER(STRLEN(STR(?d)) + STRLEN(STR(?g)) + STRLEN(STR(?j)) < 0)";

  void ExpectMemory(const std::string& text, size_t limit = 100000) {
    const absl::Status status = Run(text, 30000, limit);
    EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted) << text << status;
    EXPECT_NE(status.message().find("query_memory_bytes = " + std::to_string(limit)), std::string::npos)
        << status;
  }

  TestGraph g_;
  std::chrono::steady_clock::duration took_{};
};

TEST_F(QueryBombs, EndAtTheTimeLimit) {
  ExpectTimeout("SELECT * { ?a ?b ?c . ?d ?e ?f . ?g ?h ?i . ?j ?k ?l }");
  ExpectTimeout(
      "SELECT (COUNT(*) AS ?n) { ?a ex:p ?b . ?c ex:p ?d . ?e ex:p ?f . ?g ex:p ?h FILTER(?a < ?h || ?b < "
      "?c) }");
  ExpectTimeout("SELECT * { ?a ?b ?c FILTER EXISTS { " + kNever + " } }");
  ExpectTimeout("SELECT * { ?a ?b ?c OPTIONAL { " + kNever + " } }");
  ExpectTimeout("SELECT * { ?a (ex:p|!ex:q)* ?b . ?c (ex:p|!ex:q)* ?d . ?e (ex:p/ex:p/ex:p)+ ?f }");
  ExpectTimeout("SELECT ?x { { SELECT (COUNT(*) AS ?x) { ?a ?b ?c . ?d ?e ?f . ?g ?h ?i . ?j ?k ?l } } }");
  ExpectTimeout("ASK { " + kNever + " }");
}

TEST_F(QueryBombs, EndAtTheMemoryLimit) {
  ExpectMemory("SELECT DISTINCT * { ?a ?b ?c . ?d ?e ?f }");
  ExpectMemory("SELECT * { ?a ?b ?c . ?d ?e ?f } ORDER BY ?a ?f");
  ExpectMemory("SELECT ?a ?f (COUNT(*) AS ?n) { ?a ?b ?c . ?d ?e ?f } GROUP BY ?a ?f");
  ExpectMemory("SELECT (GROUP_CONCAT(?n) AS ?all) { ?a ex:name ?n . ?b ex:name ?m }");
  ExpectMemory("SELECT (COUNT(DISTINCT *) AS ?n) { ?a ?b ?c . ?d ?e ?f }");
  ExpectMemory("SELECT * { ?a ex:p ?b { SELECT ?x ?w { ?x ?q ?y . ?v ?w ?z } ORDER BY ?x } }");
  ExpectMemory("SELECT (CONCAT(?n, ?m, STR(?a), STR(?b)) AS ?x) { ?a ex:name ?n . ?b ex:name ?m }");
  ExpectMemory("SELECT * { ?a (ex:p|^ex:p)* ?b }", 2000);
}

// Values that are never encoded, or are one text, are counted, too.
TEST_F(QueryBombs, LongTextsEndAtTheMemoryLimit) {
  const auto times = [](const std::string& argument, int count) {
    std::string call = "CONCAT(" + argument;
    for (int i = 1; i < count; ++i) call += ", " + argument;
    return call + ")";
  };
  const std::string text = "?a ex:name ?x BIND(" + times("?x", 100) + " AS ?c)";  // 20 KB
  const size_t limit = 1'000'000;
  ExpectMemory("SELECT (STRLEN(" + times("?c", 100) + ") AS ?n) { " + text + " } LIMIT 1", limit);
  ExpectMemory("SELECT (STRLEN(" + times(times("?c", 10), 10) + ") AS ?n) { " + text + " } LIMIT 1", limit);
  ExpectMemory("SELECT (STRLEN(REPLACE(?c, \"a\", ?c)) AS ?n) { " + text + " } LIMIT 1", limit);
  std::string references;
  for (int i = 0; i < 100; ++i) references += "$1";
  ExpectMemory(
      "SELECT (STRLEN(REPLACE(?c, \"(a+)\", \"" + references + "\")) AS ?n) { " + text + " } LIMIT 1", limit);
  ExpectMemory("SELECT ?a (MAX(" + times("?x", 100) + ") AS ?m) { ?a ex:name ?x } GROUP BY ?a LIMIT 1",
               limit);
  ExpectMemory("SELECT (STRLANG(\"a\", CONCAT(\"x-\", " + times("?x", 100) + ")) AS ?y) { ?a ex:name ?x }",
               limit);
  // Queries within the limit are answered.
  for (const char* call :
       {"REPLACE(?c, \"b\", ?c)", "REPLACE(?c, \"0\", \"and so on\")", "UCASE(?c)", "CONCAT(?c, ?c)"}) {
    EXPECT_TRUE(
        Run("SELECT (STRLEN(" + std::string(call) + ") AS ?n) { " + text + " } LIMIT 5", 30000, limit).ok())
        << call;
  }
}

TEST_F(QueryBombs, RegularExpressionsDoNotBacktrack) {
  EXPECT_TRUE(Run("SELECT * { ?a ex:name ?n FILTER(REGEX(?n, \"^(a+)+(a|aa)*$\")) }", 10000).ok());
  EXPECT_LT(took_, std::chrono::seconds(5));
}

TEST_F(QueryBombs, MemoryIsGivenBackBetweenRuns) {
  PrepareOptions options;
  options.memory_bytes = 300000;
  const auto query = g_.Prepare("SELECT DISTINCT ?a ?c { ?a ex:p ?b . ?b ex:p ?c }", options);
  for (int i = 0; i < 50; ++i) {
    size_t rows = 0;
    ASSERT_TRUE(query->Select(g_.Run(), {}, [&](absl::Span<const TermId>) { return ++rows > 0; }).ok()) << i;
    ASSERT_GT(rows, 500u);
  }
}

TEST_F(QueryBombs, ManySearchesFromManyNodesDoNotAddUp) {
  // Each search keeps 300 nodes for a while; 300 of them one after the other must fit.
  EXPECT_TRUE(Run("SELECT (COUNT(*) AS ?n) { ?a ex:p+ ?b }", 30000, 200000).ok());
}

TEST_F(QueryBombs, TheStepsOfAPathEndAtTheMemoryLimit) {
  std::string text = "ex:a ex:to ex:o0";
  for (int i = 1; i < 20000; ++i) text += ", ex:o" + std::to_string(i);
  text += " .\n";
  for (int i = 0; i < 20000; ++i) text += "ex:o" + std::to_string(i) + " ex:end ex:z .\n";
  g_.Add(text);
  const std::string path = "SELECT * { ex:a (ex:to/ex:end)+ ?x }";  // one answer, over 20,000 nodes
  EXPECT_TRUE(Run(path, 30000, 2000000).ok());
  ExpectMemory(path, 200000);
  ExpectMemory("SELECT * { ex:a (!ex:no/ex:end)+ ?x }", 200000);
  ExpectMemory("ASK { ex:a ex:to+ ex:nowhere }", 200000);
}

TEST_F(QueryBombs, AllQueriesTogetherEndAtTheirLimit) {
  const std::string sorted = "SELECT * { ?a ex:p ?b . ?c ex:p ?d } ORDER BY ?a ?b ?c ?d";
  PrepareOptions options;
  size_t needed = 0;
  {
    MemoryBudget plenty("all_bytes", size_t{1} << 40);
    options.all_memory = &plenty;
    const auto query = g_.Prepare(sorted, options);
    ASSERT_TRUE(query->Start(g_.Run()).ok());
    ASSERT_TRUE(query->Next()) << query->status();
    needed = plenty.taken();
    EXPECT_GT(needed, 4u << 20);
  }
  MemoryBudget all("all_bytes", needed * 3 / 2);  // one fits, two do not
  options.all_memory = &all;
  const auto first = g_.Prepare(sorted, options), second = g_.Prepare(sorted, options);
  ASSERT_TRUE(first->Start(g_.Run()).ok());
  ASSERT_TRUE(first->Next()) << first->status();
  const auto run = [&] {
    return second->Select(g_.Run(), {}, [](absl::Span<const TermId>) { return true; });
  };
  const absl::Status refused = run();
  EXPECT_EQ(refused.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_NE(refused.message().find("all_bytes"), std::string::npos) << refused;
  first->Stop();
  EXPECT_TRUE(run().ok());
  second->Stop();
  EXPECT_EQ(all.taken(), 0u);
}

TEST_F(QueryBombs, AnExpressionKeepsNothing) {
  MemoryBudget all("all_bytes", 64u << 20);
  PrepareOptions options;
  options.all_memory = &all;
  const Query query = g_.Parse(
      "SELECT * { FILTER EXISTS { { SELECT DISTINCT ?a ?b ?c { ?a ex:p ?b . ?c ex:p ?d } } FILTER(?a = 7) } "
      "}");
  const Expression* filter = nullptr;
  AnyNode(*query.algebra, [&](const Algebra& node) {
    ForEachExpression(node, [&](const Expression& e) { filter = filter == nullptr ? &e : filter; });
    return filter != nullptr;
  });
  ASSERT_NE(filter, nullptr);
  auto expression = PreparedExpression::Prepare(*filter, {}, g_.dictionary, options);
  ASSERT_TRUE(expression.ok()) << expression.status();
  EXPECT_FALSE(*(*expression)->Test(g_.Run(), {}));
  EXPECT_EQ(all.taken(), 0u);
  MemoryBudget none("all_bytes", 0);
  options.all_memory = &none;
  expression = PreparedExpression::Prepare(*filter, {}, g_.dictionary, options);
  EXPECT_EQ((*expression)->Test(g_.Run(), {}).status().code(), absl::StatusCode::kResourceExhausted)
      << "it needs some";
}

TEST_F(QueryBombs, AHugeValuesBlockStreams) {
  std::string values = "SELECT * { VALUES ?x {";
  for (int i = 0; i < 50000; ++i) values += " " + std::to_string(i);
  EXPECT_TRUE(Run(values + " } ?a ex:p ?b }", 1).code() == absl::StatusCode::kDeadlineExceeded);
}

// Each of these words could be the beginning of a prefix with dots.
TEST_F(QueryBombs, ManyWordsWithDotsAreReadOnce) {
  for (const std::string word : {"a.", "a\\u0061.", "é.", "?a\\u0061 ", "_:a..", ":a.."}) {
    std::string text = "SELECT * { ";
    for (int i = 0; i < 50000; ++i) text += word;
    const auto begun = std::chrono::steady_clock::now();
    EXPECT_FALSE(ParseQuery(text).ok()) << word;
    EXPECT_LT(std::chrono::steady_clock::now() - begun, std::chrono::seconds(5)) << word;
  }
}

// Few rows are looked at between two looks at the clock, however long the expression of a row is.
TEST_F(QueryBombs, LongExpressionsEndAtTheTimeLimit) {
  const auto repeated = [](const std::string& first, const std::string& more, int times) {
    std::string text = first;
    for (int i = 0; i < times; ++i) text += more + std::to_string(i);
    return text;
  };
  const std::string rows = "SELECT (COUNT(*) AS ?n) { ?a ?b ?c . ?d ?e ?f ";
  for (const std::string& text :
       {rows + "FILTER(?c IN (" + repeated("-1", ",", 15000) + ")) }",
        rows + "FILTER(?c NOT IN (" + repeated("-1", ",", 15000) + ") && ?c = 1) }",
        rows + "FILTER(" + repeated("?c = -1", " || ?c = ", 3900) + ") }",
        rows + "FILTER(" + repeated("?c != -1", " && ?c != ", 3900) + " && ?c = -1) }",
        rows + "FILTER(" + repeated("STRLEN(STR(?c))", " + STRLEN(STR(?c)) + ", 1900) + " < 0) }",
        rows + "FILTER(COALESCE(" + repeated("?c + 1", ", ?c + ", 3900) + ")) }",
        rows + "FILTER(STRLEN(CONCAT(" + repeated("STR(?c)", ", STR(?d), ", 3000) + ")) < 0) }",
        rows + "BIND(" + repeated("?c + 1", " + ", 3900) + " AS ?x) }"}) {
    const absl::Status status = Run(text, 200);
    EXPECT_EQ(status.code(), absl::StatusCode::kDeadlineExceeded) << text.substr(0, 120) << status;
    EXPECT_LT(took_, std::chrono::milliseconds(1500)) << text.substr(0, 120);
  }
}

// One row, and one call that would take endless time or the time of many.
class TextBombs : public QueryBombs {
 protected:
  // ?a0 … ?a<n>: `first` doubled n times.
  static std::string Doubled(const std::string& first, int n) {
    std::string text = "BIND(\"" + first + "\" AS ?a0)";
    for (int i = 1; i <= n; ++i) {
      const std::string last = "?a" + std::to_string(i - 1);
      text += " BIND(CONCAT(" + last + "," + last + ") AS ?a" + std::to_string(i) + ")";
    }
    return text;
  }
  // Ends soon after a limit of 200 ms that `text` reaches, or earlier.
  void ExpectSoon(const std::string& text, bool timeout) {
    const absl::Status status = Run(text, 200);
    EXPECT_LT(took_, std::chrono::seconds(5)) << text.substr(0, 80);
    if (!timeout) return;
    EXPECT_EQ(status.code(), absl::StatusCode::kDeadlineExceeded) << text.substr(0, 80) << status;
    EXPECT_NE(status.message().find("query_timeout_ms = 200"), std::string::npos) << status;
  }
};

TEST_F(TextBombs, ASearchForATextIsLinear) {
  const std::string half = "CONCAT(SUBSTR(?a20,1,4000000),\"b\")";
  for (const std::string name : {"CONTAINS", "STRBEFORE", "STRAFTER"}) {
    ExpectSoon(
        "SELECT (STRLEN(STR(" + name + "(?a20," + half + "))) AS ?x) {" + Doubled("aaaaaaaa", 20) + "}",
        false);
  }
}

TEST_F(TextBombs, ManyCallsOnALongTextEndAtTheTimeLimit) {
  const std::vector<std::string> calls = {"CONTAINS(?a20,CONCAT(SUBSTR(?a20,1,4000000),\"b\"))",
                                          "STRLEN(?a20)",
                                          "UCASE(?a20)",
                                          "LCASE(?a20)",
                                          "SUBSTR(?a20,4000000)",
                                          "ENCODE_FOR_URI(?a20)",
                                          "CONCAT(?a20,?a19)",
                                          "MD5(?a20)",
                                          "SHA1(?a20)",
                                          "SHA256(?a20)",
                                          "SHA384(?a20)",
                                          "SHA512(?a20)",
                                          "REGEX(?a20,\"c|b$\")",
                                          "REPLACE(?a20,\"c\",\"b\")",
                                          "STRSTARTS(?a20,?a19)",
                                          "STRENDS(?a20,?a19)",
                                          "STRDT(?a20,xsd:decimal)",
                                          "STRLANG(?a20,\"en\")",
                                          "xsd:integer(?a20)",
                                          "xsd:double(?a20)",
                                          "xsd:string(?a20)",
                                          "IRI(?a20)",
                                          "BNODE(?a20)",
                                          "LANGMATCHES(?a20,?a19)",
                                          "(?a20 < CONCAT(?a20,\"\"))",
                                          "(?a20 = CONCAT(?a20,\"\"))",
                                          "(?a20 IN (?a19, ?a18, ?a20))",
                                          "sameTerm(?a20,CONCAT(?a20,\"\"))",
                                          "STR(?a20)",
                                          "DATATYPE(?a20)"};
  for (const std::string& call : calls) {
    ExpectSoon("SELECT * {" + Doubled("aaaaaaaa", 20) + " ?a ex:p ?b . ?c ex:p ?d FILTER(STRLEN(STR(" + call +
                   ")) < 0) }",
               true);
  }
}

TEST_F(TextBombs, ManyCallsInOneRowEndAtTheTimeLimit) {
  std::string text = "SELECT * {" + Doubled("aaaaaaaa", 20) + " FILTER(STRLEN(?a0) = 8";
  for (int i = 0; i < 900; ++i) text += " && STRLEN(MD5(?a20)) = 32";
  ExpectSoon(text + ")}", true);
}

TEST_F(TextBombs, ReplaceEndsAtTheTimeLimit) {
  std::string text = "SELECT * { BIND(\"aaaaaaaa\" AS ?a0)";
  for (int i = 1; i <= 24; ++i) {
    text += " BIND(REPLACE(?a" + std::to_string(i - 1) + ",\"a\",\"aa\") AS ?a" + std::to_string(i) + ")";
  }
  ExpectSoon(text + "}", true);
  // Each match reads all the text after it.
  ExpectSoon("SELECT (REPLACE(?a18,\"a(.*z)?\",\"b\") AS ?x) {" + Doubled("aaaaaaaa", 18) + "}", true);
}

TEST_F(TextBombs, SortedAndAggregatedLongTextsEndAtTheTimeLimit) {
  const std::string rows = "{" + Doubled("aaaaaaaa", 16) + " ?a ex:p ?b BIND(CONCAT(?a16,STR(?b)) AS ?t) }";
  for (const std::string& query :
       {"SELECT ?a " + rows + " ORDER BY ?t", "SELECT (MAX(?t) AS ?m) " + rows, "SELECT DISTINCT ?t " + rows,
        "SELECT (GROUP_CONCAT(?a16) AS ?m) " + rows}) {
    ExpectSoon(query, false);
  }
}

// Each comparison of a back-reference reads as much as the group has, and counts so, with and without flag i.
TEST_F(TextBombs, BackReferencesEndAtTheirLimits) {
  std::string alternatives;
  for (int i = 0; i < 3000; ++i)
    alternatives += (i == 0 ? "\\\\1" : "|\\\\1") + std::string(1, "bcdefghijk"[i % 10]);
  for (const char* flags : {"i", ""}) {
    const absl::Status status =
        Run("SELECT ?n {" + Doubled("aaaaaaaa", 18) + "BIND(CONCAT(?a18,\"x\",?a18,\"x\") AS ?t)" +
                "BIND(REGEX(?t,\"^(a*x)(" + alternatives + ")$\",\"" + flags + "\") AS ?n) }",
            200);
    EXPECT_TRUE(absl::IsDeadlineExceeded(status) || absl::IsResourceExhausted(status)) << status;
  }
}

TEST_F(TextBombs, ComparedTextCountsInSteps) {
  const auto query = g_.Prepare("SELECT ?n {" + Doubled("aaaaaaaa", 14) +
                                "BIND(REGEX(CONCAT(?a14,\"x\",?a14),\"^(a*)x\\\\1b\",\"i\") AS ?n) }");
  Cancellation cancellation;
  cancellation.AllowSteps(1'000'000'000);
  RunOptions run = g_.Run();
  run.cancellation = &cancellation;
  ASSERT_TRUE(query->Select(run, {}, [](absl::Span<const TermId>) { return true; }).ok());
  EXPECT_LT(cancellation.steps_left(), 1'000'000'000 - 100'000);
}

// A run of few rows counts, too, and each row as what its expressions cost.
TEST_F(QueryBombs, ShortRunsCountInSteps) {
  const auto steps_of = [&](const std::string& text) {
    const auto query = g_.Prepare(text);
    Cancellation cancellation;
    cancellation.AllowSteps(1'000'000'000);
    RunOptions run = g_.Run();
    run.cancellation = &cancellation;
    for (int i = 0; i < 100; ++i) EXPECT_TRUE(query->Ask(run).ok());
    return 1'000'000'000 - cancellation.steps_left();
  };
  const int64_t plain = steps_of("ASK { ?a ex:p ?b FILTER(?b = ex:none) }");
  const int64_t computed =
      steps_of("ASK { ?a ex:name ?n FILTER(STRLEN(?n) * 3 + 1 - STRLEN(?n) * 2 < 0 && true) }");
  EXPECT_GT(plain, 100 * 300);
  EXPECT_GT(computed, 100 * 300 * 20);
}

// Each text of a GROUP_CONCAT grows and is given on without a copy that is not counted.
TEST_F(QueryBombs, LongGroupsAreCountedOnce) {
  const std::string text = "SELECT (STRLEN(GROUP_CONCAT(?n)) AS ?l) { ?a ex:name ?n . ?b ex:p ?c }";  // 36 MB
  EXPECT_EQ(Run(text, 30000, 60u << 20).code(), absl::StatusCode::kResourceExhausted);
  EXPECT_TRUE(Run(text, 30000, 256u << 20).ok());
}

// Thousands of steps for each byte.
TEST_F(TextBombs, LargeRegularExpressionsOnLongTextsAreRefused) {
  const std::string text = "SELECT (1 AS ?x) {" + Doubled("abaabbab", 18);
  for (const std::string call :
       {"REGEX(?a18,\"(a|b)*a(a|b){1000}c\")", "REGEX(?a18,\"((a|b){1000}(b|a){1000}c?)+d\")",
        "(REPLACE(?a18,\"((a|b){1000})+\",\"$1\") = \"\")"}) {
    const absl::Status status =
        Run(text + " FILTER" + (call[0] == '(' ? call : "(" + call + ")") + "}", 30000);
    EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted) << call << status;
    EXPECT_TRUE(status.message().find("regex_steps = ") != std::string::npos ||
                status.message().find("query_memory_bytes = ") != std::string::npos)
        << status;
    EXPECT_LT(took_, std::chrono::seconds(10)) << call;
  }
  EXPECT_TRUE(Run(text + " FILTER(REGEX(?a18,\"(a|b)*a(a|b){5}c\"))}", 30000).ok());
  EXPECT_TRUE(
      g_.Ask("ASK { FILTER(REGEX(\"abaab\",\"(a|b)*a(a|b){2}$\") && REGEX(\"abc\", \"(a|b){1000}|c\")) }"));
}

}  // namespace
}  // namespace docent::sparql
