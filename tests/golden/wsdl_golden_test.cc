// tests/golden/wsdl/CASE: input.xml, expected.txt: what is said of it, and the templates.
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "graph/rdf/iri_names.h"
#include "tests/golden/golden_file.h"
#include "workflow/cawl/parser.h"
#include "workflow/templates/wsdl_reader.h"

namespace docent::templates {
namespace {

class WsdlGolden : public testing::TestWithParam<std::string> {};

std::string Describe(const std::vector<TemplatePart>& parts) {
  return absl::StrJoin(parts, ", ", [](std::string* out, const TemplatePart& part) {
    absl::StrAppend(out, part.name, part.type.empty() ? "" : " ",
                    part.type.empty() ? "" : IriNames::WellKnown().Iri(part.type));
  });
}

TEST_P(WsdlGolden, SaysWhatIsExpected) {
  const std::filesystem::path folder =
      std::filesystem::path(DOCENT_SOURCE_DIR) / "tests/golden/wsdl" / GetParam();
  const std::string source = golden::Input(folder);
  ASSERT_FALSE(source.empty());
  const ImportedTemplates imported = ReadWsdl(source, "input.xml");
  std::string actual = Render(imported.diagnostics, source), nodes;
  for (const NodeTemplate& one : imported.templates) {
    absl::StrAppend(&actual, "== ", one.operation, "(", Describe(one.inputs), ") -> (", Describe(one.outputs),
                    ") of ", one.service, " at ", one.endpoint, "\n", one.cawl);
    nodes += one.cawl;
  }
  golden::Compare(folder, actual);
  // As a person pastes them.
  const std::string document =
      absl::StrCat("<CAWL name=\"c\"><flow name=\"f\"><source name=\"docent begins\"/>", nodes,
                   "<sink name=\"docent ends\"/></flow></CAWL>");
  for (const Diagnostic& d : cawl::ParseCawl(document, "pasted").diagnostics) {
    const bool of_links = d.message.find("link") != std::string::npos ||
                          d.message.find("no path leads") != std::string::npos ||
                          d.message.find("cannot be reached") != std::string::npos;
    EXPECT_TRUE(of_links || d.severity == Diagnostic::Severity::kWarning) << d.message << "\n" << document;
  }
}

INSTANTIATE_TEST_SUITE_P(Cases, WsdlGolden, testing::ValuesIn(golden::Cases("wsdl")),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace docent::templates
