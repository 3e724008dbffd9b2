#include "reasoner/rules/shacl_rules_import.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kb_server/rdf/parser.h"
#include "reasoner/rules/rule_engine.h"
#include "tests/reasoner/test_world.h"

namespace docent {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr char kPrefixes[] =
    "@prefix : <http://example.org/> . @prefix sh: <http://www.w3.org/ns/shacl#> .\n"
    "@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .\n"
    ":decl sh:declare [ sh:prefix \"ex\" ; sh:namespace \"http://example.org/\" ] .\n";

ImportedRules Import(const std::string& turtle) {
  const ParsedRdf parsed = ParseRdf(kPrefixes + turtle, RdfFormat::kTurtle, {});
  EXPECT_TRUE(parsed.ok()) << Render(parsed.diagnostics, kPrefixes + turtle);
  return ImportShaclRules(parsed.quads, "shapes.ttl");
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
              HasSubstr("no CONSTRUCT"));
  EXPECT_THAT(Errors(":S sh:rule [ sh:construct \"CONSTRUCT { $this a $this } WHERE { $this ?p ?o }\" ] ."),
              HasSubstr("no target"));
}

}  // namespace
}  // namespace docent
