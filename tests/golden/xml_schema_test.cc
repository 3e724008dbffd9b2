// docs/reference/{cawl,rsel}.xsd against the readers: the schemas take every document that the readers take.
#include <libxml/parser.h>
#include <libxml/xmlschemas.h>

#include <memory>

#include "graph/base/text.h"
#include "tests/golden/documents_in_tree.h"
#include "workflow/cawl/parser.h"
#include "workflow/rsel/parser.h"
#include "workflow/xml/xml_document.h"

namespace docent {
namespace {

class Schema {
 public:
  explicit Schema(const std::string& name) {
    const std::string file = Concat(DOCENT_SOURCE_DIR, "/docs/reference/", name);
    xmlSchemaParserCtxtPtr parser = xmlSchemaNewParserCtxt(file.c_str());
    schema_.reset(xmlSchemaParse(parser));
    xmlSchemaFreeParserCtxt(parser);
  }
  bool ok() const { return schema_ != nullptr; }

  bool Takes(const std::string& text) const {
    const std::unique_ptr<xmlDoc, decltype(&xmlFreeDoc)> document(
        xmlReadMemory(text.data(), static_cast<int>(text.size()), nullptr, "UTF-8",
                      XML_PARSE_NONET | XML_PARSE_NOERROR | XML_PARSE_NOWARNING),
        xmlFreeDoc);
    if (document == nullptr) return false;
    const std::unique_ptr<xmlSchemaValidCtxt, decltype(&xmlSchemaFreeValidCtxt)> context(
        xmlSchemaNewValidCtxt(schema_.get()), xmlSchemaFreeValidCtxt);
    xmlSchemaSetValidErrors(context.get(), Ignore, Ignore, nullptr);
    return xmlSchemaValidateDoc(context.get(), document.get()) == 0;
  }

 private:
  static void Ignore(void*, const char*, ...) {}
  struct Deleter {
    void operator()(xmlSchema* schema) const { xmlSchemaFree(schema); }
  };
  std::unique_ptr<xmlSchema, Deleter> schema_;
};

bool ReaderTakes(const std::string& kind, const std::string& text) {
  if (kind == "CAWL") return !HasErrors(cawl::ParseCawl(text, "f").diagnostics);
  return rsel::ParseRsel(text, "f").ok();
}

// The schemas describe documents whose own elements have no namespace, and whose root element is written as documented.
bool IsDescribed(const std::string& text) {
  const xml::ParsedXml parsed = xml::ParseXml(text, "f");
  if (parsed.root == nullptr || !parsed.root->namespace_iri.empty() || !parsed.root->prefix.empty())
    return false;
  return parsed.root->name == "CAWL" || parsed.root->name == "cawl" || parsed.root->name == "rsel";
}

class XmlSchema : public testing::TestWithParam<std::string> {
 protected:
  Schema schema_{GetParam() == "CAWL" ? "cawl.xsd" : "rsel.xsd"};
};

TEST_P(XmlSchema, TakesWhatTheReaderTakes) {
  ASSERT_TRUE(schema_.ok());
  size_t taken = 0, refused_by_both = 0;
  for (const golden::TreeDocument& document : golden::DocumentsInTree(GetParam())) {
    const bool good = ReaderTakes(GetParam(), document.text);
    EXPECT_TRUE(good || !document.shipped) << document.place;
    if (good && IsDescribed(document.text)) {
      EXPECT_TRUE(schema_.Takes(document.text)) << document.place;
      ++taken;
    }
    if (!good && !schema_.Takes(document.text)) ++refused_by_both;
  }
  EXPECT_GE(taken, GetParam() == "CAWL" ? 10u : 5u);
  EXPECT_GE(refused_by_both, 2u);
}

INSTANTIATE_TEST_SUITE_P(Languages, XmlSchema, testing::Values("CAWL", "rsel"),
                         [](const auto& info) { return info.param; });

struct Change {
  const char* from;
  const char* to;
};

// One change each that makes a good document one that is neither CAWL nor RSEL.
void ExpectRefused(const std::string& kind, const std::string& file, const std::vector<Change>& changes) {
  const Schema schema(kind == "CAWL" ? "cawl.xsd" : "rsel.xsd");
  const std::string good = golden::ReadFile(std::filesystem::path(DOCENT_SOURCE_DIR) / file);
  ASSERT_TRUE(schema.Takes(good));
  for (const Change& change : changes) {
    std::string broken = good;
    const size_t at = broken.find(change.from);
    ASSERT_NE(at, std::string::npos) << change.from;
    broken.replace(at, std::string_view(change.from).size(), change.to);
    EXPECT_FALSE(ReaderTakes(kind, broken)) << change.from << " -> " << change.to;
    EXPECT_FALSE(schema.Takes(broken)) << change.from << " -> " << change.to;
  }
}

TEST(XmlSchemas, BrokenWorkflowsAreRefusedByBoth) {
  ExpectRefused("CAWL", "scenarios/s01_booth_guide/booth_guide.cawl.xml",
                {{"<CAWL name=\"BoothGuide\"", "<CAWL"},
                 {"<CAWL name=\"BoothGuide\"", "<CAWL name=\"BoothGuide\" color=\"red\""},
                 {"<serviceProvider name=\"BoothServices\"", "<serviceProvider"},
                 {"<service operation=\"moveToUser\"/>", "<service/>"},
                 {"<baseOntologies>", "<baseOntologies>text"},
                 {"<activate flow=\"BoothGuide\"/>", "<activate flow=\"BoothGuied\"/>"},
                 {"<flow name=\"BoothGuide\">", "<flow name=\"BoothGuide\"><nod name=\"x\"/>"},
                 {"<variable name=\"user\"", "<variable name=\"1user\""},
                 {"<variable name=\"user\"", "<variable name=\"robot\""},
                 {"priority=\"1\"", "priority=\"high\""},
                 {"state=\"deActivate\"", "state=\"off\""},
                 {"<node name=\"Move2User\"", "<node name=\"Move2Booth\""},
                 {"<node name=\"Move2User\"", "<node"},
                 {"<node name=\"Move2User\"", "<node name=\"Move2User\" ext:timeout=\"soon\""},
                 {"<node name=\"Move2User\"", "<node name=\"Move2User\" ext:retry=\"101\""},
                 {"<condition>", "<condition ext:timeout=\"5 parsecs\">"},
                 {"<verb>docent:isAt</verb>", ""},
                 {"<rule name=\"robotReady\">", "<rule name=\"robotReady\"><rule/>"},
                 {"<link from=\"Arrived\"", "<link from=\"Arived\""},
                 {"to=\"Presented\"/>", "/>"},
                 {"to=\"Presented\"/>", "to=\"Presented\" ext:onFailure=\"maybe\"/>"},
                 {"<invoke operation=\"moveToUser\"/>", "<invoke operation=\"moveToUser\"><robot/></invoke>"},
                 {"</CAWL>", "</CAWL><CAWL/>"}});
}

TEST(XmlSchemas, BrokenRobotServicesAreRefusedByBoth) {
  ExpectRefused("rsel", "scenarios/s01_booth_guide/booth_guide.rsel.xml",
                {{"<rsel name=\"BoothServices\"", "<rsel"},
                 {"<message name=\"UserRequest\">", "<message>"},
                 {"<message name=\"UserRequest\">", "<message name=\"BoothRequest\">"},
                 {"<part name=\"user\"", "<part name=\"the user\""},
                 {"input=\"UserRequest\"", "input=\"UserRequst\""},
                 {"<process name=\"moveToUser\"", "<process name=\"moveToBooth\""},
                 {"<invoke operation=\"moveToUser\"", "<invoke"},
                 {"ext:timeout=\"5min\"", "ext:timeout=\"5 minutes\""},
                 {"ext:retry=\"1\"", "ext:retry=\"-1\""},
                 {"ext:retry=\"1\"", "ext:parallel=\"yes\""},
                 {"<input part=\"user\"", "<inputs part=\"user\""},
                 {"<input part=\"user\" from=\"user\"/>", "<input from=\"user\"/>"}});
}

TEST(XmlSchemas, MarkupOfEditorsIsTaken) {
  const Schema schema("cawl.xsd");
  std::string text = golden::ReadFile(std::filesystem::path(DOCENT_SOURCE_DIR) /
                                      "scenarios/s01_booth_guide/booth_guide.cawl.xml");
  text.replace(text.find("<node name"), 10,
               "<e:box xmlns:e=\"urn:e\" x=\"1\">t</e:box><node xmlns:e=\"urn:e\" e:x=\"1\" name");
  EXPECT_TRUE(ReaderTakes("CAWL", text));
  EXPECT_TRUE(schema.Takes(text));
}

}  // namespace
}  // namespace docent
