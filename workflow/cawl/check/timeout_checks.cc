// Timeouts that end nothing: of what takes no time, or behind another one that ends first; attempts that come too late.
#include <algorithm>

#include "absl/strings/str_cat.h"
#include "graph/base/limits.h"
#include "graph/base/text.h"
#include "workflow/cawl/check/static_checks.h"
#include "workflow/cawl/rule_names.h"

namespace docent::cawl {
namespace {

// "5min", "90s": as a document writes it.
std::string Shown(int64_t ms) {
  if (ms % 3600000 == 0) return absl::StrCat(ms / 3600000, "h");
  if (ms % 60000 == 0) return absl::StrCat(ms / 60000, "min");
  if (ms % 1000 == 0) return absl::StrCat(ms / 1000, "s");
  return absl::StrCat(ms, "ms");
}

bool IsEmpty(const Condition& condition) {
  return condition.contexts.empty() && condition.cases.empty();
}

class TimeoutChecker {
 public:
  TimeoutChecker(const Environment* environment, xml::ElementReader* reader)
      : environment_(environment), reader_(*reader) {}

  void Check(const Document& document) {
    if (document.activator && document.activator->condition.timeout_text.given()) {
      Warn(document.activator->condition.timeout_text,
           "an activator waits for ever: its condition has no end",
           "take the timeout away, or give it to the condition of a node");
    }
    for (const Flow& flow : document.flows) {
      for (const Node& node : flow.nodes) Check(node);
    }
  }

 private:
  // `text`: the value of the attribute, which the fix takes away.
  void Warn(const Text& text, std::string message, std::string hint) {
    Diagnostic& report =
        reader_.Warning(text.span, Concat("the timeout has no effect: ", message), std::move(hint));
    report.rule = kTimeoutWithoutEffect;
    report.fix = {reader_.AttributeRemoval(text.span)};
  }

  void Check(const Node& node) {
    const bool waits = std::any_of(node.actions.begin(), node.actions.end(),
                                   [](const Action& action) { return action.waits; });
    if (node.timeout_ms && node.invokes.empty() && !waits) {
      Warn(node.timeout_text,
           Concat("node ", node.name.value, " invokes nothing and is done as soon as it opens"),
           node.condition ? "write it at the <condition> to limit the wait" : "take it away");
    }
    if (node.condition) Check(*node.condition);
    for (const Invoke& invoke : node.invokes) {
      if (node.timeout_ms && invoke.timeout_ms && *invoke.timeout_ms > *node.timeout_ms) {
        Warn(invoke.timeout_text,
             Concat("node ", node.name.value, " ends after ", Shown(*node.timeout_ms), " already"),
             "make it shorter than that of the node, or take it away");
      }
      CheckDelay(node, invoke);
      CheckSteps(node, invoke);
    }
  }

  // A further attempt of an invocation that begins when the time of the node is over. (The time of an invoke or a node with
  // ext:retry is that of each attempt, and begins after its own delay.)
  void CheckDelay(const Node& node, const Invoke& invoke) {
    const RetryPolicy& policy = invoke.retry_policy;
    if (!node.timeout_ms || invoke.retry == 0 || !policy.delay_ms || *policy.delay_ms < *node.timeout_ms)
      return;
    reader_
        .Warning(policy.delay_text.span,
                 Concat("the further attempts have no effect: node ", node.name.value, " ends after ",
                        Shown(*node.timeout_ms), ", and the next one would begin ", Shown(*policy.delay_ms),
                        " after a failure"),
                 "make the delay shorter, or give the node a longer ext:timeout")
        .rule = kTimeoutWithoutEffect;
  }

  void Check(const Condition& condition) {
    if (!condition.timeout_ms) return;
    if (IsEmpty(condition)) {
      Warn(condition.timeout_text, "a condition without a context or a case holds at once",
           "take it away, or say what must hold");
      return;
    }
    // A rule that must have held for longer than the wait lasts, or a time after its end.
    if (!condition.cases.empty() || condition.expression) return;
    const Rule* longest = nullptr;
    for (const Context& context : condition.contexts) {
      const auto too_long = std::find_if(context.rules.begin(), context.rules.end(), [&](const Rule& rule) {
        return std::max(rule.at_least_ms.value_or(0), rule.after_ms.value_or(0)) >= *condition.timeout_ms;
      });
      if (too_long == context.rules.end()) return;
      longest = &*too_long;
    }
    if (longest->after_ms.value_or(0) >= *condition.timeout_ms) {
      reader_
          .Warning(longest->after_text.span,
                   Concat("the condition can never hold: the wait ends after ", Shown(*condition.timeout_ms),
                          ", before this time"),
                   "make the timeout longer")
          .rule = kUnsatisfiable;
      return;
    }
    reader_
        .Warning(longest->for_text.span,
                 Concat("the condition can never hold: the wait ends after ", Shown(*condition.timeout_ms),
                        ", and this must have held for ", Shown(*longest->at_least_ms), " by then"),
                 "time counts from the beginning of the wait; make the timeout longer")
        .rule = kUnsatisfiable;
  }

  // A step of a robot service may have more time than the whole invocation.
  void CheckSteps(const Node& node, const Invoke& invoke) {
    if (environment_ == nullptr || invoke.operation.empty()) return;
    const std::optional<OperationSignature> operation = environment_->FindOperation(invoke.operation.value);
    if (!operation || !operation->longest_step) return;
    // Without a timeout here, that of each step counts, however long it is.
    if (!invoke.timeout_ms && !node.timeout_ms) return;
    const bool by_node = node.timeout_ms && (!invoke.timeout_ms || *node.timeout_ms < *invoke.timeout_ms);
    const int64_t ends = by_node ? *node.timeout_ms : *invoke.timeout_ms;
    if (operation->longest_step->timeout_ms <= ends) return;
    reader_
        .Warning(invoke.operation.span,
                 Concat("the timeout of step ", operation->longest_step->operation, " of ", operation->name,
                        ", ", Shown(operation->longest_step->timeout_ms), ", has no effect: the ",
                        by_node ? "node" : "invocation", " ends after ", Shown(ends)),
                 by_node ? "give the node a longer ext:timeout"
                         : Concat("give the invoke a longer one: ext:timeout=\"",
                                  Shown(operation->longest_step->timeout_ms), "\""))
        .rule = kTimeoutWithoutEffect;
  }

  const Environment* environment_;
  xml::ElementReader& reader_;
};

}  // namespace

void CheckTimeouts(const Document& document, const Environment* environment, xml::ElementReader* reader) {
  TimeoutChecker(environment, reader).Check(document);
}

}  // namespace docent::cawl
