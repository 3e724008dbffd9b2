#include "workflow/templates/node_template.h"

#include <gmock/gmock.h>

#include "absl/strings/str_cat.h"
#include "graph/base/workflow_limits.h"
#include "workflow/cawl/parser.h"
#include "workflow/templates/wsdl_reader.h"

namespace docent::templates {
namespace {

using ::testing::HasSubstr;
using ::testing::SizeIs;

TEST(NodeTemplate, NamesOfPartsAreMadePlainAndUnlike) {
  std::vector<TemplatePart> parts;
  for (const char* name : {"user-name", "user.name", "7", "", "ok"}) EXPECT_TRUE(AddPart(name, "", &parts));
  std::vector<std::string> names;
  for (const TemplatePart& part : parts) names.push_back(part.name);
  EXPECT_THAT(names, ::testing::ElementsAre("user_name", "user_name_2", "p7", "p", "ok"));
}

// The robot knows its input by its own name alone.
TEST(NodeTemplate, APartThatTheServiceCallsOtherwiseIsSentUnderItsName) {
  std::vector<NodeTemplate> all(1);
  NodeTemplate& one = all[0];
  one.operation = "measure";
  for (const char* name : {"größe", "a b", "p-1", "ok"}) AddPart(name, "", &one.inputs);
  for (const char* name : {"länge", "ok2"}) AddPart(name, "", &one.outputs);
  EXPECT_EQ(one.inputs[0].name, "gr__e");
  EXPECT_EQ(one.inputs[0].called, "größe");
  EXPECT_EQ(one.inputs[3].called, "");
  WriteCawl(&all);
  for (const char* line :
       {"<ext:input part=\"größe\" variable=\"gr__e\"/>", "<ext:input part=\"a b\" variable=\"a_b\"/>",
        "<ext:input part=\"p-1\" variable=\"p_1\"/>", "<ext:output part=\"länge\" variable=\"l_nge\"/>",
        "<ext:output part=\"ok2\" variable=\"ok2\"/>", "<variable name=\"gr__e\"/>"}) {
    EXPECT_THAT(one.cawl, HasSubstr(line));
  }
  EXPECT_THAT(one.cawl, ::testing::Not(HasSubstr("part=\"ok\"")));
  const std::string flow = absl::StrCat(
      "<CAWL name=\"c\"><flow name=\"f\"><source name=\"a\"/>", one.cawl,
      "<sink name=\"z\"/><link from=\"a\" to=\"measure\"/><link from=\"measure\" to=\"z\"/></flow></CAWL>");
  const cawl::ParsedCawl parsed = cawl::ParseCawl(flow, "f");
  EXPECT_TRUE(parsed.ok()) << Render(parsed.diagnostics, flow);
}

TEST(NodeTemplate, PartsEndAtTheLimit) {
  std::vector<TemplatePart> parts;
  for (size_t i = 0; i < kWorkflowLimits.import_parts; ++i)
    ASSERT_TRUE(AddPart(absl::StrCat("a", i), "", &parts));
  EXPECT_FALSE(AddPart("b", "", &parts));
  EXPECT_THAT(parts, SizeIs(kWorkflowLimits.import_parts));
}

std::string Wsdl(size_t operations) {
  std::string out =
      "<definitions targetNamespace='urn:t' xmlns='http://schemas.xmlsoap.org/wsdl/'><portType name='P'>";
  for (size_t i = 0; i < operations; ++i) absl::StrAppend(&out, "<operation name='o", i, "'/>");
  return out + "</portType></definitions>";
}

TEST(WsdlReader, OperationsEndAtTheLimit) {
  const ImportedTemplates all = ReadWsdl(Wsdl(kWorkflowLimits.import_templates), "f");
  EXPECT_THAT(all.templates, SizeIs(kWorkflowLimits.import_templates));
  EXPECT_TRUE(all.diagnostics.empty());
  const ImportedTemplates more = ReadWsdl(Wsdl(kWorkflowLimits.import_templates + 1), "f");
  EXPECT_THAT(more.templates, SizeIs(kWorkflowLimits.import_templates));
  ASSERT_THAT(more.diagnostics, SizeIs(1));
  EXPECT_THAT(more.diagnostics[0].message, HasSubstr("import_templates is 1000"));
}

// Each operation looks at all of a large type again.
TEST(WsdlReader, StepsAreBounded) {
  std::string schema =
      "<types><schema xmlns='http://www.w3.org/2001/XMLSchema'><element name='E'><complexType><sequence>";
  for (int i = 0; i < 20000; ++i) schema += "<any/>";
  schema +=
      "</sequence></complexType></element></schema></types><message name='M'><part name='p' "
      "element='E'/></message>";
  std::string text =
      absl::StrCat("<definitions xmlns='http://schemas.xmlsoap.org/wsdl/'>", schema, "<portType name='P'>");
  for (int i = 0; i < 900; ++i)
    absl::StrAppend(&text, "<operation name='o", i, "'><input message='M'/></operation>");
  const ImportedTemplates imported = ReadWsdl(text + "</portType></definitions>", "f");
  EXPECT_THAT(imported.templates, SizeIs(900));
  EXPECT_FALSE(imported.diagnostics.empty());
}

TEST(NodeTemplate, ANodeCanBePastedIntoAFlow) {
  std::vector<NodeTemplate> all(2);
  for (NodeTemplate& one : all) {
    one.operation = "say <hi> & \"bye\"";
    one.service = "Voices & more";
    one.endpoint = "http://x.example.org/?a=1&b=2";
    one.inputs = {{"text", "http://www.w3.org/2001/XMLSchema#string"}, {"to", "https://x.example.org/a<b"}};
    one.inputs[1].type = "https://x.example.org/a";
  }
  WriteCawl(&all);
  EXPECT_THAT(all[1].cawl, HasSubstr("&quot;_2\""));
  const std::string flow =
      absl::StrCat("<CAWL name=\"c\"><flow name=\"f\"><source name=\"a\"/>", all[0].cawl,
                   "<sink name=\"z\"/><link from=\"a\" to=\"say &lt;hi&gt; &amp; &quot;bye&quot;\"/>",
                   "<link from=\"say &lt;hi&gt; &amp; &quot;bye&quot;\" to=\"z\"/></flow></CAWL>");
  const cawl::ParsedCawl parsed = cawl::ParseCawl(flow, "f");
  EXPECT_TRUE(parsed.ok()) << Render(parsed.diagnostics, flow);
}

}  // namespace
}  // namespace docent::templates
