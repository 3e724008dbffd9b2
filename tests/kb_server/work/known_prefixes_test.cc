#include "kb_server/work/known_prefixes.h"

#include "absl/strings/str_cat.h"
#include "graph/rdf/vocabulary.h"
#include "gtest/gtest.h"

namespace docent::server {
namespace {

using List = std::vector<std::pair<std::string, std::string>>;

void AddModule(Catalog* catalog, Document::Kind kind, const std::string& name, const std::string& text) {
  ModuleEntry entry;
  entry.name = name;
  entry.kind = kind;
  entry.text = std::make_shared<const std::string>(text);
  catalog->modules.push_back(std::move(entry));
}

TEST(KnownPrefixesTest, AModuleKeepsTheDeclarationsThatAreItsOwn) {
  EXPECT_EQ(
      DeclarePrefixes({{"docent", std::string(kDocentNs)}, {"expo", "urn:expo:"}, {"rdf", "urn:other:"}}),
      "@prefix expo: <urn:expo:> .\n@prefix rdf: <urn:other:> .\n");
  EXPECT_EQ(DeclarePrefixes({}), "");
}

TEST(KnownPrefixesTest, PrefixesPastALimitAreLeftOut) {
  PrefixLimits limits;
  limits.module_prefixes = 2;
  limits.prefix_bytes = 10;
  EXPECT_EQ(
      DeclarePrefixes({{"a", "urn:1:"}, {"b", "urn:2:34567"}, {"c", "urn:3:"}, {"d", "urn:4:"}}, limits),
      "@prefix a: <urn:1:> .\n@prefix c: <urn:3:> .\n");
  EXPECT_EQ(DeclarePrefixes({{"a", "urn:12345"}}, limits), "@prefix a: <urn:12345> .\n");  // at the limit
  limits.known_prefixes = IriNames::WellKnown().prefixes().size() + 1;
  auto catalog = std::make_shared<Catalog>();
  AddModule(catalog.get(), Document::Kind::kOntology, "m", "@prefix a: <urn:1:> .\n@prefix b: <urn:2:> .\n");
  CatalogPort port;
  port.Publish(catalog);
  const auto names = KnownPrefixes(&port, limits).Get();
  EXPECT_EQ(names->Iri("urn:1:x"), "a:x");
  EXPECT_EQ(names->Iri("urn:2:x"), "<urn:2:x>");
}

TEST(KnownPrefixesTest, ModulesRulesAndWorkflowsDeclareThem) {
  auto catalog = std::make_shared<Catalog>();
  AddModule(catalog.get(), Document::Kind::kRules, "r.rules",
            "PREFIX r: <urn:r:>\nPREFIX o: <urn:not-this:>\nRULE \"x\" { ?a r:b ?c } WHERE { ?a r:c ?c }");
  AddModule(catalog.get(), Document::Kind::kOntology, "o.ttl",
            "@prefix o: <urn:o:> .\n@prefix docent: <urn:no:> .\n");
  auto workflow = std::make_shared<cawl::Document>();
  workflow->prefixes = {{"w", "urn:w:"}, {"r", "urn:nor-this:"}};
  catalog->workflows.emplace_back(workflow, Revision());
  CatalogPort port;
  port.Publish(catalog);
  KnownPrefixes prefixes(&port);
  const auto names = prefixes.Get();
  EXPECT_EQ(names->Iri("urn:o:x"), "o:x");
  EXPECT_EQ(names->Iri("urn:r:x"), "r:x");
  EXPECT_EQ(names->Iri("urn:w:x"), "w:x");
  EXPECT_EQ(names->Iri(DocentIri("isAt")), "docent:isAt");
  EXPECT_EQ(names->Iri("urn:no:x"), "<urn:no:x>");
  EXPECT_EQ(prefixes.Get(), names);  // read once
  EXPECT_EQ(KnownNames(ReadPorts()), nullptr);
}

}  // namespace
}  // namespace docent::server
