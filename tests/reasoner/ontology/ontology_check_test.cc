// Findings in ontologies, data, rules and queries: each with its place and remedy, and none in correct
// documents.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "graph/sparql/syntax/parser.h"
#include "graph/sparql/syntax/prefix_places.h"
#include "reasoner/ontology/meaning_check.h"
#include "reasoner/ontology/word_check.h"

namespace docent::ontology {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr char kPrefixes[] =
    "@prefix : <http://e/> . @prefix owl: <http://www.w3.org/2002/07/owl#> . "
    "@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> . @prefix xsd: "
    "<http://www.w3.org/2001/XMLSchema#> .\n";
constexpr char kWords[] =
    ":Robot a owl:Class ; rdfs:label \"robot\" ; rdfs:comment \"moves\" ; owl:disjointWith :Place .\n"
    ":Guide a owl:Class ; rdfs:subClassOf :Robot ; rdfs:label \"guide\" ; rdfs:comment \"shows\" .\n"
    ":Place a owl:Class ; rdfs:label \"place\" ; rdfs:comment \"is somewhere\" .\n"
    ":Thing a owl:Class ; rdfs:label \"thing\" ; rdfs:comment \"is\" .\n"
    ":isAt a owl:ObjectProperty ; rdfs:domain :Robot ; rdfs:range :Place ; rdfs:label \"at\" ; rdfs:comment "
    "\"now\" .\n"
    ":speed a owl:DatatypeProperty ; rdfs:domain :Robot ; rdfs:range xsd:decimal ; rdfs:label \"v\" ; "
    "rdfs:comment \"m/s\" .\n";

class OntologyCheckTest : public testing::Test {
 protected:
  OntologyCheckTest() { vocabulary_.Add(Parse(kWords, "w_").rdf.quads); }

  static LocatedRdf Parse(const std::string& turtle, const std::string& scope) {
    ParseRdfOptions options;
    options.blank_node_scope = scope;
    LocatedRdf document = ParseLocatedRdf(kPrefixes + turtle, RdfFormat::kTurtle, options);
    EXPECT_TRUE(document.rdf.ok()) << Render(document.rdf.diagnostics, turtle);
    return document;
  }
  static std::string Text(Findings& findings) {
    std::string text;
    for (const Finding& f : findings.Take()) text += f.rule + " " + Render({f.diagnostic}, "");
    return text;
  }
  // The findings in a document that the vocabulary includes, too; without unused prefixes.
  std::string Check(const std::string& turtle) {
    LocatedRdf document = Parse(turtle, "d_");
    document.prefixes.clear();
    vocabulary_.Add(document.rdf.quads);
    Findings findings("f.ttl", 100);
    CheckWords(document, vocabulary_, findings);
    CheckMeaning(document, vocabulary_, &cycles_, findings);
    return Text(findings);
  }

  Vocabulary vocabulary_;
  std::set<std::string> cycles_;
};

TEST_F(OntologyCheckTest, AGoodDocumentHasNoFindings) {
  EXPECT_EQ(Check(kWords), "");
  EXPECT_EQ(Check(":R1 a :Guide ; :isAt :Hall ; :speed 1 , 2.5 . :Hall a :Place ."), "");
  EXPECT_EQ(Check(":R1 <http://elsewhere/p> <http://elsewhere/o> ; a <http://elsewhere/C> ."), "");
}

TEST_F(OntologyCheckTest, UndefinedWordsHaveTheNearestKnown) {
  const std::string text = Check(":R1 a :Gide ;\n  :isat :R1 .\n:R1 rdfs:lable \"x\" ; :isAt :Nowhere .");
  EXPECT_THAT(text, HasSubstr("undefined-term f.ttl:2:7: error: the class <http://e/Gide> is not defined\n"
                              "  hint: did you mean <http://e/Guide>?"));
  EXPECT_THAT(text, HasSubstr("f.ttl:3:3: error: the property <http://e/isat> is not defined\n"
                              "  hint: did you mean <http://e/isAt>?"));
  EXPECT_THAT(text, HasSubstr("the property rdfs:lable is not defined\n  hint: did you mean rdfs:label?"));
  EXPECT_THAT(text, HasSubstr("the resource <http://e/Nowhere> is not defined"));
}

TEST_F(OntologyCheckTest, IndividualsThatAxiomsNameNeedNoDeclaration) {
  EXPECT_EQ(
      Check(
          ":Here owl:equivalentClass [ owl:oneOf ( :Hall :Room ) ] .\n"
          ":AtHall owl:equivalentClass [ a owl:Restriction ; owl:onProperty :isAt ; owl:hasValue :Yard ] .\n"
          "[ a owl:AllDifferent ; owl:distinctMembers ( :Hall :Cellar ) ] . [ a owl:AllDifferent ; "
          "owl:members ( :Attic ) ] .\n"
          ":R1 a :Guide ; :isAt :Hall , :Room , :Yard , :Cellar , :Attic , :Garden . :Hall owl:differentFrom "
          ":Garden ."),
      "");
  EXPECT_THAT(Check("[ a owl:AllDisjointClasses ; owl:members ( :Robot :Plaice ) ] ."),
              HasSubstr("<http://e/Plaice> is not defined"));
}

TEST_F(OntologyCheckTest, TheIriOfAnOntologyIsNoWord) {
  EXPECT_EQ(
      Check("<http://e> a owl:Ontology ; owl:versionIRI <http://e/1.0> ; owl:priorVersion <http://e/0.9> ;\n"
            "  owl:priorVersion <http://e#x> ."),
      "");
}

TEST_F(OntologyCheckTest, ImportsThatNoDocumentHas) {
  vocabulary_.Add(
      Parse("<http://one> a owl:Ontology . <http://two> a owl:Ontology ; owl:versionIRI <http://two/1.0> .",
            "i_")
          .rdf.quads);
  EXPECT_EQ(Check("<http://e> a owl:Ontology ; owl:imports <http://one> , <http://two> , <http://two/1.0> ."),
            "");
  EXPECT_EQ(Check("<http://e> owl:imports <http://two> , <http://three> ."),
            "import f.ttl:2:39: warning: <http://three> is imported, but is not an ontology of these files\n"
            "  hint: imports are not fetched; name the file that has it, too\n");
}

TEST_F(OntologyCheckTest, AWordOfTheWrongKind) {
  const std::string text = Check(":R1 a :isAt . :R2 :Robot :R1 .");
  EXPECT_THAT(
      text,
      HasSubstr("wrong-kind f.ttl:2:7: error: <http://e/isAt> is a property, and a class is meant here"));
  EXPECT_THAT(text, HasSubstr("<http://e/Robot> is a class, and a property is meant here"));
}

TEST_F(OntologyCheckTest, DomainsAndRanges) {
  const std::string text = Check(
      ":Hall a :Place ; :isAt :Hall .\n"
      ":R1 a :Guide ; :isAt \"hall\" ; :isAt :R1 ; :speed :Hall ; :speed \"fast\" ; :speed 1.5e0 .\n"
      ":T a :Thing ; :isAt :Hall .");
  EXPECT_THAT(
      text,
      HasSubstr("domain-clash f.ttl:2:1: error: <http://e/Hall> cannot be <http://e/Robot>, the domain of "
                "<http://e/isAt>"));
  EXPECT_THAT(
      text,
      HasSubstr(
          "range-clash f.ttl:3:22: error: <http://e/isAt> leads to a resource, and \"hall\" is a literal"));
  EXPECT_THAT(text, HasSubstr("<http://e/R1> cannot be <http://e/Place>, the range of <http://e/isAt>"));
  EXPECT_THAT(text, HasSubstr("<http://e/speed> has a literal as value, and <http://e/Hall> is a resource"));
  EXPECT_THAT(text, HasSubstr("\"fast\" is xsd:string; the range of <http://e/speed> is xsd:decimal"));
  EXPECT_THAT(text, HasSubstr("is xsd:double; the range of <http://e/speed> is xsd:decimal"));
  EXPECT_THAT(text,
              HasSubstr("domain-mismatch f.ttl:4:1: warning: <http://e/T> is taken for <http://e/Robot>"));
}

// A resource in two disjoint classes is an inconsistency: kb_server/cli/consistency_check.h.
TEST_F(OntologyCheckTest, ClassesBelowDisjointOnesAndBadLiterals) {
  const std::string text = Check(
      "\n:Odd a owl:Class ; rdfs:subClassOf :Guide , :Place ; rdfs:label \"o\" ; rdfs:comment \"c\" .\n"
      ":R2 :speed \"1,5\"^^xsd:decimal .\n[] a owl:AllDisjointClasses ; owl:members ( :Thing :Guide ) .\n"
      ":Odder a owl:Class ; rdfs:subClassOf :Thing , :Guide .");
  EXPECT_THAT(text, HasSubstr("disjoint-types f.ttl:3:1: error: <http://e/Odd> is below "));
  EXPECT_THAT(text,
              HasSubstr("bad-literal f.ttl:4:12: error: \"1,5\" is not a text that xsd:decimal allows"));
  EXPECT_THAT(text, HasSubstr("<http://e/Odder> is below "));
}

TEST_F(OntologyCheckTest, ValuesThatAreAllowedAndNotComputedAreNoErrors) {
  const std::string text = Check(
      "\n:R2 :since \"999999999999-02-28T00:00:00Z\"^^xsd:dateTime , \"-250000-01-01\"^^xsd:date ,\n"
      "  123456789012345678901234567890123456789012345 , \"012345-01-01\"^^xsd:date , "
      "\"200000-01-01\"^^xsd:date ,\n"
      "  \"999999999999-02-30T00:00:00Z\"^^xsd:dateTime .");
  EXPECT_THAT(
      text,
      HasSubstr("value-range f.ttl:3:12: warning: \"999999999999-02-28T00:00:00Z\" is beyond the values"));
  EXPECT_THAT(text, HasSubstr("value-range f.ttl:3:59: warning: \"-250000-01-01\""));
  EXPECT_THAT(text, HasSubstr("value-range f.ttl:4:3: warning: \"123456"));
  EXPECT_THAT(text, HasSubstr("bad-literal f.ttl:4:51: error: \"012345-01-01\"")) << "XSD has no such year";
  EXPECT_THAT(text, HasSubstr("bad-literal f.ttl:5:3: error: \"999999999999-02-30T00:00:00Z\""));
  EXPECT_EQ(text.find("\"200000-01-01\""), std::string::npos);
}

TEST_F(OntologyCheckTest, CirclesAreToldOnce) {
  const std::string text = Check(
      ":Robot rdfs:subClassOf :Guide .\n:p a owl:ObjectProperty ; rdfs:subPropertyOf :q ; "
      "rdfs:label \"p\" ; rdfs:comment \"p\" . :q rdfs:subPropertyOf :p ; rdfs:label \"q\" .");
  EXPECT_THAT(text,
              HasSubstr("cycle f.ttl:2:24: warning: classes that are below each other: <http://e/Robot> → "
                        "<http://e/Guide> → <http://e/Robot>"));
  EXPECT_THAT(text,
              HasSubstr("properties that are below each other: <http://e/p> → <http://e/q> → <http://e/p>"));
  EXPECT_EQ(text.find("<http://e/q> → <http://e/p> → <http://e/q>"), std::string::npos);
}

TEST_F(OntologyCheckTest, ChainsAndKeysThatAreTooLongForTheRuleSetAreTold) {
  const std::string text = Check(
      ":a owl:propertyChainAxiom ( :p :p :p :p :p :p :p :p ) .\n"
      ":b owl:propertyChainAxiom ( :p :p :p :p :p :p :p :p :p ) .\n"
      ":C owl:hasKey ( :p :p :p :p :p :p ) . :D owl:hasKey ( :p :p :p :p :p :p :p ) .\n"
      ":E owl:hasKey :l . :l <http://www.w3.org/1999/02/22-rdf-syntax-ns#rest> :l .");
  EXPECT_THAT(
      text,
      HasSubstr("long-list f.ttl:3:4: warning: a chain of 9 properties; rule set owl2rl follows up to 8"));
  EXPECT_THAT(text, HasSubstr("a key of 7 properties; rule set owl2rl follows up to 6"));
  EXPECT_THAT(text, Not(HasSubstr("long-list f.ttl:2:")));
  EXPECT_THAT(text, Not(HasSubstr("long-list f.ttl:5:")));  // a circle is no list
  EXPECT_THAT(text, Not(HasSubstr("a key of 6 properties")));
}

TEST_F(OntologyCheckTest, MissingExplanations) {
  const std::string text = Check(":New a owl:Class . :old a owl:DatatypeProperty ; rdfs:label \"old\" .");
  EXPECT_THAT(text,
              HasSubstr("missing-label f.ttl:2:1: warning: <http://e/New> has neither label nor comment"));
  EXPECT_EQ(text.find("<http://e/New>"), text.rfind("<http://e/New>"));
  EXPECT_THAT(text, HasSubstr("<http://e/old> has no comment"));
  EXPECT_THAT(text, Not(HasSubstr("<http://e/old> has no label")));
}

TEST_F(OntologyCheckTest, UnusedPrefixesAndNamespacesThatAreNearlyRight) {
  LocatedRdf document = Parse(
      "@prefix x: <http://x/> .\n@prefix y: <https://E#> . :R1 a :Robot ; rdfs:seeAlso y:Robot .", "d_");
  Findings findings("f.ttl", 100);
  CheckWords(document, vocabulary_, findings);
  const std::string text = Text(findings);
  EXPECT_THAT(text, HasSubstr("unused-prefix f.ttl:2:9: warning: the prefix x: is not used"));
  EXPECT_THAT(text, Not(HasSubstr("prefix y:")));
  EXPECT_THAT(text, HasSubstr("namespace f.ttl:3:"));
  EXPECT_THAT(text, HasSubstr("did you mean <http://e/>?"));
}

TEST_F(OntologyCheckTest, RulesAndQueries) {
  const rules::ParsedRules rules = rules::ParseRules(
      "PREFIX : <http://e/>\nRULE { ?r a :Robott } WHERE {\n  ?r :isat ?p . FILTER NOT EXISTS { ?p :sped 1 } "
      "}",
      "f.rules");
  ASSERT_TRUE(rules.ok()) << Render(rules.diagnostics, "");
  Findings in_rules("f.rules", 100);
  CheckWords(rules, vocabulary_, in_rules);
  const std::string text = Text(in_rules);
  EXPECT_THAT(text, HasSubstr("f.rules:2:13: error: the class <http://e/Robott> is not defined"));
  EXPECT_THAT(text, HasSubstr("f.rules:3:6: error: the property <http://e/isat>"));
  EXPECT_THAT(text, HasSubstr("did you mean <http://e/speed>?"));

  const sparql::ParsedQuery query =
      sparql::ParseQuery("PREFIX : <http://e/> SELECT * { ?r :isat/:speed ?s }", {});
  ASSERT_TRUE(query.ok());
  Findings in_query("q.rq", 100);
  CheckWords(query.query, vocabulary_, in_query);
  EXPECT_THAT(Text(in_query), HasSubstr("did you mean <http://e/isAt>?"));
}

TEST_F(OntologyCheckTest, UnusedPrefixesOfRulesAndQueries) {
  Findings findings("f.rules", 100);
  CheckPrefixes(
      sparql::PrefixPlaces(
          "PREFIX : <http://e/>\nprefix x: <http://x/>  # x:y\nPREFIX y: <http://y/>\n"
          "PREFIX z: <http://z/>\nRULE :r { ?a y: \"x:y\" } WHERE { ?a :b z:c\\-d }\nPREFIX z: <http://zz/>"),
      findings);
  const std::string text = Text(findings);
  EXPECT_THAT(text, HasSubstr("unused-prefix f.rules:2:8: warning: the prefix x: is not used"));
  EXPECT_THAT(text, HasSubstr("unused-prefix f.rules:6:8: warning: the prefix z: is not used"));
  EXPECT_THAT(text, Not(HasSubstr("prefix y:")));
  EXPECT_THAT(text, Not(HasSubstr("prefix :")));
  EXPECT_EQ(text.find("prefix z:"), text.rfind("prefix z:"));
}

TEST_F(OntologyCheckTest, FindingsEndAtTheirLimit) {
  Findings findings("f.ttl", 1);
  findings.Warning("r", {2, 1}, "a", "");
  EXPECT_EQ(findings.left_out(), 0u);
  findings.Warning("r", {1, 1}, "b", "");
  EXPECT_EQ(findings.left_out(), 1u);
  EXPECT_EQ(findings.Take().size(), 1u);
}

}  // namespace
}  // namespace docent::ontology
