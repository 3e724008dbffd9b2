// `docent fmt` over all documents of the tree: what is read from them stays the same.
#include "tests/golden/documents_in_tree.h"
#include "tests/workflow/xml/same_document.h"
#include "workflow/cawl/check/check.h"
#include "workflow/rsel/parser.h"
#include "workflow/xml/formatter.h"

namespace docent {
namespace {

// What a reader says of a text, without places.
std::string Read(const std::string& kind, const std::string& text) {
  Diagnostics diagnostics;
  std::string out;
  if (kind == "CAWL") {
    const cawl::CheckReport report = cawl::CheckDocument(text, "f", nullptr);
    for (const cawl::ConditionText& condition : report.conditions)
      out += condition.place + condition.ask + "\n";
    diagnostics = report.diagnostics;
  } else {
    diagnostics = rsel::ParseRsel(text, "f").diagnostics;
  }
  for (const Diagnostic& d : diagnostics) out += d.message + "\n";
  return out;
}

class FormatGolden : public testing::TestWithParam<std::string> {};

TEST_P(FormatGolden, NothingButLayoutChanges) {
  for (const golden::TreeDocument& document : golden::DocumentsInTree(GetParam())) {
    const xml::FormattedXml formatted = xml::FormatXml(document.text, "f");
    if (!formatted.ok()) {
      EXPECT_FALSE(document.shipped) << document.place;
      continue;
    }
    EXPECT_EQ(xml::Content(formatted.text), xml::Content(document.text)) << document.place;
    EXPECT_EQ(Read(GetParam(), formatted.text), Read(GetParam(), document.text)) << document.place;
    EXPECT_EQ(xml::FormatXml(formatted.text, "f").text, formatted.text) << document.place;
    if (document.place.find("scenarios") != std::string::npos) {
      EXPECT_EQ(formatted.text, document.text);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Languages, FormatGolden, testing::Values("CAWL", "rsel"),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace docent
