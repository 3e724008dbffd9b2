// tests/golden/cawl/CASE: input.xml (or source.txt), optional environment.txt, expected.txt.
#include <sstream>

#include "graph/base/text.h"
#include "graph/rdf/vocabulary.h"
#include "tests/golden/golden_file.h"
#include "workflow/cawl/check.h"

namespace docent::cawl {
namespace {

class CawlGolden : public testing::TestWithParam<std::string> {};

// Lines: "operation NAME INPUT…", "service NAME", "class IRI", "property IRI", "word IRI".
QuadEnvironment ReadEnvironment(const std::string& text) {
  QuadEnvironment out;
  std::vector<TermQuad> quads;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string kind, name;
    words >> kind >> name;
    std::string type = kind == "class" ? Concat(kOwlNs, "Class") : Concat(kOwlNs, "ObjectProperty");
    if (kind == "operation") {
      OperationSignature operation;
      operation.name = name;
      for (std::string input; words >> input;) operation.inputs.push_back(input);
      out.AddOperation(operation);
    } else if (kind == "service") {
      out.AddApplicationService(name);
    } else if (kind == "class" || kind == "property") {
      quads.push_back({Term::Iri(name), Term::Iri(std::string(kRdfType)), Term::Iri(type), Term()});
    } else if (kind == "word") {
      quads.push_back({Term::Iri(name), Term::Iri(Concat(kRdfsNs, "label")), Term::Literal("x"), Term()});
    }
  }
  out.AddOntology(quads);
  return out;
}

TEST_P(CawlGolden, SaysWhatIsExpected) {
  std::filesystem::path folder = std::filesystem::path(DOCENT_SOURCE_DIR) / "tests/golden/cawl" / GetParam();
  std::string source = golden::Input(folder);
  ASSERT_FALSE(source.empty());
  bool has_environment = std::filesystem::exists(folder / "environment.txt");
  QuadEnvironment environment =
      ReadEnvironment(has_environment ? golden::ReadFile(folder / "environment.txt") : "");
  CheckReport report = CheckDocument(source, "input.xml", has_environment ? &environment : nullptr);
  std::string actual = Render(report.diagnostics, source);
  for (const ConditionText& condition : report.conditions)
    actual += "== " + condition.place + "\n" + condition.ask + "\n";
  golden::Compare(folder, actual);
}

INSTANTIATE_TEST_SUITE_P(Cases, CawlGolden, testing::ValuesIn(golden::Cases("cawl")),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace docent::cawl
