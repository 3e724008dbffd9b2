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
    : flow_(flow),
      links_(flow, [](const Link&) { return true; }),
      exceptional_(flow, [](const Link& link) { return link.on_failure || link.on_interrupt; }),
      without_(flow.nodes.size()) {
  for (const Node& node : flow.nodes) {
    const NodeValues& values = nodes_.emplace_back(ValuesOf(node, environment));
    for (const Keys* keys : {&values.matched, &values.assigned, &values.given}) {
      for (const std::string& key : *keys) givers_[key].set(PlaceOf(node));
    }
    give_anything_.set(PlaceOf(node), values.gives_anything);
  }
  const Scope cawl(document), of_activator(cawl, *document.activator), of_flow(cawl, flow);
  start_ = MatchedBy(document.activator->condition);
  for (const Scope* scope : {&cawl, &of_activator, &of_flow}) AddInitial(*scope, &start_);
}

bool FlowValues::MayHaveBefore(const std::string& key, const Node& node) const {
  const size_t place = PlaceOf(node);
  if (start_.contains(key) || nodes_[place].matched.contains(key)) return true;
  return (GiversOf(key) & links_.Before(place)).any();
}

bool FlowValues::MayHaveIn(const std::string& key, const Node& node, const Action* action) const {
  const size_t place = PlaceOf(node);
  const NodeValues& own = nodes_[place];
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
  NodeSet givers = GiversOf(key) & links_.Before(place);
  if (goes_on || givers.none()) return givers.any();
  return (givers.reset(place) & ReachedWithout(place)).any();
}

bool FlowValues::MayHaveAfter(const std::string& key, const Node& node) const {
  return MayHaveBefore(key, node) || GiversOf(key)[PlaceOf(node)];
}

NodeSet FlowValues::GiversOf(const std::string& key) const {
  const auto it = givers_.find(key);
  return it == givers_.end() ? give_anything_ : give_anything_ | it->second;
}

const NodeSet& FlowValues::ReachedWithout(size_t node) const {
  std::optional<NodeSet>& reached = without_[node];
  if (!reached) reached = links_.ReachedWith(node, exceptional_.Next(node));
  return *reached;
}

}  // namespace docent::cawl
