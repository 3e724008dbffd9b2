#include "workflow/cawl/check/flow_values.h"

#include <optional>

#include "workflow/cawl/structure_checks.h"
#include "workflow/cawl/symbol_table.h"

namespace docent::cawl {
namespace {

void AddInitial(const Scope& scope, Keys* keys) {
  for (const InitialValue& initial : InitialValues(scope)) {
    if (initial.value || keys->contains(initial.copy_of)) keys->insert(initial.key);
  }
}

bool Assigns(const Action& action, const std::string& key) {
  for (const Text& output : action.computed.outputs) {
    if (output.value == key) return true;
  }
  return false;
}

// An operator may skip the node, and give it values.
bool MayBeSkipped(const Flow& flow, const Node& node) {
  return node.on_failure == OnFailure::kIncident ||
         (node.on_failure == OnFailure::kUnset && flow.on_failure == OnFailure::kIncident);
}

}  // namespace

Keys MatchedBy(const Condition& condition) {
  Keys out;
  for (const std::string& name : BoundBy(condition)) out.insert(name);
  for (const Context& context : condition.contexts) {
    for (const Rule& rule : context.rules) {
      for (const Constraint& c : rule.constraints) {
        for (const Word* word : {&c.subject, &c.verb, &c.object}) {
          if (word->kind == Word::Kind::kVariable && word->comparison == Word::Comparison::kNone)
            out.insert(word->name);
        }
      }
    }
  }
  return out;
}

FlowValues::NodeValues FlowValues::ValuesOf(const Node& node, const Environment* environment) {
  NodeValues out;
  if (node.condition) out.matched = MatchedBy(*node.condition);
  for (const Action& action : node.actions) {
    for (const Text& output : action.computed.outputs) out.assigned.insert(output.value);
  }
  for (const Invoke& invoke : node.invokes) {
    for (const Output& output : invoke.outputs) out.given.insert(output.variable.value);
    if (!invoke.outputs.empty()) continue;
    std::optional<OperationSignature> operation;
    if (environment != nullptr && !invoke.operation.empty())
      operation = environment->FindOperation(invoke.operation.value);
    if (!operation || operation->of_robot) {
      out.gives_anything = true;
    } else {
      out.given.insert(operation->outputs.begin(), operation->outputs.end());
    }
  }
  return out;
}

FlowValues::FlowValues(const Document& document, const Flow& flow, const Environment* environment)
    : flow_(flow) {
  for (const Link& link : flow.links) {
    links_[link.from.value].insert(link.to.value);
    if (link.on_failure || link.on_interrupt) exceptional_[link.from.value].insert(link.to.value);
  }
  for (const Node& node : flow.nodes) nodes_.push_back(ValuesOf(node, environment));
  const Scope cawl(document), of_activator(cawl, *document.activator), of_flow(cawl, flow);
  start_ = MatchedBy(document.activator->condition);
  for (const Scope* scope : {&cawl, &of_activator, &of_flow}) AddInitial(*scope, &start_);
}

bool FlowValues::MayHaveBefore(const std::string& key, const Node& node) const {
  if (start_.contains(key) || Of(node).matched.contains(key)) return true;
  for (const Node& other : flow_.nodes) {
    if (Of(other).Gives(key) && LeadsTo(other.name.value, node.name.value)) return true;
  }
  return false;
}

bool FlowValues::MayHaveIn(const std::string& key, const Node& node, const Action* action) const {
  const NodeValues& own = Of(node);
  if (start_.contains(key) || own.matched.contains(key)) return true;
  const auto when = action == nullptr ? Action::When::kOpen : action->when;
  if (when != Action::When::kOpen && (own.gives_anything || own.given.contains(key))) return true;
  bool before = true;  // `action`
  for (const Action& other : node.actions) {
    if (&other == action) before = false;
    const bool earlier = other.when == when ? before : other.when < when;
    if (earlier && Assigns(other, key)) return true;
  }
  // Without a solution for its values it invokes nothing, and is done.
  const bool goes_on = MayBeSkipped(flow_, node) || (!node.for_each.empty() && action == nullptr);
  for (const Node& other : flow_.nodes) {
    if (!Of(other).Gives(key) || !LeadsTo(other.name.value, node.name.value)) continue;
    if (goes_on || (&other != &node && ReachedWithout(node).contains(other.name.value))) return true;
  }
  return false;
}

bool FlowValues::MayHaveAfter(const std::string& key, const Node& node) const {
  return MayHaveBefore(key, node) || Of(node).Gives(key);
}

// By a way of one link at least.
bool FlowValues::LeadsTo(const std::string& from, const std::string& to) const {
  const auto [it, is_new] = after_.try_emplace(from);
  if (is_new) {
    const auto first = links_.find(from);
    if (first != links_.end()) {
      for (const std::string& next : first->second) it->second.merge(Reachable(links_, next));
    }
  }
  return it->second.contains(to);
}

// What a run reaches before the node is done for the first time.
const std::set<std::string>& FlowValues::ReachedWithout(const Node& node) const {
  const auto [it, is_new] = without_.try_emplace(node.name.value);
  if (is_new) {
    LinkGraph links = links_;
    const auto exceptional = exceptional_.find(node.name.value);
    links[node.name.value] =
        exceptional == exceptional_.end() ? std::set<std::string>() : exceptional->second;
    it->second = Reachable(links, flow_.source.value);
  }
  return it->second;
}

}  // namespace docent::cawl
