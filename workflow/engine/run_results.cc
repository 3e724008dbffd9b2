#include "workflow/engine/run_results.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
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
constexpr size_t kMostNotes = 3;

// What cannot be a variable of a run is refused: a name of other characters, and what is beyond kMostResults. → why, or nothing.
std::string RefuseNames(TermBinding* results) {
  size_t taken = 0;
  std::vector<std::string> refused;
  std::erase_if(*results, [&](const auto& result) {
    if (cawl::IsVariableKey(result.first) && ++taken <= kMostResults) return false;
    refused.push_back(result.first);
    return true;
  });
  if (refused.empty()) return "";
  return absl::StrCat(
      refused.size(), " results are refused, the first is \"", CutText(refused[0], kShownBytes),
      "\": the name of a variable has letters (a-z), digits and _, and there are at most ", kMostResults);
}

}  // namespace

// The variables that results of an invocation become: those that its ext:output name, or the variables of their names. One that
// is not of the type that its variable declares is refused: the variable keeps its value. Of a named one that is not given, the
// variable has no value (kNoValue). `*note`: what of it people should know, or nothing.
TermBinding RunStepper::ResultsOf(size_t node, size_t index, const TermBinding& given, std::string* note) {
  InvocationState& invocation = run_.nodes[node].invocations[index];
  invocation.results = ResultsAt({*run_.document, flow_, &flow_.nodes[node]}, invocation.invoke, given, note);
  return invocation.results;
}

TermBinding RunStepper::ResultsAt(const VariablePlace& place, size_t invoke_index, const TermBinding& given,
                                  std::string* note) const {
  const cawl::Invoke& invoke = place.node->invokes[invoke_index];
  TermBinding results;
  std::vector<std::string> notes;
  if (invoke.outputs.empty()) results = given;
  // A robot does not choose the next one by a result that happens to have this name.
  if (invoke.outputs.empty() && invoke.subflow.empty() &&
      core_.services.Find(invoke.operation.value) == nullptr)
    results.erase("robot");
  for (const cawl::Output& output : invoke.outputs) {
    const auto value = given.find(output.part.value);
    results[output.variable.value] = value != given.end() ? value->second : kNoValue;
    if (value == given.end())
      notes.push_back(absl::StrCat("there is no result ", output.part.value, ": variable ",
                                   output.variable.value, " has no value"));
  }
  if (invoke.subflow.empty()) {
    if (std::string why = RefuseNames(&results); !why.empty()) notes.push_back(std::move(why));
  }
  std::erase_if(results, [&](const auto& result) {
    if (result.second == kNoValue) return false;
    const std::string fault = TypeFault(place, result.first, result.second);
    if (!fault.empty())
      notes.push_back(absl::StrCat("the result for variable ", result.first, " is refused: ", fault));
    return !fault.empty();
  });
  if (notes.size() > kMostNotes) {
    const size_t more = notes.size() - kMostNotes;
    notes.resize(kMostNotes);
    notes.push_back(absl::StrCat("and so ", more, " more"));
  }
  *note = absl::StrJoin(notes, "; ");
  return results;
}

}  // namespace docent::engine
