#include "reasoner/rules/shacl_rules_import.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "graph/rdf/formats/located_parser.h"
#include "reasoner/rules/rule_engine.h"
#include "reasoner/rules/rule_parser.h"
#include "tests/reasoner/test_world.h"

namespace docent::rules {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr char kPrefixes[] =
    "@prefix : <http://example.org/> . @prefix sh: <http://www.w3.org/ns/shacl#> .\n"
    "@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .\n"
    ":decl sh:declare [ sh:prefix \"ex\" ; sh:namespace \"http://example.org/\" ] .\n";

ImportedRules Import(const std::string& turtle) {
  const LocatedRdf parsed = ParseLocatedRdf(kPrefixes + turtle, RdfFormat::kTurtle, {});
  EXPECT_TRUE(parsed.rdf.ok()) << Render(parsed.rdf.diagnostics, kPrefixes + turtle);
  return ImportShaclRules(parsed, kPrefixes + turtle, "shapes.ttl");
}

std::string Errors(const std::string& turtle) {
  return Render(Import(turtle).diagnostics, "");
}

TEST(ShaclRulesImport, ARuleAppliesToTheTargetsOfItsShape) {
  const ImportedRules imported = Import(
      ":S sh:targetClass :Robot ; sh:targetSubjectsOf :drives ; sh:rule :free .\n"
      ":free a sh:SPARQLRule ; sh:prefixes :decl ; sh:order 1 ;\n"
      "  sh:construct \"CONSTRUCT { $this ex:is ex:free } WHERE { FILTER NOT EXISTS { $this ex:task ?t } }\" "
      ".\n"
      ":Door a rdfs:Class ; sh:rule [ a sh:SPARQLRule ; sh:prefixes :decl ;\n"
      "  sh:construct \"CONSTRUCT { ?room ex:has $this } WHERE { $this ex:of ?room }\" ] .");
  ASSERT_TRUE(imported.ok()) << Render(imported.diagnostics, "");
  EXPECT_EQ(imported.rules, 3u);
  TestWorld world;
  RuleEngine engine(world.dictionary);
  const Diagnostics diagnostics = engine.PutRules("shapes.ttl", imported.text);
  ASSERT_TRUE(diagnostics.empty()) << Render(diagnostics, imported.text);
  ASSERT_TRUE(engine
                  .Update(world.writer, world.Apply({"r a Robot", "s drives x", "t a Robot", "t task y",
                                                     "d a Door", "d of hall", "e of hall"}))
                  .ok());
  EXPECT_THAT(world.Inferred(), ElementsAre("hall has d", "r is free", "s is free"));
}

TEST(ShaclRulesImport, NodesThatAQuerySelectsAreTargets) {
  const ImportedRules imported = Import(
      ":S sh:targetNode :z ; sh:rule :mark ; sh:target [ a sh:SPARQLTarget ; sh:prefixes :decl ;\n"
      "  sh:select \"SELECT ?this { ?this ex:p ?v FILTER(?v > 1) }\" ] .\n"
      ":T sh:rule :note ; sh:target [ a sh:SPARQLTarget ; sh:prefixes :decl ;\n"
      "  sh:select \"SELECT DISTINCT ?this { ?v ex:of ?this }\" ] .\n"
      ":mark a sh:SPARQLRule ; sh:prefixes :decl ; sh:construct \"CONSTRUCT { $this ex:has ex:P } WHERE { "
      "}\" .\n"
      ":note a sh:SPARQLRule ; sh:prefixes :decl ;\n"
      "  sh:construct \"CONSTRUCT { $this ex:n ?v } WHERE { $this ex:v ?v FILTER NOT EXISTS { $this ex:old "
      "true "
      "} }\" .");
  ASSERT_TRUE(imported.ok()) << Render(imported.diagnostics, "");
  EXPECT_EQ(imported.rules, 3u);
  TestWorld world;
  RuleEngine engine(world.dictionary);
  const Diagnostics diagnostics = engine.PutRules("shapes.ttl", imported.text);
  ASSERT_TRUE(diagnostics.empty()) << Render(diagnostics, imported.text);
  ASSERT_TRUE(engine.Update(world.writer, world.Apply({"a p 2", "b p 1", "x of c", "c v 7", "d v 8"})).ok());
  EXPECT_THAT(world.Inferred(), ElementsAre("a has P", "c n 7", "z has P"));
}

TEST(ShaclRulesImport, ATargetThatCannotBeFollowedIsNamed) {
  const std::string rule =
      " ; sh:rule [ a sh:SPARQLRule ; sh:construct \"CONSTRUCT { $this a $this } WHERE { }\" ] .";
  EXPECT_THAT(Errors(":S sh:targetNode :z ; sh:target :near" + rule),
              HasSubstr("its sh:target <http://example.org/near> has no sh:select"));
  EXPECT_THAT(Errors(":S sh:target [ sh:select \"SELECT ?that { ?that ?p ?o }\" ]" + rule),
              HasSubstr("is no SELECT of ?this"));
  EXPECT_THAT(Errors(":S sh:target [ sh:select \"SELECT ?this {\" ]" + rule), HasSubstr("is not SPARQL"));
}

TEST(ShaclRulesImport, WhatIsDeactivatedIsLeftOut) {
  const ImportedRules imported = Import(
      ":S sh:targetClass :C ; sh:deactivated true ; sh:rule [ a sh:SPARQLRule ; sh:construct \"nonsense\" ] "
      ".\n"
      ":T sh:targetClass :C ; sh:rule [ a sh:SPARQLRule ; sh:deactivated true ; sh:construct \"nonsense\" ] "
      ".");
  EXPECT_TRUE(imported.ok());
  EXPECT_EQ(imported.rules, 0u);
}

TEST(ShaclRulesImport, WhatIsNotSupportedIsSaid) {
  EXPECT_THAT(Errors(":S sh:targetClass :C ; sh:rule [ a sh:TripleRule ; sh:subject sh:this ] ."),
              HasSubstr("http://example.org/S: it has no sh:construct"));
  EXPECT_THAT(Errors(":S sh:targetClass :C ; sh:rule [ sh:condition :D ; sh:construct \"x\" ] ."),
              HasSubstr("sh:condition is not supported"));
  EXPECT_THAT(
      Errors(":S sh:targetClass :C ; sh:rule [ sh:construct \"CONSTRUCT { $this nope:p 1 } WHERE { }\" ] ."),
      HasSubstr("not SPARQL"));
  EXPECT_THAT(Errors(":S sh:targetClass :C ; sh:rule [ sh:construct \"ASK { }\" ] ."),
              HasSubstr("not a CONSTRUCT"));
  EXPECT_THAT(Errors(":S sh:rule [ sh:construct \"CONSTRUCT { $this a $this } WHERE { $this ?p ?o }\" ] ."),
              HasSubstr("no target"));
}

// A tester's document: five lines, with mistakes in the third and the last one.
TEST(ShaclRulesImport, WhatIsWrongIsToldWhereTheDocumentHasIt) {
  const std::string errors = Errors(
      ":S sh:targetClass :T ; sh:targetNode :n ; sh:rule [ sh:construct \"\"\"PREFIX ex: <http://ex/>\n"
      "CONSTRUCT { $this ex:hasW ?q }\n"
      "WHERE { $this ex:w ?v }\"\"\" ] , [ sh:prefixes :decl ;\n"
      "  sh:construct \"CONSTRUCT { $this ex:opt ?v } WHERE { $this ex:k ?k OPTIONAL { $this ex:w ?v } }\" ] "
      ";\n"
      "  sh:rule [ sh:construct \"CONSTRUCT { $this nope:p 1 } WHERE { }\" ] ,\n"
      "    [ a sh:TripleRule ] , [ sh:construct \"CONSTRUCT { $this a \\\"q\\\" } WHERE { OPTIONAL { } }\" ] "
      ".");
  EXPECT_THAT(errors, HasSubstr("shapes.ttl:5:27: error: "));
  EXPECT_EQ(errors.find("shapes.ttl:5:27"), errors.rfind("shapes.ttl:5:27"))
      << "a rule of two targets has its mistake once: " << errors;
  EXPECT_THAT(errors, HasSubstr("shapes.ttl:7:69: error: "));
  EXPECT_THAT(errors, HasSubstr("OPTIONAL"));
  EXPECT_THAT(
      errors,
      HasSubstr(
          "shapes.ttl:8:45: error: rule of the shape http://example.org/S: its sh:construct is not SPARQL"));
  EXPECT_THAT(
      errors,
      HasSubstr("shapes.ttl:9:5: error: rule of the shape http://example.org/S: it has no sh:construct"));
  EXPECT_THAT(errors, HasSubstr("shapes.ttl:9:42: error: ")) << "of a literal with escapes its beginning";
}

TEST(ShaclRulesImport, ARuleIsCalledByItsLineInTheDocument) {
  const ImportedRules imported = Import(
      ":S sh:targetClass :C ; sh:rule [ sh:prefixes :decl ;\n  sh:construct \"CONSTRUCT { $this ex:b 1 } "
      "WHERE { $this ex:a 1 }\" ] .\n"
      ":A sh:targetClass :C , :D ;\n\n sh:rule [ sh:prefixes :decl ; sh:construct \"\"\"CONSTRUCT { $this "
      "ex:c 1 }\nWHERE { $this ex:a \"x\\\\ny\" }\"\"\" ] .");
  ASSERT_TRUE(imported.ok()) << Render(imported.diagnostics, "");
  const ParsedRules rules = ParseRules(imported.text, "af.ttl");
  ASSERT_TRUE(rules.ok()) << imported.text;
  ASSERT_EQ(rules.rules.size(), 3u);
  EXPECT_EQ(RuleLabel("af.ttl", rules.rules[0], 1), "af.ttl rule 1 (line 5)");
  EXPECT_EQ(RuleLabel("af.ttl", rules.rules[1], 2), "af.ttl rule 2 (line 8)");
  EXPECT_EQ(RuleLabel("af.ttl", rules.rules[2], 3), "af.ttl rule 3 (line 8)");
}

}  // namespace
}  // namespace docent::rules
