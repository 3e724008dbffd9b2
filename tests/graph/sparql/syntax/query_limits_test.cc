// The limits of the parts of a text, at the limit and one past it, and the words that need no space.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "graph/base/cancellation.h"
#include "graph/base/memory_budget.h"
#include "graph/sparql/syntax/parser.h"

namespace docent::sparql {
namespace {

using testing::HasSubstr;

std::string Times(const std::string& text, size_t times) {
  std::string out;
  for (size_t i = 0; i < times; ++i) out += text;
  return out;
}

ParseOptions Few() {
  ParseOptions options;
  options.query_limits = {.query_patterns = 10,
                          .query_path_steps = 10,
                          .query_list_elements = 10,
                          .query_values = 10,
                          .update_operations = 10};
  return options;
}

void ExpectLimit(const absl::Status& status, const std::string& name) {
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted) << status;
  EXPECT_THAT(std::string(status.message()), HasSubstr(name + " = 10"));
}

absl::Status Query(const std::string& text) {
  return ToStatus(ParseQuery(text, Few()), text);
}

absl::Status Update(const std::string& text) {
  return ToStatus(ParseUpdate(text, Few()), text);
}

// `more` is allowed as many times, and not once more.
void ExpectTenQueries(const std::string& first, const std::string& more, const std::string& last,
                      const std::string& name, size_t times = 10) {
  EXPECT_TRUE(Query(first + Times(more, times) + last).ok()) << Query(first + Times(more, times) + last);
  ExpectLimit(Query(first + Times(more, times + 1) + last), name);
}

TEST(QueryLimits, PatternsOfAQuery) {
  ExpectTenQueries("ASK {", "?s ?p ?o .", "}", "query_patterns");
  ExpectTenQueries("ASK {", "?s ?p ?o ; ?q ?o .", "}", "query_patterns", 5);
  ExpectTenQueries("ASK { ?s ?p 0", ", 1", " }", "query_patterns", 9);
  ExpectTenQueries("ASK { {}", "UNION {}", "}", "query_patterns");
  ExpectTenQueries("ASK {", "GRAPH ?g {}", "}", "query_patterns");
  ExpectTenQueries("CONSTRUCT WHERE {", "?s ?p ?o .", "}", "query_patterns");
  ExpectTenQueries("ASK { ?s (<u:p>/<u:q>) 0", ", 1", " }", "query_patterns", 4);
  EXPECT_TRUE(Query("CONSTRUCT {" + Times("?s ?p ?o .", 11) + "} { ?s ?p ?o }").ok()) << "a template is none";
}

TEST(QueryLimits, StepsOfPaths) {
  ExpectTenQueries("ASK { ?s (<u:p>", "|<u:p>", ")* ?o }", "query_path_steps", 8);
  ExpectTenQueries("ASK { ?s (<u:p>", "/<u:p>", ")* ?o }", "query_path_steps", 8);
  ExpectTenQueries("ASK { ?s !(<u:p>", "|^<u:p>", ") ?o }", "query_path_steps", 8);
}

TEST(QueryLimits, MembersOfLists) {
  ExpectTenQueries("ASK { FILTER(1 IN (1", ",1", ")) }", "query_list_elements", 9);
  ExpectTenQueries("ASK { FILTER(1 NOT IN (1", ",1", ")) }", "query_list_elements", 9);
  ExpectTenQueries("ASK { FILTER(1 = 1", "|| 1 = 1", ") }", "query_list_elements");
  ExpectTenQueries("ASK { FILTER(1 = 1", "&& 1 = 1", ") }", "query_list_elements");
  ExpectTenQueries("ASK { BIND(CONCAT(\"\"", ",\"\"", ") AS ?x) }", "query_list_elements", 9);
}

TEST(QueryLimits, ValuesOfAQuery) {
  ExpectTenQueries("ASK { VALUES ?x {", " 1", "} }", "query_values");
  ExpectTenQueries("ASK { VALUES ?x {", " UNDEF", "} }", "query_values");
  ExpectTenQueries("ASK { VALUES (?x ?y) {", " (1 2)", "} }", "query_values", 4);
  ExpectTenQueries("ASK { VALUES () {", " ()", "} }", "query_values");
  ExpectTenQueries("ASK {} VALUES ?x {", " 1", "}", "query_values");
}

TEST(QueryLimits, OperationsOfAnUpdate) {
  EXPECT_TRUE(Update(Times("CLEAR ALL;", 10)).ok());
  ExpectLimit(Update(Times("CLEAR ALL;", 11)), "update_operations");
}

TEST(QueryLimits, EachOperationCountsForItself) {
  const std::string one = "INSERT { ?s ?p 1 } WHERE {" + Times("?s ?p ?o .", 10) + "};";
  EXPECT_TRUE(Update(Times(one, 5)).ok());
  ExpectLimit(Update("INSERT { ?s ?p 1 } WHERE {" + Times("?s ?p ?o .", 11) + "}"), "query_patterns");
  EXPECT_TRUE(Update("INSERT DATA {" + Times("<u:a> <u:b> 1 .", 20) + "}").ok());
}

TEST(QueryLimits, JoinedOperandsAreElements) {
  ParseOptions options;
  options.limits.query_elements = 10;
  for (const std::string more :
       {"{ ?a ?b ?c OPTIONAL {} }", "?a <u:p>* ?b .", "VALUES ?x { 1 }", "GRAPH ?g { ?a ?b ?c }"}) {
    EXPECT_TRUE(ParseQuery("ASK {" + Times(more, 5) + "}", options).ok()) << more;
    const ParsedQuery refused = ParseQuery("ASK {" + Times(more, 11) + "}", options);
    ASSERT_FALSE(refused.ok()) << more;
    EXPECT_THAT(refused.diagnostics[0].message, HasSubstr("query_elements = 10")) << more;
    EXPECT_EQ(ToStatus(refused, "").code(), absl::StatusCode::kResourceExhausted) << more;
  }
  std::string select = "SELECT (1 AS ?a0)";
  for (int i = 1; i < 11; ++i) select += "(1 AS ?a" + std::to_string(i) + ")";
  EXPECT_FALSE(ParseQuery(select + "{}", options).ok()) << "each is a node over the one before";
}

// So that a client can tell it from a mistake.
TEST(QueryLimits, WhatIsPastALimitIsResourceExhaustedWhateverTheLimit) {
  ParseOptions options;
  options.limits.query_nesting = 10;
  options.limits.query_elements = 10;
  options.limits.query_text_bytes = 1000;
  options.limits.update_text_bytes = 30000;
  const auto code_of = [](const auto& parsed) { return ToStatus(parsed, "").code(); };
  for (const std::string& query :
       {"ASK " + Times("{", 30) + Times("}", 30), "ASK { FILTER(" + Times("!", 30) + "true) }",
        "ASK { FILTER(" + Times("1 + ", 30) + "1) }", "ASK {" + Times(" ", 1000) + "}"}) {
    EXPECT_EQ(code_of(ParseQuery(query, options)), absl::StatusCode::kResourceExhausted) << query;
  }
  for (const std::string& update :
       {"INSERT DATA {" + Times("<u:a><u:a>1.", 2400) + "}", std::string(30001, ' '),
        "PREFIX p: <u:" + Times("p", 3000) + "> INSERT DATA { p:a p:b " + Times("p:c,", 5000) + "p:c }"}) {
    EXPECT_EQ(code_of(ParseUpdate(update, options)), absl::StatusCode::kResourceExhausted)
        << update.substr(0, 40);
  }
  EXPECT_EQ(code_of(ParseQuery("ASK {", options)), absl::StatusCode::kInvalidArgument);
}

TEST(QueryLimits, MemoryIsTheRequests) {
  MemoryUse memory(1 << 20);
  ParseOptions options;
  options.memory = &memory;
  const std::string text = "ASK { FILTER(1 IN (1" + Times(",1", 20000) + ")) }";
  const ParsedQuery parsed = ParseQuery(text, options);
  EXPECT_EQ(ToStatus(parsed, text).code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(parsed.diagnostics[0].message, HasSubstr("query_memory_bytes"));
  MemoryUse more(64 << 20);
  options.memory = &more;
  EXPECT_TRUE(ParseQuery(text, options).ok());
  EXPECT_GT(more.used(), 20000 * sizeof(Expression));
}

TEST(QueryLimits, CancellationEndsTheParser) {
  Cancellation cancellation;
  cancellation.Cancel();
  ParseOptions options;
  options.cancellation = &cancellation;
  const std::string text =
      "ASK { " + Times("# a comment that is read\n", 5) + Times("?s ?p ?o .", 5000) + " }";
  EXPECT_EQ(ToStatus(ParseQuery(text, options), text).code(), absl::StatusCode::kCancelled);
}

// SPARQL 1.1 section 19.3: white space is needed only where two terminals could be read as one.
TEST(QueryLimits, KeywordsNeedNoSpaceBetweenThem) {
  for (const char* text :
       {"SELECT * { ?a ?b ?c } LIMIT1", "SELECT * { ?a ?b ?c } LIMIT1OFFSET2", "SELECT*{?a ?b ?c}ORDERBY?a",
        "SELECT*{?a ?b ?c}orderby?a limit5", "SELECTDISTINCT?a{?a ?b ?c}GROUPBY?a",
        "ASK{?a ?b ?c FILTER(?a NOTIN(1,2))}", "ASK{?a ?b ?c FILTERNOTEXISTS{?a ?b 1}}",
        "ASK{?a ?b ?c FILTERREGEX(STR(?a),\"x\")}", "ASKWHERE{}", "ASK{VALUES?x{truefalse UNDEFUNDEF}}",
        "SELECT?a FROMNAMED<u:g>{GRAPH?g{?a ?b ?c}}", "SELECT(COUNT(*)AS?n){?a ?b ?c}HAVINGCOUNT(*)"}) {
    const ParsedQuery parsed = ParseQuery(text);
    EXPECT_TRUE(parsed.ok()) << text << "\n" << Render(parsed.diagnostics, text);
  }
  for (const char* text : {"INSERTDATA{<u:a><u:b>1}", "DELETEWHERE{?a ?b ?c}", "CLEARSILENTALL",
                           "COPYSILENTDEFAULTTO<u:g>", "LOADSILENT<u:d>INTOGRAPH<u:g>"}) {
    const ParsedUpdate parsed = ParseUpdate(text);
    EXPECT_TRUE(parsed.ok()) << text << "\n" << Render(parsed.diagnostics, text);
  }
  for (const char* text :
       {"SELECT * {} LIMITED", "SELECT * {} LIMIT1e5", "SELECTED * {}", "ASK { ?a ?b ?c } ORDERED"}) {
    EXPECT_FALSE(ParseQuery(text).ok()) << text;
  }
}

}  // namespace
}  // namespace docent::sparql
