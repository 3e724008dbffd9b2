// Shapes beyond the W3C suite: refusals, limits, reports for people.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "graph/rdf/formats/serializer.h"
#include "reasoner/shapes/datatype_check.h"
#include "tests/reasoner/shapes/shapes_world.h"

namespace docent::shapes {
namespace {

using ::testing::HasSubstr;

TEST_F(ShapesTest, AReportSaysFileAndLineOfDataAndShape) {
  Add("shapes.ttl",
      ":S a sh:NodeShape ; sh:targetClass :Robot ;\n  sh:property :Speed .\n:Speed sh:path :speed ; "
      "sh:maxInclusive 2 .");
  Add("data.ttl", ":R1 a :Robot ;\n  :speed 1 ,\n    5 .");
  auto report = Run();
  ASSERT_TRUE(report.ok());
  EXPECT_FALSE(report->conforms());
  EXPECT_EQ(Text(*report),
            "data.ttl:5:5: violation: <http://e/R1> <http://e/speed> 5: is not at most 2\n"
            "  shape <http://e/Speed>, sh:maxInclusive (shapes.ttl:5:1)\n");
  EXPECT_EQ(Summary(*report, graph_.dictionary()), "1 violation (1 node checked)");
}

TEST_F(ShapesTest, AShapeThatRefersToItselfIsRefusedWithTheCircle) {
  const std::string text = Mistakes(
      ":A a sh:NodeShape ; sh:targetClass :C ; sh:property :P .\n:P sh:path :knows ; sh:node :B .\n:B sh:not "
      ":A .");
  EXPECT_THAT(text, HasSubstr("refers to itself: "));
  EXPECT_THAT(text, HasSubstr("<http://e/A> → <http://e/P> → <http://e/B>"));
  EXPECT_THAT(text, HasSubstr("shapes.ttl:"));
  EXPECT_THAT(text, HasSubstr("hint: SHACL does not say what recursive shapes mean"));
}

TEST_F(ShapesTest, ALargeNumberIsAnIntegerAllTheSame) {
  const std::string text = Mistakes(
      ":A a sh:PropertyShape ; sh:path :p ; sh:maxCount 99999999999999999999 .\n"
      ":B a sh:PropertyShape ; sh:path :p ; sh:maxCount \"a\"^^xsd:integer .\n"
      ":C a sh:PropertyShape ; sh:path :p ; sh:maxCount +5 .\n"
      ":D a sh:PropertyShape ; sh:path :p ; sh:maxCount 4000000000000000000 .");
  EXPECT_THAT(text, HasSubstr("99999999999999999999, not a number below 2^63"));
  EXPECT_THAT(text, HasSubstr(", not an xsd:integer"));
  EXPECT_THAT(text, ::testing::Not(HasSubstr("http://e/C")));
  EXPECT_THAT(text, ::testing::Not(HasSubstr("http://e/D")));
}

TEST_F(ShapesTest, IllFormedShapesAreAllSaidAtOnce) {
  const std::string text = Mistakes(
      ":A a sh:NodeShape ; sh:targetClass \"Robot\" ; sh:minCount 1 ; sh:nodeKind :Iri ; sh:pattern \"[a\" "
      ".\n"
      ":B a sh:PropertyShape .\n"
      ":C a sh:NodeShape ; sh:property [ sh:path ( :p ) ; sh:maxCount \"many\" ] ; sh:in ( 1 2 ) , ( 3 ) .\n"
      ":D a sh:NodeShape ; sh:or \"x\" ; sh:datatype xsd:int , xsd:byte ; sh:mincount 4 ; sh:sparql [ ] .");
  for (const char* part :
       {"shapes.ttl:3:36: error: shape <http://e/A>: sh:targetClass is \"Robot\", which is not an IRI",
        "sh:minCount at a node shape", "sh:nodeKind is <http://e/Iri>", "sh:pattern \"[a\"",
        "<http://e/B>: a property shape without sh:path", "needs at least two members, this list has 1",
        "sh:maxCount is \"many\", not an xsd:integer", "has 2 sh:in; one is allowed", "ill-formed sh:or",
        "has 2 sh:datatype; one is allowed", "did you mean sh:minCount?",
        "needs one sh:select, a text in SPARQL"}) {
    EXPECT_THAT(text, HasSubstr(part));
  }
}

TEST_F(ShapesTest, PatternsAreThoseOfXPath) {
  Add("shapes.ttl",
      ":S a sh:NodeShape ; sh:targetClass :C ; sh:property [ sh:path :twice ; sh:pattern \"^(.+) \\\\1$\" ] "
      ",\n"
      "  [ sh:path :name ; sh:pattern \"^[\\\\i-[:]]\\\\c*$\" ; sh:flags \"i\" ] .");
  Add("data.ttl", ":a a :C ; :twice \"so so\" , \"so la\" ; :name \"n1\" , \"1n\" .");
  auto report = Run();
  ASSERT_TRUE(report.ok());
  EXPECT_EQ(report->total, 2u);
  EXPECT_THAT(Text(*report), HasSubstr("\"so la\": does not match the pattern"));
  EXPECT_THAT(Text(*report), HasSubstr("\"1n\": does not match the pattern"));
}

TEST_F(ShapesTest, APatternThatCannotBeEvaluatedIsRefusedWithItsMistake) {
  const std::string text = Mistakes(
      ":A sh:targetNode :x ; sh:pattern \"(?i)a\" .\n:B sh:targetNode :x ; sh:pattern \"[[:alpha:]]\" .\n"
      ":C sh:targetNode :x ; sh:pattern \"a\" ; sh:flags \"iz\" .\n"
      ":D sh:targetNode :x ; sh:pattern \"a\" ; sh:flags 5 .");
  for (const char* part :
       {"sh:pattern \"(?i)a\" cannot be evaluated: '(?i' is not a group", "third argument of REGEX",
        "sh:pattern \"[[:alpha:]]\" cannot be evaluated: '[' inside a class",
        "sh:flags \"iz\" cannot be evaluated: 'z' is not a flag", "sh:flags is 5, not a plain text"}) {
    EXPECT_THAT(text, HasSubstr(part));
  }
}

TEST_F(ShapesTest, APatternThatTakesTooLongIsAnErrorOfTheValidation) {
  Add("shapes.ttl", ":S sh:targetSubjectsOf :p ; sh:property [ sh:path :p ; sh:pattern \"^(a+)+\\\\1$\" ] .");
  Add("data.ttl", ":a :p \"" + std::string(40, 'a') + "b\" .");
  const auto report = Run();
  EXPECT_EQ(report.status().code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(report.status().message(), HasSubstr("regex_backtracking_steps = "));
}

TEST_F(ShapesTest, LanguageTagsCompareWithoutCase) {
  Add("shapes.ttl",
      ":S a sh:NodeShape ; sh:targetClass :C ; sh:property [ sh:path :label ; sh:uniqueLang true ; "
      "sh:languageIn ( \"EN\" \"de\" ) ] ,\n"
      "  [ sh:path :title ; sh:in ( \"x\"@En-Gb ) ] .");
  Add("data.ttl",
      ":a a :C ; :label \"colour\"@en-GB , \"hue\"@EN-gb , \"Farbe\"@De-at ; :title \"x\"@en-GB .");
  auto report = Run();
  ASSERT_TRUE(report.ok());
  EXPECT_EQ(report->total, 1u);
  EXPECT_THAT(Text(*report), HasSubstr("has 2 values in the language \"en-gb\""));
}

TEST_F(ShapesTest, APathAndAListThatGoInCirclesAreRefused) {
  EXPECT_THAT(
      Mistakes(":A sh:targetNode :x ; sh:path _:p ; sh:minCount 1 . _:p sh:inversePath _:p .\n"
               ":B sh:targetNode :x ; sh:in _:l . _:l <http://www.w3.org/1999/02/22-rdf-syntax-ns#first> 1 ; "
               "<http://www.w3.org/1999/02/22-rdf-syntax-ns#rest> _:l ."),
      testing::AllOf(HasSubstr("the path refers to itself"), HasSubstr("the list goes in a circle")));
}

TEST_F(ShapesTest, ShapesNestToTheLimitAndNoFurther) {
  CheckLimits limits;
  limits.shape_nesting = 3;
  Add("shapes.ttl", ":A sh:targetNode :x ; sh:node :B . :B sh:node :C . :C sh:nodeKind sh:IRI .");
  EXPECT_TRUE(Read(limits).ok());
  limits.shape_nesting = 2;
  EXPECT_THAT(docent::Render(Read(limits).diagnostics, ""),
              HasSubstr("3 deep; the limit shape_nesting is 2"));
}

TEST_F(ShapesTest, ResultsBeyondTheLimitAreCounted) {
  Add("shapes.ttl", ":S sh:targetSubjectsOf :p ; sh:nodeKind sh:Literal .");
  Add("data.ttl", ":a :p 1 . :b :p 1 . :c :p 1 .");
  ValidateOptions options;
  options.limits.validation_results = 2;
  auto report = Run(options);
  ASSERT_TRUE(report.ok());
  EXPECT_EQ(report->results.size(), 2u);
  EXPECT_EQ(report->total, 3u);
  EXPECT_THAT(Summary(*report, graph_.dictionary()), HasSubstr("2 violations shown of 3 results"));
  options.limits.validation_results = 3;
  EXPECT_EQ(Run(options)->results.size(), 3u);
}

TEST_F(ShapesTest, ItEndsWhenItIsCancelledOrNeedsTooMuchMemory) {
  Add("shapes.ttl",
      ":S sh:targetSubjectsOf :p ; sh:property [ sh:path [ sh:oneOrMorePath :p ] ; sh:maxCount 0 ] .");
  std::string ring;
  for (int i = 0; i < 300; ++i)
    ring += ":n" + std::to_string(i) + " :p :n" + std::to_string((i + 1) % 300) + " .\n";
  Add("data.ttl", ring);
  Cancellation cancellation;
  cancellation.Cancel();
  ValidateOptions options;
  options.cancellation = &cancellation;
  EXPECT_EQ(Run(options).status().code(), absl::StatusCode::kCancelled);
  options.cancellation = nullptr;
  options.memory_bytes = 4000;
  auto refused = Run(options);
  EXPECT_EQ(refused.status().code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(std::string(refused.status().message()), HasSubstr("query_memory_bytes = 4000"));
  options.memory_bytes = 1 << 20;
  EXPECT_EQ(Run(options)->total, 300u);
}

TEST_F(ShapesTest, ANestedShapeTellsWhy) {
  Add("shapes.ttl",
      ":S sh:targetNode :a ; sh:node :Named .\n:Named sh:property [ sh:path :name ; sh:minCount 1 ] .");
  Add("data.ttl", ":a :age 3 .");
  auto report = Run();
  ASSERT_TRUE(report.ok());
  EXPECT_THAT(Text(*report),
              HasSubstr("does not conform to the shape <http://e/Named>\n"
                        "    <http://e/a> <http://e/name>: has 0 values; at least 1 needed\n"));
  auto turtle =
      SerializeRdf(ToRdf(*report, graph_.dictionary()), RdfFormat::kTurtle, {{"sh", std::string(kShaclNs)}});
  ASSERT_TRUE(turtle.ok());
  EXPECT_THAT(*turtle, testing::AllOf(HasSubstr("sh:detail"), HasSubstr("sh:MinCountConstraintComponent")));
}

TEST_F(ShapesTest, AnOwlClassThatIsAShapeTargetsItsInstances) {
  Add("shapes.ttl", ":Robot a owl:Class , sh:NodeShape ; sh:property [ sh:path :name ; sh:minCount 1 ] .");
  Add("shapes2.ttl", ":Another a sh:NodeShape ; sh:targetClass :Robot .");  // a node is counted once
  Add("data.ttl", ":GuideRobot rdfs:subClassOf :Robot . :R1 a :GuideRobot . :R2 a :Robot ; :name \"x\" .");
  auto report = Run();
  ASSERT_TRUE(report.ok());
  EXPECT_EQ(report->focus_nodes, 2u);
  EXPECT_EQ(report->total, 1u);
}

TEST(DatatypeCheckTest, LexicalFormsOfXmlSchema) {
  const auto valid = [](const char* type, const char* text) {
    return IsValidLexicalForm(text, std::string("http://www.w3.org/2001/XMLSchema#") + type);
  };
  for (const auto& [type, text] :
       std::vector<std::pair<const char*, const char*>>{{"integer", "-007"},
                                                        {"byte", "-128"},
                                                        {"unsignedLong", "18446744073709551615"},
                                                        {"decimal", "+.5"},
                                                        {"double", "-1.5e-3"},
                                                        {"double", "INF"},
                                                        {"dateTime", "2026-11-22T00:00:00.5Z"},
                                                        {"dateTime", "99999999999999999999-02-28T00:00:00"},
                                                        {"dateTimeStamp", "-12000-02-29T00:00:00Z"},
                                                        {"gYear", "123456789"},
                                                        {"gYearMonth", "-0004-12"},
                                                        {"date", "2024-02-29"},
                                                        {"time", "23:59:59+01:00"},
                                                        {"gYear", "2026"},
                                                        {"gMonthDay", "--02-29"},
                                                        {"gDay", "---31Z"},
                                                        {"duration", "P1Y2M3DT4H5M6.7S"},
                                                        {"duration", "-PT0S"},
                                                        {"dayTimeDuration", "P2DT1S"},
                                                        {"hexBinary", "0aF1"},
                                                        {"base64Binary", "QUI="},
                                                        {"base64Binary", "Y Q = ="},
                                                        {"Name", "a:b-c.1"},
                                                        {"Name", ":é"},
                                                        {"NCName", "_a·1"},
                                                        {"NMTOKEN", "-1:a"},
                                                        {"language", "de-CH-1901"},
                                                        {"anyURI", "a/b#c"},
                                                        {"anyURI", "http://e/a b"},
                                                        {"anyURI", "<{|\\^`\"}> %"},
                                                        {"anyURI", ""},
                                                        {"nonPositiveInteger", "-0"}}) {
    EXPECT_EQ(valid(type, text), true) << type << " " << text;
  }
  for (const auto& [type, text] :
       std::vector<std::pair<const char*, const char*>>{{"integer", "1.0"},
                                                        {"integer", ""},
                                                        {"byte", "128"},
                                                        {"byte", "c"},
                                                        {"unsignedInt", "-1"},
                                                        {"decimal", "."},
                                                        {"decimal", "1e3"},
                                                        {"double", "e3"},
                                                        {"dateTime", "2026-11-22"},
                                                        {"dateTime", "02026-11-22T00:00:00Z"},
                                                        {"date", "123400000001-02-29"},
                                                        {"gYear", "202"},
                                                        {"date", "2023-02-29"},
                                                        {"time", "25:00:00"},
                                                        {"gMonth", "--13"},
                                                        {"duration", "P"},
                                                        {"duration", "P1YT"},
                                                        {"duration", "P1D2Y"},
                                                        {"yearMonthDuration", "P1D"},
                                                        {"hexBinary", "abc"},
                                                        {"base64Binary",
                                                         "QU=="
                                                         "I"},
                                                        {"base64Binary", "YR=="},
                                                        {"base64Binary", "QUJ="},
                                                        {"Name", "1a"},
                                                        {"Name", ""},
                                                        {"NCName", "a:b"},
                                                        {"NCName", "a b"},
                                                        {"NMTOKEN", "a,b"},
                                                        {"boolean", "yes"},
                                                        {"language", "de_CH"},
                                                        {"positiveInteger", "0"},
                                                        {"negativeInteger", "0"}}) {
    EXPECT_EQ(valid(type, text), false) << type << " " << text;
  }
  EXPECT_EQ(IsValidLexicalForm("x", "http://e/own"), std::nullopt);
  const std::string xsd = "http://www.w3.org/2001/XMLSchema#";
  EXPECT_TRUE(IsDerivedDatatype(xsd + "unsignedByte", xsd + "decimal"));
  EXPECT_TRUE(IsDerivedDatatype(xsd + "NCName", xsd + "Name"));
  EXPECT_TRUE(IsDerivedDatatype(xsd + "language", xsd + "token"));
  EXPECT_FALSE(IsDerivedDatatype(xsd + "NMTOKEN", xsd + "Name"));
  EXPECT_FALSE(IsDerivedDatatype(xsd + "decimal", xsd + "integer"));
  EXPECT_FALSE(IsDerivedDatatype(xsd + "double", xsd + "decimal"));
}

}  // namespace
}  // namespace docent::shapes
