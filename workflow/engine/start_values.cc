#include "workflow/engine/start_values.h"

#include <algorithm>
#include <set>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "workflow/cawl/structure_checks.h"
#include "workflow/cawl/symbol_table.h"

namespace docent::engine {
namespace {

bool IsStartedByActivator(const cawl::Document& document, const cawl::Flow& flow) {
  return document.activator && document.activator->flow.value == flow.name.value;
}

// Each scope that a run of the flow begins with: of the document, of its activator, of the flow.
template <typename Visit>
void ForEachScope(const cawl::Document& document, const cawl::Flow& flow, const Visit& visit) {
  const cawl::Scope whole(document);
  visit(whole);
  if (IsStartedByActivator(document, flow)) visit(cawl::Scope(whole, *document.activator));
  visit(cawl::Scope(whole, flow));
}

void Collect(const cawl::Condition& condition, std::set<std::string>* names) {
  for (const cawl::Context& context : condition.contexts) {
    for (const cawl::Rule& rule : context.rules) {
      for (const cawl::Constraint& constraint : rule.constraints) {
        for (const cawl::Word* word : {&constraint.subject, &constraint.verb, &constraint.object})
          names->insert(word->name);
      }
    }
  }
}

// What nodes of the flow may give a value to: by a match (a $name without a value is matched, too), an assignment or a result.
std::set<std::string> GivenIn(const Engine::Core& core, const cawl::Flow& flow) {
  std::set<std::string> given;
  for (const cawl::Node& node : flow.nodes) {
    if (node.condition) Collect(*node.condition, &given);
    for (const cawl::Action& action : node.actions) {
      for (const cawl::Text& output : action.computed.outputs) given.insert(output.value);
    }
    for (const cawl::Invoke& invoke : node.invokes) {
      for (const cawl::Output& output : invoke.outputs) given.insert(output.variable.value);
      if (const rsel::PlanPtr plan = core.services.Find(invoke.operation.value)) {
        for (const auto& output : plan->outputs) given.insert(output.first);
      }
    }
  }
  return given;
}

// What nodes cannot do without.
std::set<std::string> NeededIn(const Engine::Core& core, const cawl::Flow& flow,
                               const RobotDirectory& robots) {
  std::set<std::string> needed;
  for (const cawl::Node& node : flow.nodes) {
    for (const cawl::Action& action : node.actions) {
      for (const cawl::Constraint& fact : action.facts) {
        for (const cawl::Word* word : {&fact.subject, &fact.verb, &fact.object}) {
          if (word->kind == cawl::Word::Kind::kVariable) needed.insert(word->name);
        }
      }
      for (const auto& [name, place] : action.uses) needed.insert(name);
    }
    for (const cawl::Invoke& invoke : node.invokes) {
      const std::string& operation = invoke.operation.value;
      std::vector<std::string> inputs;
      if (const rsel::PlanPtr plan = core.services.Find(operation)) {
        inputs = plan->inputs;
      } else if (!operation.empty()) {
        const std::vector<RobotOffer>& offers = robots.Offers(operation);
        if (!offers.empty() && offers.front().inputs) inputs = *offers.front().inputs;
      }
      for (const std::string& input : inputs) {
        if (invoke.FindInput(input) == nullptr) needed.insert(input);
      }
      for (const cawl::Input& input : invoke.inputs) needed.insert(input.variable.value);
    }
  }
  return needed;
}

}  // namespace

std::vector<std::string> RequiredWithoutValue(const cawl::Document& document, const cawl::Flow& flow,
                                              const TermBinding& values) {
  std::vector<std::string> names;
  ForEachScope(document, flow, [&](const cawl::Scope& scope) {
    for (const cawl::Variable& variable : scope.variables()) {
      if (!variable.required) continue;
      for (const std::string& key : scope.Keys(variable)) {
        if (!values.contains(key) && std::find(names.begin(), names.end(), key) == names.end())
          names.push_back(key);
      }
    }
  });
  return names;
}

std::vector<std::string> NeededWithoutValue(const Engine::Core& core, const cawl::Document& document,
                                            const cawl::Flow& flow, const TermBinding& values,
                                            const RobotDirectory& robots) {
  TermBinding at_start = values;
  ForEachScope(document, flow, [&](const cawl::Scope& scope) {
    for (const cawl::InitialValue& initial : InitialValues(scope)) at_start.try_emplace(initial.key, Term());
  });
  std::vector<std::string> names = RequiredWithoutValue(document, flow, at_start);
  if (!IsStartedByActivator(document, flow)) return names;
  const std::set<std::string> given = GivenIn(core, flow), needed = NeededIn(core, flow, robots);
  for (const std::string& name : BoundBy(document.activator->condition)) {
    if (needed.contains(name) && !given.contains(name) && !at_start.contains(name) &&
        std::find(names.begin(), names.end(), name) == names.end())
      names.push_back(name);
  }
  return names;
}

std::string NeedsText(const cawl::Flow& flow, const std::vector<std::string>& names) {
  return absl::StrCat("a run of flow ", flow.name.value, " needs a value of ",
                      absl::StrJoin(names, " and ", [](std::string* out, const std::string& name) {
                        absl::StrAppend(out, "$", name);
                      }));
}

}  // namespace docent::engine
