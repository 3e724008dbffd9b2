// Constraints, components and targets in SPARQL beyond the W3C suite, and the warnings about parts that are
// not evaluated.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "graph/sparql/values/function_registry.h"
#include "tests/reasoner/shapes/shapes_world.h"

namespace docent::shapes {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr char kDeclared[] =
    ":ns sh:declare [ sh:prefix \"e\" ; sh:namespace \"http://e/\"^^xsd:anyURI ] .\n"
    ":MaxOf a sh:ConstraintComponent ; sh:parameter [ sh:path :maxOf ] , [ sh:path :unit ; sh:optional true "
    "] ;\n"
    "  sh:message \"more than {$maxOf}\" ;\n"
    "  sh:validator [ sh:message \"{$value} is more than {$maxOf} {?unit}\" ;\n"
    "    sh:ask \"ASK { FILTER($value <= $maxOf) }\" ] .\n";

class SparqlShapesTest : public ShapesTest {
 protected:
  std::string Validated(const std::string& shapes, const std::string& data,
                        const ValidateOptions& options = {}) {
    Add("shapes.ttl", shapes);
    Add("data.ttl", data);
    const auto report = Run(options);
    return report.ok() ? Text(*report) : std::string(report.status().message());
  }
};

TEST_F(SparqlShapesTest, AMessageNamesWhatTheQueryFound) {
  EXPECT_THAT(
      Validated(std::string(kDeclared) +
                    ":S sh:targetClass :Robot ; sh:sparql [ sh:prefixes :ns ;\n"
                    "  sh:message \"{$this} is {?speed} fast, {$value} near people {?nothing}\"@en ;\n"
                    "  sh:select \"SELECT $this ?value ?speed { $this e:near ?value ; e:speed ?speed "
                    "FILTER(?speed > 1) }\" ] .",
                ":R1 a :Robot ; :near :John ; :speed 2 . :R2 a :Robot ; :near :Mary ; :speed 1 ."),
      AllOf(HasSubstr("<http://e/R1> <http://e/John>: <http://e/R1> is 2 fast, <http://e/John> near people "
                      "{?nothing}"),
            HasSubstr("sh:sparql"), Not(HasSubstr("R2"))));
}

TEST_F(SparqlShapesTest, APathStandsWhereTheQuerySaysSo) {
  const std::string text = Validated(
      std::string(kDeclared) +
          ":S sh:targetNode :a ; sh:property [ sh:path ( [ sh:inversePath :of ] [ sh:zeroOrMorePath :in ] ) "
          ";\n"
          "  sh:sparql [ sh:prefixes :ns ; sh:select \"\"\"SELECT $this ?value WHERE {\n"
          "    $this $PATH ?value . FILTER EXISTS { ?value a e:Bad . $this $PATH ?value } }\"\"\" ] ] .",
      ":p :of :a ; :in :q . :q :in :r . :r a :Bad . :x a :Bad .");
  EXPECT_THAT(text, AllOf(HasSubstr("<http://e/a> ^<http://e/of>/<http://e/in>* <http://e/r>: violates"),
                          Not(HasSubstr("<http://e/x>"))));
}

TEST_F(SparqlShapesTest, AComponentIsUsedByItsParameters) {
  const std::string text = Validated(
      std::string(kDeclared) +
          ":S sh:targetSubjectsOf :speed ; sh:property [ sh:path :speed ; :maxOf 2 ; :unit \"m/s\" ] ,\n"
          "  [ sh:path :weight ; :maxOf 100 ; sh:severity sh:Warning ] .",
      ":R1 :speed 3 , 1 ; :weight 120 .");
  EXPECT_THAT(text,
              AllOf(HasSubstr("violation: <http://e/R1> <http://e/speed> 3: 3 is more than 2 m/s\n"),
                    HasSubstr("warning: <http://e/R1> <http://e/weight> 120: 120 is more than 100 {?unit}\n"),
                    HasSubstr(", <http://e/MaxOf>")));
}

TEST_F(SparqlShapesTest, ARdfReportNamesComponentAndConstraint) {
  Add("shapes.ttl", std::string(kDeclared) +
                        ":S sh:targetNode 7 ; :maxOf 5 ; sh:sparql :C .\n"
                        ":C sh:select \"SELECT $this (5 + 1 AS ?value) { FILTER($this > 6) }\" .");
  Add("data.ttl", "");
  const auto report = Run();
  ASSERT_TRUE(report.ok()) << report.status();
  std::string triples;
  for (const TermQuad& q : ToRdf(*report, graph_.dictionary()))
    triples += ToNTriples(q.predicate) + " " + ToNTriples(q.object) + "\n";
  for (const char* part :
       {"sourceConstraintComponent> <http://e/MaxOf>",
        "sourceConstraintComponent> <http://www.w3.org/ns/shacl#SPARQLConstraintComponent>",
        "sourceConstraint> <http://e/C>", "shacl#value> \"6\"^^", "shacl#value> \"7\"^^"}) {
    EXPECT_THAT(triples, HasSubstr(part));
  }
}

TEST_F(SparqlShapesTest, TargetsAreSelected) {
  const std::string text = Validated(
      std::string(kDeclared) +
          ":Near a sh:SPARQLTargetType ; sh:prefixes :ns ; sh:parameter [ sh:path :place ] ;\n"
          "  sh:select \"SELECT ?this { ?this e:near $place }\" .\n"
          ":S sh:target [ a sh:SPARQLTarget ; sh:prefixes :ns ; sh:select \"SELECT ?this { ?this e:speed ?s "
          "FILTER(?s > 2) }\" ] ;\n"
          "  sh:property [ sh:path :name ; sh:minCount 1 ] .\n"
          ":T sh:target [ a :Near ; :place :hall ] ; sh:property [ sh:path :label ; sh:minCount 1 ] .",
      ":R1 :speed 3 . :R2 :speed 1 . :R3 :near :hall . :R4 :near :yard .");
  EXPECT_THAT(text,
              AllOf(HasSubstr("<http://e/R1> <http://e/name>"), HasSubstr("<http://e/R3> <http://e/label>"),
                    Not(HasSubstr("R2")), Not(HasSubstr("R4"))));
}

// SHACL 2.1.3: the nodes of a target need not be in the data.
TEST_F(SparqlShapesTest, TargetsThatAreNotInTheDataAreTargets) {
  const std::string text = Validated(
      std::string(kDeclared) +
          ":Listed a sh:SPARQLTargetType ; sh:prefixes :ns ; sh:parameter [ sh:path :prefix ] ;\n"
          "  sh:select \"SELECT ?this { BIND(IRI(CONCAT($prefix, 'made')) AS ?this) }\" .\n"
          ":S sh:target [ a sh:SPARQLTarget ; sh:select \"SELECT ?this { VALUES ?this { <http://e/none> "
          "'text' "
          "7 } }\" ] , [ a :Listed ; :prefix \"http://e/\" ] ;\n"
          "  sh:property [ sh:path :q ; sh:minCount 1 ] ; sh:sparql [ sh:message \"itself\" ; sh:select "
          "\"SELECT $this { FILTER($this = <http://e/none>) }\" ] .",
      ":a :q 1 .");
  EXPECT_THAT(text,
              AllOf(HasSubstr("<http://e/none> <http://e/q>"), HasSubstr("<http://e/made> <http://e/q>"),
                    HasSubstr("text"), HasSubstr("7 <http://e/q>"), HasSubstr(": itself\n")));
}

// The shapes are in two graphs: SHACL 5.3.1 has them as one.
TEST_F(SparqlShapesTest, TheShapesGraphOfSeveralGraphsIsAllOfThem) {
  Add("m1.ttl", std::string(kDeclared) +
                    ":allowed :member :x . :S sh:targetClass :C ; sh:sparql [ sh:prefixes :ns ; sh:select "
                    "\"SELECT $this { FILTER NOT EXISTS { GRAPH $shapesGraph { e:allowed e:member $this } } "
                    "}\" ] .");
  Add("m2.ttl", ":allowed :member :z .");
  Add("data.ttl", ":x a :C . :y a :C . :z a :C . :allowed :member :y .");
  const auto id = [&](const char* iri) { return graph_.dictionary().InternIri(iri); };
  const GraphView shapes(graph_.version(), {id("urn:m1.ttl"), id("urn:m2.ttl")});
  const ParsedShapes parsed = ReadShapes(shapes, graph_.dictionary());
  EXPECT_THAT(docent::Render(parsed.diagnostics, ""), IsEmpty());
  for (const GraphView& data : {GraphView(graph_.version()), graph_.View("urn:data.ttl")}) {
    const auto report = Validate(parsed.shapes, data, graph_.dictionary());
    ASSERT_TRUE(report.ok()) << report.status();
    EXPECT_EQ(report->total, 1u);
    EXPECT_THAT(Text(*report), HasSubstr("<http://e/y>"));
  }
}

// SHACL 1.5.
TEST_F(SparqlShapesTest, AnEntailmentThatIsNotFollowedIsAFailure) {
  Add("shapes.ttl",
      ":g sh:entailment <http://www.w3.org/ns/entailment/RDFS> . :S sh:targetNode :a ; "
      "sh:property [ sh:path :p ; sh:minCount 1 ] .");
  const auto read = [&](const Regimes& regimes) {
    return docent::Render(ReadShapes(graph_.View("urn:shapes.ttl"), graph_.dictionary(), {},
                                     &graph_.Places("urn:shapes.ttl"), nullptr, regimes)
                              .diagnostics,
                          "");
  };
  constexpr auto kError = Diagnostic::Severity::kError;
  EXPECT_THAT(read({{}, kError}),
              AllOf(HasSubstr("error"), HasSubstr("entailment/RDFS> is not followed here")));
  EXPECT_THAT(read({{"http://www.w3.org/ns/entailment/RDFS"}, kError}), IsEmpty());
  EXPECT_THAT(read({}), AllOf(HasSubstr("warning"), HasSubstr("a validation needs it")));
  EXPECT_THAT(read({{"http://www.w3.org/ns/entailment/RDFS"}}), IsEmpty());
}

TEST_F(SparqlShapesTest, WhatIsDeactivatedSaysNothing) {
  EXPECT_THAT(
      Validated(":S sh:targetNode :a ; sh:sparql [ sh:deactivated true ; sh:select \"SELECT $this { }\" ] .",
                ""),
      IsEmpty());
}

TEST_F(SparqlShapesTest, AConstraintAsksTheDataAlone) {
  const std::string text =
      Validated(std::string(kDeclared) +
                    ":S sh:targetNode :a ; :limit 5 ; sh:sparql [ sh:prefixes :ns ; sh:message \"data\" ; "
                    "sh:select \"SELECT $this { ?s e:limit ?l }\" ] ,\n"
                    "  [ sh:prefixes :ns ; sh:message \"shapes\" ;\n"
                    "    sh:select \"SELECT $this { GRAPH $shapesGraph { $currentShape e:limit 5 } }\" ] .",
                ":x :y :z .");
  EXPECT_THAT(text, AllOf(HasSubstr(": shapes\n"), Not(HasSubstr(": data\n"))));
}

TEST_F(SparqlShapesTest, AFailureEndsTheValidation) {
  EXPECT_THAT(
      Validated(
          ":S sh:targetNode :a ; sh:sparql :C .\n:C sh:select \"SELECT $this (true AS ?failure) { }\" .", ""),
      HasSubstr("the query of <http://e/C>: it fails (?failure) for <http://e/a>"));
}

TEST_F(SparqlShapesTest, QueriesEndAtTheLimitsOfQueries) {
  std::string data;
  for (int i = 0; i < 300; ++i) data += ":n" + std::to_string(i) + " :p " + std::to_string(i) + " . ";
  const std::string shapes =
      ":ns sh:declare [ sh:prefix \"e\" ; sh:namespace \"http://e/\"^^xsd:anyURI ] .\n"
      ":S sh:targetNode :a ; sh:sparql [ sh:prefixes :ns ; sh:select\n"
      "  \"SELECT $this { ?a e:p ?x . ?b e:p ?y . ?c e:p ?z . ?d e:p ?w FILTER(?x + ?y + ?z + ?w = -1) }\" ] "
      ".";
  Add("shapes.ttl", shapes);
  Add("data.ttl", data);
  Cancellation cancellation{std::chrono::milliseconds(50)};
  ValidateOptions options;
  options.cancellation = &cancellation;
  EXPECT_EQ(Run(options).status().code(), absl::StatusCode::kDeadlineExceeded);
  ValidateOptions small;
  small.memory_bytes = 1 << 20;
  Add("shapes.ttl",
      ":T sh:targetNode :a ; sh:sparql [ sh:prefixes :ns ; sh:select\n"
      "  \"SELECT DISTINCT $this ?a ?b ?c { ?a e:p ?x . ?b e:p ?y . ?c e:p ?z FILTER(?x + ?y + ?z = -1 || ?x "
      "< 100) }\" ] .\n"
      ":S sh:deactivated true .");
  const auto report = Run(small);
  EXPECT_EQ(report.status().code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(std::string(report.status().message()), HasSubstr("query_memory_bytes"));
}

TEST_F(SparqlShapesTest, MistakesOfQueriesAreSaidWithTheirPlaces) {
  const std::string text = Mistakes(
      ":A sh:targetNode :x ; sh:sparql [ sh:select \"SELECT $this { $this e:p ?o }\" ] .\n"
      ":B sh:targetNode :x ; sh:sparql [ sh:select \"ASK { }\" ] , [ sh:select \"SELECT ?that { ?that ?p ?o "
      "}\" ] .\n"
      ":C sh:targetNode :x ; sh:sparql [ sh:select \"SELECT $this { $this $PATH ?o }\" ] .\n"
      ":D sh:targetNode :x ; sh:path :p ; sh:sparql [ sh:select \"SELECT $this { $this ?p $PATH }\" ] .\n"
      ":E sh:targetNode :x ; sh:sparql [ sh:select \"SELECT $this FROM <http://e/g> { $this ?p ?o }\" ] .\n"
      ":F sh:targetNode :x ; sh:sparql [ sh:select \"SELECT $this { { SELECT ?y { ?y ?p ?o } } }\" ] ,\n"
      "  [ sh:select \"SELECT $this { $this ?p ?o MINUS { ?o ?q 1 } }\" ] , [ sh:select \"SELECT $this { "
      "VALUES ?x { 1 } }\" ] ,\n"
      "  [ sh:select \"SELECT $this { SERVICE <http://x/> { $this ?p ?o } }\" ] , [ sh:select \"SELECT $this "
      "{ BIND(1 AS ?this) }\" ] ,\n"
      "  [ sh:select \"SELECT $this { ?a ?b ?c } GROUP BY (1 AS ?currentShape) $this\" ] .\n"
      ":G sh:targetNode :x ; sh:sparql [ sh:prefixes :twice ; sh:select \"SELECT $this { }\" ] .\n"
      ":twice sh:declare [ sh:prefix \"e\" ; sh:namespace \"http://e/\" ] , [ sh:prefix \"e\" ; sh:namespace "
      "\"http://f/\" ] .");
  for (const char* part :
       {"shapes.ttl:3:", "sh:select, line 1, column ", "prefix", "sh:select is no SELECT",
        "sh:select does not select ?this", "$PATH has no meaning here",
        "$PATH is only allowed as a predicate", "sh:select has FROM", "a sub-SELECT does not return ?this",
        "MINUS is not allowed", "VALUES is not allowed", "SERVICE is not allowed",
        "?this is given before and must not be assigned", "?currentShape is given before",
        "the prefix e: stands for <http://e/> and for <http://f/>"}) {
    EXPECT_THAT(text, HasSubstr(part));
  }
}

TEST_F(SparqlShapesTest, MistakesOfComponentsThatAreUsedAreErrors) {
  const std::string used = Mistakes(
      ":A a sh:ConstraintComponent ; sh:parameter [ sh:path :this ] ; sh:validator [ sh:ask \"ASK { }\" ] .\n"
      ":B a sh:ConstraintComponent ; sh:parameter [ sh:path :one ] , [ sh:path :two ] ;\n"
      "  sh:validator [ sh:ask \"ASK { BIND(1 AS ?one) }\" ] .\n"
      ":S sh:targetNode :x ; :this 1 ; :one 1 ; :two 2 .\n:T sh:targetNode :x ; :one 1 , 3 ; :two 2 .");
  EXPECT_THAT(
      used,
      AllOf(HasSubstr("error: shape"), HasSubstr("a parameter cannot be called this"),
            HasSubstr("?one is given before and must not be assigned"),
            HasSubstr("has 2 values of <http://e/one>; a component with several parameters takes one")));
}

TEST_F(SparqlShapesTest, WhatIsNotEvaluatedIsAWarning) {
  const std::string text =
      Mistakes(std::string(kDeclared) +
               ":Unused a sh:ConstraintComponent ; sh:parameter [ sh:path :u ; sh:optional true ] ; "
               "sh:validator [ sh:ask \"ASK {\" ] .\n"
               ":Script a sh:ConstraintComponent ; sh:parameter [ sh:path :js ] ; sh:validator [ "
               "sh:jsFunctionName \"f\" ] .\n"
               ":S a sh:NodeShape ; sh:targetNode :x ; :unit \"m\" ; :js 1 ; sh:rule [ sh:construct \"\" ] ; "
               "sh:expression 1 ; sh:js [ ] ;\n"
               "  sh:select \"SELECT $this { }\" ; sh:target [ ] ; sh:property [ sh:path :p ; sh:values 3 ; "
               "sh:minCout 1 ] ;\n"
               "  sh:sparql [ sh:select \"SELECT $this { }\" ; sh:ask \"ASK { }\" ; sh:minCount 1 ] .\n"
               ":Lost sh:targetClas :C ; sh:property [ sh:path :q ; sh:minCount 1 ] .\n"
               ":graph sh:entailment <http://www.w3.org/ns/entailment/RDFS> .\n:f a sh:SPARQLFunction .");
  EXPECT_THAT(text, Not(HasSubstr("error")));
  for (const char* part :
       {"<http://e/Unused>: of <http://e/Unused>: has no parameter that is not optional", "line 1, column",
        "<http://e/Script> has no validator in SPARQL for node shapes; it is not checked",
        "sh:jsFunctionName is not evaluated",
        "has values for <http://e/MaxOf>, but none for <http://e/maxOf>; it is not checked",
        "sh:rule is not evaluated", "docent rules use FILE", "sh:expression is not evaluated",
        "sh:js is not evaluated", "sh:values is not evaluated", "sh:select says nothing here",
        "sh:minCount says nothing here", "sh:ask says nothing here", "is not evaluated: it has no sh:select",
        "did you mean sh:minCount?", "did you mean sh:targetClass?", "<http://e/Lost>: is never used",
        "entailment/RDFS> is not followed here", "sh:SPARQLFunction is not evaluated"}) {
    EXPECT_THAT(text, HasSubstr(part));
  }
}

TEST_F(SparqlShapesTest, ManyWarningsHideNoMistake) {
  CheckLimits limits;
  limits.check_diagnostics = 3;
  const std::string text = Mistakes(
      ":A a sh:NodeShape ; sh:minCout 1 . :B a sh:NodeShape ; sh:minCout 1 . :C a sh:NodeShape ; sh:minCout "
      "1 .\n"
      ":D a sh:NodeShape ; sh:minCout 1 . :E a sh:NodeShape ; sh:targetNode :x ; sh:class \"no class\" .",
      limits);
  EXPECT_FALSE(Read(limits).ok()) << text;
  EXPECT_THAT(text, HasSubstr("error"));
}

TEST_F(SparqlShapesTest, WhatIsEvaluatedIsNoWarning) {
  EXPECT_THAT(
      Mistakes(
          std::string(kDeclared) +
          ":S a sh:NodeShape ; sh:targetNode :x ; sh:name \"s\" ; sh:order 1 ; :maxOf 1 ; sh:message \"m\" "
          ";\n"
          "  sh:property [ sh:path [ sh:inversePath :p ] ; sh:group :g ; sh:minCount 1 ; sh:flags \"i\" ; "
          "sh:pattern \"a\" ] ;\n"
          "  sh:sparql [ a sh:SPARQLConstraint ; sh:prefixes :ns ; sh:message \"m\" ; sh:select \"SELECT "
          "$this { }\" ] ;\n"
          "  sh:target [ a sh:SPARQLTarget ; sh:select \"SELECT ?this { ?this :p 1 }\" ] .\n"
          ":report a sh:ValidationReport ; sh:conforms false ; sh:result [ sh:focusNode :x ; sh:value 1 ] .\n"
          "sh:MinCountConstraintComponent a sh:ConstraintComponent ; sh:parameter "
          "sh:MinCountConstraintComponent-minCount .\n"
          "sh:MinCountConstraintComponent-minCount sh:path sh:minCount .")
          .substr(0, 400),
      HasSubstr("prefix"));  // of the target alone, which declares none
}

TEST_F(SparqlShapesTest, FunctionsAreThoseOfTheServer) {
  sparql::FunctionRegistry functions;
  Add("shapes.ttl",
      ":S sh:targetNode :x ; sh:sparql :C .\n:C sh:select \"SELECT $this { FILTER(<http://e/odd>($this)) }\" "
      ".");
  Add("data.ttl", "");
  EXPECT_THAT(
      docent::Render(
          ReadShapes(graph_.View("urn:shapes.ttl"), graph_.dictionary(), {}, nullptr, &functions).diagnostics,
          ""),
      HasSubstr("http://e/odd"));
  EXPECT_THAT(std::string(Run().status().message()),
              AllOf(HasSubstr("the query of <http://e/C>"), HasSubstr("http://e/odd")));
}

}  // namespace
}  // namespace docent::shapes
