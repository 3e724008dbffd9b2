// What an invoke gives to a flow of the same document, and what it takes from one or from a robot service, by names that they
// do not have.
#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "graph/base/text.h"
#include "workflow/cawl/check/static_checks.h"
#include "workflow/cawl/rule_names.h"
#include "workflow/cawl/symbol_table.h"

namespace docent::cawl {
namespace {

constexpr char kRobot[] = "robot";

// Names that may have a value in runs of a flow and that something in it uses.
struct KnownNames {
  std::set<std::string> names;
  bool complete = true;  // false: something in the flow may use further ones
};

void AddWords(const Constraint& constraint, std::set<std::string>* out) {
  for (const Word* word : {&constraint.subject, &constraint.verb, &constraint.object}) {
    if (!word->name.empty()) out->insert(word->name);
  }
}

void AddWords(const Condition& condition, std::set<std::string>* out) {
  for (const Context& context : condition.contexts) {
    for (const Rule& rule : context.rules) {
      for (const Constraint& constraint : rule.constraints) AddWords(constraint, out);
    }
  }
}

void AddDeclared(const Scope& scope, std::set<std::string>* out) {
  for (const Variable& variable : scope.variables()) {
    out->insert(variable.name.value);
    for (const std::string& key : scope.Keys(variable)) out->insert(key);
  }
  // What an operation that is not described takes.
  for (const Message& message : scope.messages()) {
    for (const Part& part : message.parts) out->insert(part.name.value);
  }
}

// "?place" and "$place" of a query, as `place`.
void AddVariables(std::string_view query, std::set<std::string>* out) {
  const auto in_name = [](char c) {
    return c == '_' || (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
  };
  for (size_t at = query.find_first_of("?$"); at != std::string_view::npos;
       at = query.find_first_of("?$", at + 1)) {
    size_t end = at + 1;
    while (end < query.size() && in_name(query[end])) ++end;
    if (end > at + 1) out->emplace(query.substr(at + 1, end - at - 1));
  }
}

class ExchangeChecker {
 public:
  ExchangeChecker(const Document& document, const Environment* environment, xml::ElementReader* reader)
      : document_(document), environment_(environment), reader_(*reader), cawl_(document) {}

  void Check(Cancellation* cancellation) {
    for (const Flow& flow : document_.flows) {
      for (const Node& node : flow.nodes) {
        if (IsOver(cancellation)) return;
        for (const Invoke& invoke : node.invokes) Check(invoke);
      }
    }
  }

 private:
  void Check(const Invoke& invoke) {
    const Flow* flow = invoke.subflow.empty() ? nullptr : document_.FindFlow(invoke.subflow.value);
    if (flow != nullptr) {
      CheckInputs(invoke, *flow);
      CheckResults(invoke, *flow);
    } else if (environment_ != nullptr && invoke.subflow.empty() && !invoke.capability.given()) {
      const std::optional<OperationSignature> operation = environment_->FindOperation(invoke.operation.value);
      if (operation && !operation->of_robot)
        CheckResults(invoke, Concat("robot service ", operation->name), operation->outputs);
    }
  }

  void CheckInputs(const Invoke& invoke, const Flow& flow) {
    for (const Input& input : invoke.inputs) {
      if (input.part.empty() || input.part.value == kRobot || reader_.full(Diagnostic::Severity::kWarning))
        continue;
      const KnownNames& known = NamesOf(flow);
      if (known.names.contains(input.part.value)) continue;
      const std::vector<std::string> names(known.names.begin(), known.names.end());
      const xml::Advice advice =
          reader_.DidYouMean(input.part.value, names,
                             Concat("write <variable name=\"", input.part.value, "\"/> in flow ",
                                    flow.name.value, ", or take this input away"));
      // An operation of which the inputs are not known may take it: a name that is like none is not looked at.
      if (!known.complete && advice.right.empty()) continue;
      reader_
          .Warning(input.part.span,
                   Concat("flow ", flow.name.value, " does not use ", input.part.value,
                          ": it declares no variable of this name, and nothing in it takes it"),
                   advice)
          .rule = kUnknownInput;
    }
  }

  // Of a flow that says what it gives back.
  void CheckResults(const Invoke& invoke, const Flow& flow) {
    if (flow.outputs.empty()) return;
    std::vector<std::string> known;
    for (const Output& output : flow.outputs)
      known.push_back(output.part.given() ? output.part.value : output.variable.value);
    CheckResults(invoke, Concat("flow ", flow.name.value), known);
  }

  void CheckResults(const Invoke& invoke, const std::string& what, const std::vector<std::string>& known) {
    for (const Output& output : invoke.outputs) {
      if (output.part.empty() || reader_.full(Diagnostic::Severity::kWarning) ||
          std::find(known.begin(), known.end(), output.part.value) != known.end())
        continue;
      reader_
          .Warning(output.part.span,
                   Concat(what, " has no result ", output.part.value, ": variable ", output.variable.value,
                          " gets no value"),
                   reader_.DidYouMean(output.part.value, known,
                                      known.empty() ? std::string("it gives no results")
                                                    : Concat("it gives: ", xml::ListOf(known))))
          .rule = kUnknownOutput;
    }
  }

  // Flows of a document do not contain themselves: an error says so before.
  const KnownNames& NamesOf(const Flow& flow) {
    const auto [it, is_new] = known_.try_emplace(&flow);
    KnownNames& out = it->second;  // stays where it is
    if (!is_new) return out;
    const Scope scope(cawl_, flow);
    AddDeclared(cawl_, &out.names);
    AddDeclared(scope, &out.names);
    for (const Output& output : flow.outputs) out.names.insert(output.variable.value);
    for (const Link& link : flow.links) {
      if (link.while_constraint) AddWords(*link.while_constraint, &out.names);
    }
    for (const Node& node : flow.nodes) {
      AddDeclared(Scope(scope, node), &out.names);
      if (node.condition) AddWords(*node.condition, &out.names);
      if (node.hold) AddWords(*node.hold, &out.names);
      out.names.insert(node.for_each.begin(), node.for_each.end());
      if (!node.compensate.empty()) AddOperation(node.compensate.value, &out);
      for (const Invoke& invoke : node.invokes) AddInvoke(invoke, &out);
    }
    return out;
  }

  void AddInvoke(const Invoke& invoke, KnownNames* out) {
    AddVariables(invoke.choose, &out->names);
    if (invoke.subflow.empty()) return AddOperation(invoke.operation.value, out);
    const Flow* flow = document_.FindFlow(invoke.subflow.value);
    if (flow == nullptr) {
      out->complete = false;
      return;
    }
    const KnownNames& inner = NamesOf(*flow);
    out->names.insert(inner.names.begin(), inner.names.end());
    out->complete = out->complete && inner.complete;
  }

  void AddOperation(const std::string& name, KnownNames* out) const {
    std::optional<OperationSignature> operation;
    if (environment_ != nullptr) operation = environment_->FindOperation(name);
    // Another robot may take more.
    out->complete = out->complete && operation && operation->inputs_known && !operation->of_robot;
    if (operation) out->names.insert(operation->inputs.begin(), operation->inputs.end());
  }

  const Document& document_;
  const Environment* environment_;
  xml::ElementReader& reader_;
  const Scope cawl_;
  std::map<const Flow*, KnownNames> known_;
};

}  // namespace

void CheckExchange(const Document& document, const Environment* environment, xml::ElementReader* reader,
                   Cancellation* cancellation) {
  ExchangeChecker(document, environment, reader).Check(cancellation);
}

}  // namespace docent::cawl
