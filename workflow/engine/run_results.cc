#include "workflow/engine/run_results.h"

#include <optional>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
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

// The variables that results of an invocation become: those that its ext:output name, or the variables of their names. One that
// is not of the type that its variable declares is refused: the variable keeps its value.
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
    if (value != given.end())
      results[output.variable.value] = value->second;
    else
      core_.Say(Subject(node, index), "running", "running",
                absl::StrCat("there is no result ", output.part.value));
  }
  const VariablePlace place{*run_.document, flow_, &flow_.nodes[node]};
  std::erase_if(results, [&](const auto& result) {
    const std::string fault = TypeFault(place, result.first, result.second);
    if (!fault.empty())
      core_.Say(Subject(node, index), "running", "running",
                absl::StrCat("the result for variable ", result.first, " is refused: ", fault));
    return !fault.empty();
  });
  return results;
}

}  // namespace docent::engine
