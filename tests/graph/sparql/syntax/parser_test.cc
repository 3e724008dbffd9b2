#include "graph/sparql/syntax/parser.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "graph/sparql/syntax/algebra_printer.h"

namespace docent::sparql {
namespace {

using testing::HasSubstr;

ParsedQuery Parse(const std::string& text) {
  ParseOptions options;
  options.prefixes = {{"ex", "http://example.org/"}};
  return ParseQuery(text, options);
}

std::string AlgebraOf(const std::string& text) {
  const ParsedQuery parsed = Parse(text);
  EXPECT_TRUE(parsed.ok()) << Render(parsed.diagnostics, text);
  return parsed.ok() ? PrintAlgebra(*parsed.query.algebra) : "";
}

Diagnostics ErrorsOf(const std::string& text) {
  const ParsedQuery parsed = Parse(text);
  EXPECT_FALSE(parsed.ok()) << text;
  return parsed.diagnostics;
}

TEST(SparqlParser, TriplesWithAbbreviations) {
  EXPECT_EQ(
      AlgebraOf("ASK { ?s a ex:C ; ex:p 1, 2.5 . }"),
      "(bgp (?s a <http://example.org/C>) (?s <http://example.org/p> 1) (?s <http://example.org/p> 2.5))");
}

TEST(SparqlParser, AFilterDoesNotSplitItsPattern) {
  EXPECT_EQ(AlgebraOf("ASK { ?s ex:p ?o . FILTER(?o > 1) ?o ex:q ?z }"),
            "(filter (?o > 1) (bgp (?s <http://example.org/p> ?o) (?o <http://example.org/q> ?z)))");
}

TEST(SparqlParser, OptionalTakesTheFilterOfItsOwnGroupOnly) {
  EXPECT_EQ(AlgebraOf("ASK { ?s ex:p ?o OPTIONAL { ?s ex:q ?z FILTER(?z = ?o) } }"),
            "(leftjoin (bgp (?s <http://example.org/p> ?o)) (bgp (?s <http://example.org/q> ?z)) (?z = ?o))");
  EXPECT_EQ(AlgebraOf("ASK { ?s ex:p ?o OPTIONAL { { ?s ex:q ?z FILTER(?z = ?o) } } }"),
            "(leftjoin (bgp (?s <http://example.org/p> ?o)) (filter (?z = ?o) (bgp (?s "
            "<http://example.org/q> ?z))))");
}

TEST(SparqlParser, SequencesAlternativesAndInversesBecomePatterns) {
  EXPECT_EQ(AlgebraOf("ASK { ?s ex:p/^ex:q ?o }"),
            "(bgp (?s <http://example.org/p> ?_p0) (?o <http://example.org/q> ?_p0))");
  EXPECT_EQ(AlgebraOf("ASK { ?s ex:p|ex:q ?o }"),
            "(union (bgp (?s <http://example.org/p> ?o)) (bgp (?s <http://example.org/q> ?o)))");
  EXPECT_EQ(AlgebraOf("ASK { ?s ex:p+ ?o }"), "(path ?s (<http://example.org/p>)+ ?o)");
}

TEST(SparqlParser, AggregatesBecomeAGroup) {
  EXPECT_EQ(AlgebraOf("SELECT ?k (COUNT(*) AS ?n) { ?s ex:p ?k } GROUP BY ?k HAVING (COUNT(*) > 1)"),
            "(project (?k ?n) (extend ?n ?.a0 (filter (?_a1 > 1) (group ((?k ?k)) (?.a0 (COUNT *)) (?.a1 "
            "(COUNT *)) "
            "(bgp (?s <http://example.org/p> ?k))))))");
}

TEST(SparqlParser, SignsAndNumbers) {
  EXPECT_EQ(AlgebraOf("ASK { ?s ex:p -5 FILTER(?s-1 = -2 && 1.e0 < .5) }"),
            "(filter (&& ((?s - 1) = -2) (\"1.e0\"^^<http://www.w3.org/2001/XMLSchema#double> < .5)) "
            "(bgp (?s <http://example.org/p> -5)))");
}

TEST(SparqlParser, RelativeIrisResolveAgainstTheBase) {
  EXPECT_EQ(AlgebraOf("BASE <http://a/b/c> ASK { <d> <../e> <#f> }"),
            "(bgp (<http://a/b/d> <http://a/e> <http://a/b/c#f>))");
  EXPECT_THAT(ErrorsOf("ASK { <d> <e> <f> }")[0].message, HasSubstr("relative"));
}

TEST(SparqlParser, UnknownPrefixNamesTheNearest) {
  const Diagnostics errors = ErrorsOf("PREFIX expo: <http://e/>\nASK { ?s exop:p ?o }");
  ASSERT_EQ(errors.size(), 1u);
  EXPECT_EQ(errors[0].span.line, 2);
  EXPECT_EQ(errors[0].span.column, 10);
  EXPECT_EQ(errors[0].message, "the prefix 'exop:' is not declared");
  EXPECT_EQ(errors[0].hint, "did you mean expo:?");
}

TEST(SparqlParser, WellKnownPrefixIsOfferedForDeclaration) {
  EXPECT_THAT(ErrorsOf("ASK { ?s sosa:p ?o }")[0].hint,
              HasSubstr("PREFIX sosa: <http://www.w3.org/ns/sosa/>"));
}

TEST(SparqlParser, MissingDotIsSaid) {
  const Diagnostics errors = ErrorsOf("ASK {\n  ?s ex:p ?o\n  ?s ex:q ?z }");
  ASSERT_EQ(errors.size(), 1u);
  EXPECT_EQ(errors[0].span.line, 3);
  EXPECT_THAT(errors[0].message, HasSubstr("expected '.' or ';' after a triple, not ?s"));
}

TEST(SparqlParser, MissingBraceNamesTheOneThatIsOpen) {
  EXPECT_THAT(ErrorsOf("ASK {\n ?s ex:p ?o")[0].message,
              HasSubstr("close the group opened in line 1, column 5"));
}

TEST(SparqlParser, AWordThatBeginsAsAKeywordIsNone) {
  for (const std::string word :
       {"SELECTS", "SELECT_", "DESCRIBEs", "CONSTRUCTS", "CONSTRUCS", "AS", "ASKS"}) {
    EXPECT_THAT(ErrorsOf(word + " ?s { ?s ex:p 1 }")[0].message, HasSubstr("expected SELECT")) << word;
  }
  for (const std::string word : {"OPTIONALS", "OPTIONA", "OPTIONA_", "FILTERS", "A", "A_"}) {
    EXPECT_EQ(ErrorsOf("ASK { ?s ex:p 1 . " + word + " { ?s ex:q 1 } }")[0].span.column, 19) << word;
  }
  EXPECT_EQ(AlgebraOf("aSk { ?s ex:p 1 optIonAL { ?s ex:q 1 } }"),
            AlgebraOf("ASK { ?s ex:p 1 OPTIONAL { ?s ex:q 1 } }"));
  EXPECT_EQ(ErrorsOf("ASK { ?s A 1 }")[0].span.column, 10);  // but for "a"
}

TEST(SparqlParser, SeveralMistakesAreReportedTogether) {
  const Diagnostics errors =
      ErrorsOf("SELECT ?s {\n ?s foo:p ?o .\n ?s ex:p .\n FILTER(STRLN(?s) > 1)\n ?s bar:q 1 }");
  ASSERT_EQ(errors.size(), 4u);
  EXPECT_EQ(errors[0].span.line, 2);
  EXPECT_EQ(errors[1].span.line, 3);
  EXPECT_EQ(errors[2].span.line, 4);
  EXPECT_EQ(errors[2].hint, "did you mean STRLEN?");
  EXPECT_EQ(errors[3].span.line, 5);
}

TEST(SparqlParser, ScopesAreChecked) {
  EXPECT_THAT(ErrorsOf("SELECT * { ?s ex:p ?o BIND(1 AS ?o) }")[0].message,
              HasSubstr("?o already has a value"));
  EXPECT_THAT(ErrorsOf("SELECT ?o { ?s ex:p ?o } GROUP BY ?s")[0].message,
              HasSubstr("neither a key of GROUP BY"));
  EXPECT_THAT(ErrorsOf("SELECT (COUNT(?o) AS ?n) { ?s ex:p ?o } GROUP BY ?s HAVING (?n > 1)")[0].message,
              HasSubstr("?n gets its value in SELECT, after HAVING"));
  EXPECT_THAT(ErrorsOf("SELECT (SUM(COUNT(?o)) AS ?n) { ?s ex:p ?o }")[0].message,
              HasSubstr("inside another"));
  EXPECT_THAT(ErrorsOf("ASK { _:a ex:p ?o OPTIONAL { _:a ex:q ?z } }")[0].message,
              HasSubstr("another basic graph pattern"));
  EXPECT_THAT(ErrorsOf("ASK { VALUES (?a ?b) { (1) } }")[0].message, HasSubstr("1 values for 2 variables"));
}

std::string NestedGroups(int depth) {
  std::string text = "ASK ";
  for (int i = 0; i < depth; ++i) text += "{";
  text += "?s ?p ?o";
  for (int i = 0; i < depth; ++i) text += "}";
  return text;
}

// Section 19.2: also in names and IRIs, and only for allowed characters.
TEST(SparqlParser, EscapedCodePoints) {
  const std::string plain =
      AlgebraOf("PREFIX α: <http://g/> SELECT ?xy { ?xy ex:p α:é, ex:q, <http://h/é> }");
  EXPECT_EQ(
      AlgebraOf(
          R"(PREFIX \u03B1: <http://g/> S\u0045LECT ?x\u0079 { $\u0078y ex\u003Ap \u03b1:\U000000E9, e\u0078:q, <http://h/\u00e9> })"),
      plain);
  for (const char* wrong : {R"(ASK { ?x\u0020y ex:p 1 })", R"(ASK { ?s ex:p <http://a/\u003e> })",
                            R"(ASK { ?s ex:p ex:a\u0020b })", R"(ASK { ?s ex:p <http://a/\u0020> })",
                            R"(ASK { ?\uD800 ex:p 1 })", R"(ASK { ?s ex:p ex:\u })"}) {
    EXPECT_FALSE(Parse(wrong).ok()) << wrong;
  }
  EXPECT_EQ(AlgebraOf(R"(ASK { ?s ex:p "\u0041\\u0041" })"),
            R"((bgp (?s <http://example.org/p> "A\\u0041")))");
}

TEST(SparqlParser, NestingLimitHoldsAtItAndOnePastIt) {
  const int limit = Limits{}.query_nesting;
  EXPECT_TRUE(Parse(NestedGroups(limit - 1)).ok());  // the pattern's predicate is one level more
  const Diagnostics errors = ErrorsOf(NestedGroups(limit + 1));
  ASSERT_EQ(errors.size(), 1u);
  EXPECT_THAT(errors[0].message, HasSubstr("query_nesting = 100"));
}

TEST(SparqlParser, DeepNestingOfEveryKindIsAnErrorAndNoCrash) {
  const auto repeat = [](const std::string& text, int n) {
    std::string out;
    for (int i = 0; i < n; ++i) out += text;
    return out;
  };
  for (const std::string open : {"((", "!", "-", "EXISTS {", "(1 + (", "STR(", "?x IN ("}) {
    EXPECT_FALSE(Parse("ASK { FILTER(" + repeat(open, 20000)).ok()) << open;
  }
  for (const std::string open : {"[ ex:p ", "(", "?s (", "?s ^(", "OPTIONAL {", "{ SELECT * {"}) {
    EXPECT_FALSE(Parse("ASK { ?s ex:p " + repeat(open, 20000)).ok()) << open;
    EXPECT_FALSE(Parse("ASK { " + repeat(open, 20000)).ok()) << open;
  }
}

TEST(SparqlParser, ElementLimitHolds) {
  std::string text = "ASK { ?s ex:p ?o ";
  for (size_t i = 0; i < Limits{}.query_elements; ++i) text += "OPTIONAL { ?s ex:q ?z } ";
  EXPECT_TRUE(Parse(text + "}").ok());
  const Diagnostics errors = ErrorsOf(text + "OPTIONAL { ?s ex:q ?z } }");
  EXPECT_THAT(errors[0].message, HasSubstr("query_elements = 4000"));
}

TEST(SparqlParser, TextLimitHolds) {
  ParseOptions options;
  options.limits.query_text_bytes = 16;
  EXPECT_TRUE(ParseQuery("ASK { ?s ?p ?o }", options).ok());
  EXPECT_FALSE(ParseQuery("ASK { ?s ?p ?o } ", options).ok());
}

TEST(SparqlParser, AByteOrderMarkIsNotPartOfTheText) {
  EXPECT_TRUE(Parse("\xEF\xBB\xBF"
                    "ASK { ?s ?p ?o }")
                  .ok());
  const std::string text =
      "\xEF\xBB\xBF"
      "ASK { ?s ?p }";
  const Diagnostics errors = ErrorsOf(text);
  ASSERT_EQ(errors.size(), 1u);
  EXPECT_EQ(errors[0].span.column, 13);
  EXPECT_EQ(text[errors[0].span.offset], '}');
  EXPECT_THAT(Render(errors, text), HasSubstr("  ASK { ?s ?p }\n              ^\n"));
  EXPECT_FALSE(Parse("ASK \xEF\xBB\xBF{ ?s ?p ?o }").ok());
}

TEST(SparqlParser, BytesThatAreNotUtf8AreRefusedWithTheirPlace) {
  const Diagnostics errors = ErrorsOf("ASK {\n ?s ex:p \"\xff\" }");
  EXPECT_EQ(errors[0].span.line, 2);
  EXPECT_THAT(ErrorsOf(std::string("ASK { ?s ?p \"a\0b\" }", 20))[0].message, HasSubstr("U+0000"));
}

TEST(SparqlParser, UpdateTextIsNamedAsSuch) {
  EXPECT_THAT(ErrorsOf("INSERT DATA { ex:a ex:b ex:c }")[0].hint, HasSubstr("update"));
}

TEST(SparqlParser, PrintedQueriesParseToTheSameAlgebra) {
  const char* queries[] = {
      "ASK { ?s a ex:C ; ex:p 1, \"a\"@en, \"x\\ny\", true, 1.5, 1e3 }",
      "SELECT DISTINCT ?s (STRLEN(?o) AS ?n) { ?s ex:p ?o FILTER(?o > 5 || !BOUND(?z) && ?o IN (1, 2)) } "
      "ORDER BY DESC(?o) "
      "LIMIT 3 OFFSET 2",
      "SELECT * { ?s ex:p ?o OPTIONAL { ?o ex:q ?z FILTER(?z != ?o) } MINUS { ?s ex:r ?z } }",
      "SELECT * { { ?s ex:p ?o } UNION { ?o ex:q ?s } UNION { VALUES (?s ?o) { (1 UNDEF) (ex:a \"b\") } } }",
      "ASK { GRAPH ?g { ?s ex:p ?o } FILTER NOT EXISTS { ?s ex:q ?o FILTER(?o = ?g) } }",
      "SELECT ?k (COUNT(DISTINCT ?s) AS ?n) (GROUP_CONCAT(?s ; SEPARATOR = \", \") AS ?all) { ?s ex:p ?k } "
      "GROUP BY ?k HAVING "
      "(COUNT(?s) > 2) ORDER BY ?k",
      "CONSTRUCT { ?s ex:p _:b . _:b ex:q ?o } WHERE { ?s ex:p ?o . BIND(?o + 1 AS ?z) }",
      "ASK { ?s ex:p+ ?o . ?o !(ex:a|^ex:b) ?z . ?z (ex:c/ex:d)* ?s }",
      "SELECT ?s FROM ex:g FROM NAMED ex:h { ?s ex:p [ ex:q ?o ] }",
      "ASK { ?s ex:p ?o { SELECT ?o (MAX(?z) AS ?m) { ?o ex:q ?z } GROUP BY ?o } }",
      "ASK { { ?s ex:p ?o FILTER(?o > 1) } ?s ex:q ?z }",
      "ASK { SERVICE SILENT <http://x/> { ?s ?p ?o } }",
      // triples of a group of their own do not join those before the path
      "SELECT * { ?s ex:p ?o . ?o ex:q* ?z { ?z ex:r ?w } VALUES ?w { 1 } { ?s ex:q ?w } { ?w ex:p ?v } }",
  };
  PrintOptions print;
  print.prefixes = {{"ex", "http://example.org/"}};
  for (const char* text : queries) {
    const ParsedQuery first = Parse(text);
    ASSERT_TRUE(first.ok()) << Render(first.diagnostics, text);
    const std::string printed = PrintQuery(first.query, print);
    const ParsedQuery second = Parse(printed);
    ASSERT_TRUE(second.ok()) << printed << Render(second.diagnostics, printed);
    EXPECT_EQ(PrintQuery(second.query, print), printed);
    EXPECT_EQ(second.query.form, first.query.form);
    EXPECT_EQ(second.query.projection, first.query.projection);
  }
}

TEST(SparqlParser, ProductionsForOtherLanguages) {
  const std::string text =
      "PREFIX ex: <http://example.org/>\n"
      "RULE { ?a ex:near ?b . _:x ex:of ?a } WHERE { ?a ex:isAt ?p . ?b ex:isAt ?p FILTER(?a != ?b) }\n"
      "RULE { ?a exx:p ?b } WHERE { ?a ?b }\n"
      "RULE { ?a ex:q 1 } WHERE { ?a ex:p 2 }";
  ProductionParser p(text, {});
  ASSERT_TRUE(p.Prologue());
  int good = 0, bad = 0;
  while (!p.AtEnd()) {
    ASSERT_TRUE(p.AcceptKeyword("rule"));
    const auto head = p.TriplesTemplateInBraces();
    p.AcceptKeyword("WHERE");
    const AlgebraPtr body = p.GroupGraphPattern();
    if (head && body && p.diagnostics().empty()) {
      EXPECT_EQ(head->size(), 2u);
      EXPECT_TRUE((*head)[1].subject.term().IsBlank());
      EXPECT_EQ(body->kind, Algebra::Kind::kFilter);
    }
    (head && body ? good : bad) += 1;
  }
  EXPECT_EQ(p.diagnostics().size(), 2u);
  EXPECT_EQ(p.diagnostics()[0].span.line, 3);
  EXPECT_EQ(good + bad, 3);
}

TEST(SparqlParser, HintsForWhatOtherLanguagesWrite) {
  for (const auto& [text, expected] : std::initializer_list<std::pair<const char*, const char*>>{
           {"SELCT ?x { ?x ?y ?z }", "did you mean SELECT?"},
           {"SELECT ?x wher { ?x ?y ?z }", "did you mean WHERE?"},
           {"SELECT COUNT(?x) AS ?n { ?x ?y ?z }", "(COUNT(…) AS ?name)"},
           {"SELECT ?x { ?x ?y ?z FILTER(?x == 1) }", "one '='"},
           {"SELECT ?x { ?x ?y ?z FILTER(?x <> 1) }", "!="},
           {"SELECT ?x { ?x ?y ?z FILTER(?x = 1 AND ?y = 2) }", "&&"},
           {"SELECT ?x { ?x ?y ?z FILTER(?x = 1 or ?y = 2) }", "||"},
           {"SELECT ?x { ?x ?y ?z FILTER NOT (?x = 1) }", "'!'"},
           {"SELECT ?x { ?x ?y ?z FILTER (NOT ?x) }", "'!'"},
           {"SELECT ?x { ?x ?y ?z } LIMIT 99999999999999999999", "too large"},
           {"SELECT ?x { ?x ?y ?z } WHERE", ""}}) {
    const ParsedQuery parsed = ParseQuery(text);
    ASSERT_FALSE(parsed.ok()) << text;
    const std::string rendered = Render(parsed.diagnostics, text);
    EXPECT_NE(rendered.find(expected), std::string::npos) << rendered;
    EXPECT_EQ(rendered.find("NOW?"), std::string::npos) << rendered;
  }
}

}  // namespace
}  // namespace docent::sparql
