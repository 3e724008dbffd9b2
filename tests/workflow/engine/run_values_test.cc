// Which values the variables of a run take.
#include "workflow/engine/run_values.h"

#include "absl/strings/str_cat.h"
#include "gmock/gmock.h"
#include "graph/base/text.h"
#include "graph/rdf/vocabulary.h"
#include "tests/workflow/engine/engine_fixture.h"

namespace docent::engine {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Kind = RunRequest::Kind;

Term Typed(const std::string& text, const std::string& local) {
  return Term::Literal(text, Concat(kXsdNs, local));
}

class RunValuesTest : public EngineTest {
 protected:
  std::string Why(const std::string& type, const Term& value) {
    const auto parsed =
        cawl::ParseCawl("<CAWL name=\"W\" xmlns:w=\"urn:w:\"><message name=\"m\"><part name=\"p\" type=\"" +
                            type + "\"/></message><flow name=\"F\"><variable name=\"x\" type=\"" + type +
                            "\"/><variable name=\"y\" type=\"m\"/><source name=\"s\"/><sink name=\"e\"/>"
                            "<link from=\"s\" to=\"e\"/></flow></CAWL>",
                        "w.xml");
    EXPECT_TRUE(parsed.ok());
    const VariablePlace place{*parsed.document, parsed.document->flows[0]};
    const std::string why = TypeFault(place, "x", value), of_part = TypeFault(place, "y.p", value);
    EXPECT_EQ(why.empty(), of_part.empty()) << of_part;
    return why;
  }
  bool Takes(const std::string& type, const Term& value) { return Why(type, value).empty(); }

  absl::Status Ask(const TermBinding& values) {
    RunRequest request{Kind::kStart, "W/F", {}};
    request.arguments.assign(values.begin(), values.end());
    absl::Status status = engine_.CheckRequest(request);
    if (status.ok()) Turn({}, {request});
    return status;
  }
};

TEST_F(RunValuesTest, TextInALanguageIsAText) {
  EXPECT_TRUE(Takes("xsd:string", Term::Literal("Guten Tag")));
  EXPECT_TRUE(Takes("xsd:string", Term::LangString("Guten Tag", "de")));
  EXPECT_TRUE(Takes("rdf:langString", Term::LangString("Guten Tag", "de")));
  EXPECT_FALSE(Takes("rdf:langString", Term::Literal("Guten Tag")));
  EXPECT_FALSE(Takes("xsd:integer", Term::LangString("1", "de")));
  EXPECT_FALSE(Takes("xsd:string", Term::Integer(1)));
  EXPECT_FALSE(Takes("xsd:boolean", Term::Literal("true")));
}

TEST_F(RunValuesTest, ANumberIsOfEachDatatypeThatHasItsValue) {
  for (const char* type : {"xsd:integer", "xsd:int", "xsd:nonNegativeInteger", "xsd:decimal", "xsd:double"})
    EXPECT_TRUE(Takes(type, Term::Integer(5))) << type;
  EXPECT_TRUE(Takes("xsd:integer", Typed("5", "int")));
  EXPECT_TRUE(Takes("xsd:double", Typed("5.5", "decimal")));
  EXPECT_EQ(Why("xsd:integer", Typed("5.5", "decimal")),
            "$x is of type xsd:integer, and 5.5 is of type xsd:decimal");
  EXPECT_EQ(Why("xsd:byte", Term::Integer(300)),
            "$x is of type xsd:byte, and 300 is not among the values of xsd:byte");
  EXPECT_FALSE(Takes("xsd:nonNegativeInteger", Term::Integer(-1)));
  EXPECT_TRUE(Takes("xsd:decimal", Typed("1e3", "double")));
  EXPECT_TRUE(Takes("xsd:integer", Typed("5.0", "decimal")));
  EXPECT_THAT(Why("xsd:integer", Typed("five", "integer")), HasSubstr("not of the form of xsd:integer"));
}

TEST_F(RunValuesTest, AClassTakesResourcesADatatypeLiterals) {
  EXPECT_TRUE(Takes("w:Room", Term::Iri("urn:w:r1")));
  EXPECT_EQ(Why("w:Room", Term::Integer(7)), "$x is of type w:Room, and 7 is a literal");
  EXPECT_TRUE(Takes("w:level", Term::Literal("high", "urn:w:level")));
  EXPECT_EQ(Why("xsd:integer", Term::Iri("urn:w:r1")), "$x is of type xsd:integer, and w:r1 is no literal");
  EXPECT_TRUE(Takes("rdfs:Literal", Term::Literal("any")));
}

TEST_F(RunValuesTest, AStartWithAValueOfAWrongTypeIsRefused) {
  Deploy(
      Flow("<variable name=\"n\" type=\"xsd:integer\"/><variable name=\"who\" type=\"docent:Visitor\"/>"
           "<node name=\"A\"><invoke operation=\"a\"/></node><sink name=\"t\"/>" +
           Link("s", "A") + Link("A", "t")));
  const absl::Status text = Ask({{"n", Term::Literal("abc")}});
  EXPECT_TRUE(absl::IsInvalidArgument(text)) << text;
  EXPECT_EQ(text.message(), "$n is of type xsd:integer, and \"abc\" is of type xsd:string");
  EXPECT_FALSE(Ask({{"n", Typed("5.5", "decimal")}}).ok());
  EXPECT_FALSE(Ask({{"n", Term::Integer(5)}, {"who", Term::Literal("Bob")}}).ok());
  EXPECT_THAT(commands_, IsEmpty());
  EXPECT_TRUE(Ask({{"n", Term::Integer(5)}, {"who", Term::Iri("urn:bob")}}).ok());
  EXPECT_EQ(commands_.size(), 1u);
}

TEST_F(RunValuesTest, ANodeWhoseMatchBindsAValueOfAWrongTypeFails) {
  Deploy(Flow("<variable name=\"o\" type=\"xsd:integer\"/>" + Node("A", "near", "<invoke operation=\"a\"/>") +
              "<sink name=\"t\"/>" + Link("s", "A") + Link("A", "t")));
  Start();
  conditions_.Set("near", {{{"s", Term::Iri("urn:a")}, {"o", Term::Literal("abc")}}});
  Turn();
  EXPECT_THAT(commands_, IsEmpty());
  EXPECT_THAT(transitions_, Contains("F-1 running>failed"));
  EXPECT_THAT(Fact("urn:docent:run:F-1", "reason"),
              HasSubstr("node A: $o is of type xsd:integer, and \"abc\" is of type xsd:string"));
}

}  // namespace
}  // namespace docent::engine
