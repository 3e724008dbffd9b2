// tests/golden/cawl/CASE: input.xml (or source.txt), optional environment.txt and ontology.txt, expected.txt.
#include <sstream>

#include "graph/base/text.h"
#include "graph/rdf/formats/parser.h"
#include "graph/rdf/vocabulary.h"
#include "graph/sparql/values/function_registry.h"
#include "tests/golden/findings.h"
#include "tests/golden/golden_file.h"
#include "workflow/cawl/check/check.h"

namespace docent::cawl {
namespace {

namespace fs = std::filesystem;

class CawlGolden : public testing::TestWithParam<std::string> {};

// Lines: "operation NAME INPUT…", and of such an operation "input NAME PART TYPE", "output NAME RESULT…",
// "step NAME OPERATION TIMEOUT_MS"; "service NAME", "capability IRI", "class IRI", "property IRI", "word IRI".
QuadEnvironment ReadEnvironment(const std::string& text) {
  static const sparql::FunctionRegistry no_functions;  // but the casts
  QuadEnvironment out;
  out.SetFunctions(&no_functions);
  std::vector<TermQuad> quads;
  std::map<std::string, OperationSignature> operations;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string kind, name, first, second;
    words >> kind >> name;
    OperationSignature& operation = operations[name];
    std::string type = kind == "class" ? Concat(kOwlNs, "Class") : Concat(kRdfNs, "Property");
    if (kind == "operation") {
      operation.name = name;
      for (std::string input; words >> input;) operation.inputs.push_back(input);
    } else if (kind == "input") {
      words >> first >> second;
      operation.input_types[first] = second;
    } else if (kind == "output") {
      for (std::string result; words >> result;) operation.outputs.push_back(result);
    } else if (kind == "step") {
      words >> first >> second;
      operation.longest_step = {first, std::stoll(second)};
    } else if (kind == "service") {
      out.AddApplicationService(name);
    } else if (kind == "capability") {
      out.AddCapability(name);
    } else if (kind == "class" || kind == "property") {
      quads.push_back({Term::Iri(name), Term::Iri(std::string(kRdfType)), Term::Iri(type), Term()});
    } else if (kind == "word") {
      quads.push_back({Term::Iri(name), Term::Iri(Concat(kRdfsNs, "label")), Term::Literal("x"), Term()});
    }
  }
  for (const auto& [name, operation] : operations) {
    if (!operation.name.empty()) out.AddOperation(operation);
  }
  out.AddOntology(quads);
  return out;
}

// ontology.txt: files of the tree, one a line.
void AddOntologies(const fs::path& folder, QuadEnvironment* environment) {
  if (!fs::exists(folder / "ontology.txt")) return;
  std::istringstream lines(golden::ReadFile(folder / "ontology.txt"));
  for (std::string line; std::getline(lines, line);) {
    const ParsedRdf parsed =
        ParseRdf(golden::ReadFile(fs::path(DOCENT_SOURCE_DIR) / line), RdfFormat::kTurtle, {});
    ASSERT_TRUE(parsed.ok()) << line;
    environment->AddOntology(parsed.quads);
  }
}

TEST_P(CawlGolden, SaysWhatIsExpected) {
  fs::path folder = fs::path(DOCENT_SOURCE_DIR) / "tests/golden/cawl" / GetParam();
  std::string source = golden::Input(folder);
  ASSERT_FALSE(source.empty());
  bool has_environment = fs::exists(folder / "environment.txt");
  QuadEnvironment environment =
      ReadEnvironment(has_environment ? golden::ReadFile(folder / "environment.txt") : "");
  AddOntologies(folder, &environment);
  const auto check = [&](const std::string& text) {
    return CheckDocument(text, "input.xml", has_environment ? &environment : nullptr);
  };
  CheckReport report = check(source);
  std::string actual = Render(report.diagnostics, source) + golden::RulesAndFixes(report.diagnostics, source);
  for (const ConditionText& condition : report.conditions)
    actual += "== " + condition.place + "\n" + condition.ask + "\n";
  golden::Compare(folder, actual);
  golden::ExpectFixesHelp(report.diagnostics, source,
                          [&](const std::string& text) { return check(text).diagnostics; });
}

INSTANTIATE_TEST_SUITE_P(Cases, CawlGolden, testing::ValuesIn(golden::Cases("cawl")),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace docent::cawl
