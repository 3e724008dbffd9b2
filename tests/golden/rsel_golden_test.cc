// tests/golden/rsel/CASE: input.xml (or source.txt), optional operations.txt, expected.txt.
#include <sstream>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "tests/golden/findings.h"
#include "tests/golden/golden_file.h"
#include "workflow/rsel/feasibility.h"
#include "workflow/rsel/parser.h"
#include "workflow/rsel/service_registry.h"
#include "workflow/rsel/type_checks.h"

namespace docent::rsel {
namespace {

class RselGolden : public testing::TestWithParam<std::string> {};

std::string Describe(const PlanSource& source) {
  return source.constant ? ToDisplay(*source.constant) : source.slot;
}

std::string Describe(const Plan& plan) {
  std::string out = absl::StrCat("== ", plan.process, "(", absl::StrJoin(plan.inputs, ", "), ")");
  for (const auto& [part, source] : plan.outputs) absl::StrAppend(&out, " -> ", part, "=", Describe(source));
  out += "\n";
  for (size_t i = 0; i < plan.steps.size(); ++i) {
    const PlanStep& step = plan.steps[i];
    absl::StrAppend(&out, "  ", i + 1, "/", plan.steps.size(), " ", step.path, ": ", step.operation, "(");
    for (size_t k = 0; k < step.inputs.size(); ++k) {
      absl::StrAppend(&out, k > 0 ? ", " : "", step.inputs[k].first, "=", Describe(step.inputs[k].second));
    }
    out += ")";
    if (!step.after.empty()) {
      absl::StrAppend(&out, " after ", absl::StrJoin(step.after, ",", [](std::string* o, int s) {
        absl::StrAppend(o, s + 1);
      }));
    }
    if (step.retry > 0) absl::StrAppend(&out, " retry ", step.retry);
    if (step.timeout_ms) absl::StrAppend(&out, " timeout ", *step.timeout_ms, " ms");
    if (step.on_failure == Invoke::OnFailure::kContinue) out += " on failure continue";
    out += "\n";
  }
  return out;
}

// NAME or NAME:TYPE.
void TakePart(const std::string& word, std::vector<std::string>* names, PartTypes* types) {
  const size_t colon = word.find(':');
  names->push_back(word.substr(0, colon));
  if (colon != std::string::npos) (*types)[names->back()] = FullType(word.substr(colon + 1));
}

// Lines: "ROBOT OPERATION INPUT…", or "ROBOT OPERATION INPUT… -> OUTPUT…".
std::vector<OfferedOperation> ReadOperations(const std::string& text) {
  std::vector<OfferedOperation> out;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string robot;
    OfferedOperation operation;
    words >> robot >> operation.name;
    operation.robot = RobotId(robot);
    bool outputs = false;
    for (std::string word; words >> word;) {
      if (word == "->")
        outputs = true;
      else if (outputs)
        TakePart(word, &operation.outputs, &operation.output_types);
      else
        TakePart(word, &operation.inputs, &operation.input_types);
    }
    out.push_back(operation);
  }
  return out;
}

TEST_P(RselGolden, SaysWhatIsExpected) {
  std::filesystem::path folder = std::filesystem::path(DOCENT_SOURCE_DIR) / "tests/golden/rsel" / GetParam();
  std::string source = golden::Input(folder);
  ASSERT_FALSE(source.empty());
  ParsedRsel parsed = ParseRsel(source, "input.xml");
  Diagnostics all = parsed.diagnostics;
  std::string actual = Render(parsed.diagnostics, source);
  ServiceRegistry registry;
  if (parsed.ok()) {
    actual += Render(registry.Put(parsed.document), source);
    if (std::filesystem::exists(folder / "operations.txt")) {
      const Diagnostics of_robots = CheckFeasibility(
          *parsed.document, registry, ReadOperations(golden::ReadFile(folder / "operations.txt")));
      actual += Render(of_robots, source);
      all.insert(all.end(), of_robots.begin(), of_robots.end());
    } else if (!registry.Plans().empty()) {
      const Diagnostics clashes = CheckTypes(*parsed.document, registry, {});
      actual += Render(clashes, source);
      all.insert(all.end(), clashes.begin(), clashes.end());
    }
  }
  actual += golden::RulesAndFixes(all, source);
  for (const PlanPtr& plan : registry.Plans()) actual += Describe(*plan);
  golden::Compare(folder, actual);
  golden::ExpectFixesHelp(parsed.diagnostics, source,
                          [](const std::string& text) { return ParseRsel(text, "input.xml").diagnostics; });
}

INSTANTIATE_TEST_SUITE_P(Cases, RselGolden, testing::ValuesIn(golden::Cases("rsel")),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace docent::rsel
