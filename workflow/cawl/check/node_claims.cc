#include "workflow/cawl/check/node_claims.h"

#include <algorithm>

#include "graph/base/text.h"
#include "workflow/cawl/structure_checks.h"

namespace docent::cawl {

bool Declares(const std::vector<Variable>& variables, const std::string& name) {
  return std::any_of(variables.begin(), variables.end(),
                     [&name](const Variable& v) { return v.name.value == name; });
}

Names Bound(const Node& node) {
  if (!node.condition) return {};
  const std::vector<std::string> bound = BoundBy(*node.condition);
  return {bound.begin(), bound.end()};
}

std::string RobotOf(const Invoke& invoke, Names* uses) {
  const Input* input = invoke.FindInput(kRobot);
  if (input == nullptr) return "";
  if (!input->variable.empty()) {
    uses->insert(input->variable.value);
    return input->variable.value == kRobot ? "" : Concat("$", input->variable.value);
  }
  uses->insert(input->computed.inputs.begin(), input->computed.inputs.end());
  const std::string& text = input->computed.text.value;
  return text == Concat("$", kRobot) ? "" : text;
}

bool Meet(const Names& a, const Names& b) {
  return std::any_of(a.begin(), a.end(), [&b](const std::string& name) { return b.contains(name); });
}

bool Agree(const Setting& a, const Setting& b) {
  return (a.counts_on && b.counts_on) || (a.constant && b.constant && *a.constant == *b.constant);
}

std::map<std::string, Setting> SettingsOf(const Node& node) {
  std::map<std::string, Setting> out;
  const auto add = [&](const std::string& name, Setting setting) {
    if (name.empty() || Declares(node.variables, name.substr(0, name.find('.')))) return;
    const auto [it, is_new] = out.emplace(name, setting);
    if (!is_new) it->second = Setting();
  };
  for (const Action& action : node.actions) {
    const Names inputs(action.computed.inputs.begin(), action.computed.inputs.end());
    for (const Text& output : action.computed.outputs)
      add(output.value, {action.computed.constant, inputs.contains(output.value)});
  }
  for (const Invoke& invoke : node.invokes) {
    for (const Output& output : invoke.outputs) add(output.variable.value, {});
  }
  return out;
}

}  // namespace docent::cawl
