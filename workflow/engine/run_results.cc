#include "workflow/engine/run_results.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "graph/base/cut_text.h"
#include "workflow/cawl/symbol_table.h"
#include "workflow/engine/run_stepper.h"
#include "workflow/engine/run_values.h"

namespace docent::engine {

TermBinding FlowResults(const Run& run) {
  TermBinding results;
  for (const cawl::Output& output : run.Flow().outputs) {
    const auto value = run.variables.find(output.variable.value);
    if (value == run.variables.end()) continue;
    results[output.part.given() ? output.part.value : output.variable.value] = value->second;
  }
  return results;
}

namespace {

constexpr size_t kMostResults = 1000;  // of one invocation
constexpr size_t kShownBytes = 60;

}  // namespace

// What cannot be a variable of a run is refused: a name of other characters, and what is beyond kMostResults.
void RunStepper::RefuseNames(const std::string& subject, TermBinding* results) {
  size_t taken = 0;
  std::vector<std::string> refused;
  std::erase_if(*results, [&](const auto& result) {
    if (cawl::IsVariableKey(result.first) && ++taken <= kMostResults) return false;
    refused.push_back(result.first);
    return true;
  });
  if (refused.empty()) return;
  core_.Say(
      subject, "running", "running",
      absl::StrCat(refused.size(), " results are refused, the first is \"", CutText(refused[0], kShownBytes),
                   "\": the name of a variable has letters (a-z), digits and _, and there are at most ",
                   kMostResults));
}

// The variables that results of an invocation become: those that its ext:output name, or the variables of their names. One that
// is not of the type that its variable declares is refused: the variable keeps its value. Of a named one that is not given, the
// variable has no value (kNoValue).
TermBinding RunStepper::ResultsOf(size_t node, size_t index, const TermBinding& given) {
  const cawl::Invoke& invoke = flow_.nodes[node].invokes[run_.nodes[node].invocations[index].invoke];
  TermBinding results;
  if (invoke.outputs.empty()) results = given;
  // A robot does not choose the next one by a result that happens to have this name.
  if (invoke.outputs.empty() && invoke.subflow.empty() &&
      core_.services.Find(invoke.operation.value) == nullptr)
    results.erase("robot");
  for (const cawl::Output& output : invoke.outputs) {
    const auto value = given.find(output.part.value);
    results[output.variable.value] = value != given.end() ? value->second : kNoValue;
    if (value == given.end())
      core_.Say(Subject(node, index), "running", "running",
                absl::StrCat("there is no result ", output.part.value, ": variable ", output.variable.value,
                             " has no value"));
  }
  if (invoke.subflow.empty()) RefuseNames(Subject(node, index), &results);
  const VariablePlace place{*run_.document, flow_, &flow_.nodes[node]};
  std::erase_if(results, [&](const auto& result) {
    if (result.second == kNoValue) return false;
    const std::string fault = TypeFault(place, result.first, result.second);
    if (!fault.empty())
      core_.Say(Subject(node, index), "running", "running",
                absl::StrCat("the result for variable ", result.first, " is refused: ", fault));
    return !fault.empty();
  });
  run_.nodes[node].invocations[index].results = results;
  return results;
}

}  // namespace docent::engine
