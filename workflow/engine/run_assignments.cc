// Values that a run computes: variables that a node sets from a SELECT or an expression (ext:assign), and inputs of an
// invocation (ext:input).
#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "graph/base/overload.h"
#include "graph/rdf/term_check.h"
#include "workflow/cawl/structure_checks.h"
#include "workflow/engine/run_stepper.h"
#include "workflow/engine/run_values.h"

namespace docent::engine {

// On the facts of this turn, with the values of variables; `overlay` has those of one invocation.
absl::StatusOr<std::vector<TermBinding>> RunStepper::Compute(const cawl::Computation& computed,
                                                             const TermBinding* overlay) const {
  TermBinding given;
  for (const std::string& input : computed.inputs) {
    const std::optional<Term> value = Value(input, overlay);
    if (!value) return absl::FailedPreconditionError(absl::StrCat("variable $", input, " has no value"));
    given.emplace(input, *value);
  }
  if (core_.input->facts == nullptr) return absl::FailedPreconditionError("there is no graph");
  std::vector<std::string> names;
  for (const cawl::Text& output : computed.outputs) names.push_back(output.value);
  absl::StatusOr<std::vector<TermBinding>> solutions =
      core_.input->facts->Select(*computed.query, given, names);
  if (solutions.ok() && !computed.ordered) std::sort(solutions->begin(), solutions->end());
  return solutions;
}

absl::Status RunStepper::Assign(size_t index, const cawl::Action& action) {
  const auto refused = [](const absl::Status& why) {
    return WithMessage(why, absl::StrCat("it cannot assign: ", why.message()));
  };
  absl::StatusOr<std::vector<TermBinding>> solutions = Compute(action.computed, nullptr);
  if (!solutions.ok()) return refused(solutions.status());
  std::vector<std::string> names;
  for (const cawl::Text& output : action.computed.outputs) names.push_back(output.value);
  const bool none = solutions->empty() || (names.size() == 1 && solutions->front().empty());
  if (none && !action.may_be_none && !action.otherwise) {
    return refused(absl::FailedPreconditionError(
        solutions->empty() ? "the SELECT has no solution"
                           : absl::StrCat("there is no value for variable ", names[0])));
  }
  TermBinding values = solutions->empty() ? TermBinding() : solutions->front();
  for (const std::string& name : names) {
    if (action.otherwise) values.try_emplace(name, *action.otherwise);
  }
  if (absl::Status status = CheckAssigned(index, values); !status.ok()) return refused(status);
  KeepSolutions(action, *std::move(solutions));
  core_.Say(
      Subject(index), "running", "running",
      absl::StrCat("assigned ", absl::StrJoin(names, ", ", [&](std::string* out, const std::string& name) {
                     const auto value = values.find(name);
                     absl::StrAppend(out, name, " = ",
                                     value == values.end() ? "nothing" : ToDisplay(value->second));
                   })));
  std::set<std::string> erased;
  for (const std::string& name : names) {
    if (!values.contains(name) && run_.variables.erase(name) > 0) erased.insert(name);
  }
  if (!erased.empty()) RearmWaiting(erased);
  if (run_.state == WorkState::kRunning) SetVariables(values);  // last: it may end the run
  return absl::OkStatus();
}

// What its ext:input are now. FAILED_PRECONDITION and others: why one of them has no value.
absl::Status RunStepper::TakeInputs(size_t node, size_t index) {
  InvocationState& invocation = run_.nodes[node].invocations[index];
  TermBinding taken;
  for (const cawl::Input& input : flow_.nodes[node].invokes[invocation.invoke].inputs) {
    const auto none = [&input](const std::string& why) {
      return absl::FailedPreconditionError(
          absl::StrCat("there is no value for input ", input.part.value, ": ", why));
    };
    if (input.variable.given()) {
      const std::optional<Term> value = Value(input.variable.value, &invocation.binding);
      if (!value) return none(absl::StrCat("variable $", input.variable.value, " has no value"));
      taken.emplace(input.part.value, *value);
      continue;
    }
    absl::StatusOr<std::vector<TermBinding>> computed = Compute(input.computed, &invocation.binding);
    if (!computed.ok()) return none(std::string(computed.status().message()));
    if (computed->empty() || computed->front().empty())
      return none(absl::StrCat(input.computed.text.value, " has none"));
    const Term& value = computed->front().begin()->second;
    if (const absl::Status sound = CheckTerm(value, core_.limits.term_bytes); !sound.ok())
      return none(std::string(sound.message()));
    taken.emplace(input.part.value, value);
  }
  invocation.inputs = std::move(taken);
  return absl::OkStatus();
}

// Of the types that the variables declare.
absl::Status RunStepper::CheckAssigned(size_t index, const TermBinding& values) const {
  for (const auto& [name, value] : values) {
    if (absl::Status sound = CheckTerm(value, core_.limits.term_bytes); !sound.ok())
      return WithMessage(sound, absl::StrCat("variable ", name, ": ", sound.message()));
  }
  const std::string fault = TypeFault({*run_.document, flow_, &flow_.nodes[index]}, values);
  return fault.empty() ? absl::OkStatus() : absl::InvalidArgumentError(fault);
}

// Where a node has forEach of a variable that its condition does not bind, all solutions are kept.
void RunStepper::KeepSolutions(const cawl::Action& action, std::vector<TermBinding> solutions) {
  std::vector<std::string> wanted;
  for (const cawl::Node& node : flow_.nodes) {
    const std::vector<std::string> bound =
        node.condition ? cawl::BoundBy(*node.condition) : std::vector<std::string>();
    for (const std::string& name : node.for_each) {
      const bool set = std::any_of(action.computed.outputs.begin(), action.computed.outputs.end(),
                                   [&](const cawl::Text& output) { return output.value == name; });
      if (set && std::find(bound.begin(), bound.end(), name) == bound.end()) wanted.push_back(name);
    }
  }
  if (wanted.empty()) return;
  const auto kept = std::make_shared<const std::vector<TermBinding>>(std::move(solutions));
  for (const std::string& name : wanted) run_.actions.solutions[name] = kept;
}

}  // namespace docent::engine
