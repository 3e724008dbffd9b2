#include "workflow/rsel/feasibility.h"

#include <algorithm>
#include <map>
#include <set>

#include "graph/base/text.h"
#include "workflow/rsel/type_checks.h"
#include "workflow/xml/element_reader.h"

namespace docent::rsel {
namespace {

using Offers = std::map<std::string, const OfferedOperation*, std::less<>>;

void CheckInvoke(const Document& document, const Process& process, const Invoke& invoke, const Offers& offers,
                 Diagnostics* out) {
  auto warn = [&](const SourceSpan& span, std::string message, std::string hint) {
    out->push_back(
        {document.file, span, std::move(message), std::move(hint), Diagnostic::Severity::kWarning});
    return &out->back();
  };
  auto it = offers.find(invoke.operation.value);
  if (it == offers.end()) {
    std::vector<std::string> names;
    for (const auto& [name, unused] : offers) names.push_back(name);
    std::string near = Nearest(invoke.operation.value, names);
    Diagnostic* report =
        warn(invoke.operation.span, Concat("no robot offers operation ", invoke.operation.value, " now"),
             Concat("an invocation waits until a robot joins that offers it; ",
                    !near.empty()   ? Concat("did you mean ", near, "?")
                    : names.empty() ? "no robot offers anything now"
                                    : Concat("robots offer ", xml::ListOf(names))));
    report->rule = "unknown-operation";
    const SourceSpan& span = invoke.operation.span;
    if (!near.empty() && document.source.compare(span.offset, span.length, invoke.operation.value) == 0)
      report->fix = {{span.offset, span.length, xml::XmlEscaped(near)}};
    return;
  }
  if (!it->second->inputs_known) return;
  std::vector<std::string> given;
  for (const Input& input : invoke.inputs) given.push_back(input.part.value);
  const Message* message = document.FindMessage(process.input.value);
  if (invoke.inputs.empty() && message != nullptr) {
    for (const Part& part : message->parts) given.push_back(part.name.value);
  }
  const std::vector<std::string>& wanted = it->second->inputs;
  for (const std::string& part : given) {
    if (std::find(wanted.begin(), wanted.end(), part) != wanted.end()) continue;
    warn(invoke.span,
         Concat("operation ", it->first, " of ", it->second->robot.value(), " has no part ", part),
         Concat("it takes ", PartsText(wanted, it->second->input_types)));
  }
  for (const std::string& part : wanted) {
    if (std::find(given.begin(), given.end(), part) != given.end()) continue;
    warn(invoke.span,
         Concat("operation ", it->first, " of ", it->second->robot.value(), " needs part ", part),
         Concat("write <input part=\"", part, "\" from=\"…\"/>"));
  }
  const std::vector<std::string>& given_back = it->second->outputs;
  for (const Output& output : invoke.outputs) {
    if (given_back.empty() ||
        std::find(given_back.begin(), given_back.end(), output.part.value) != given_back.end())
      continue;
    warn(output.part.span,
         Concat("operation ", it->first, " of ", it->second->robot.value(), " gives no part ",
                output.part.value),
         Concat("it gives ", PartsText(given_back, it->second->output_types)));
  }
}

}  // namespace

std::vector<RobotId> CapableRobots(const Plan& plan, const std::vector<OfferedOperation>& offered) {
  std::set<std::string> needed;
  for (const PlanStep& step : plan.steps) needed.insert(step.operation);
  std::map<RobotId, std::set<std::string>> has;
  for (const OfferedOperation& o : offered) {
    if (needed.contains(o.name)) has[o.robot].insert(o.name);
  }
  std::vector<RobotId> out;
  for (const auto& [robot, operations] : has) {
    if (operations.size() == needed.size()) out.push_back(robot);
  }
  return out;
}

Diagnostics CheckFeasibility(const Document& document, const ServiceRegistry& registry,
                             const std::vector<OfferedOperation>& offered) {
  Offers offers;
  for (const OfferedOperation& o : offered) offers.emplace(o.name, &o);
  Diagnostics out;
  for (const Process& process : document.processes) {
    for (const Invoke& invoke : process.invokes) {
      bool nested =
          invoke.operation.value != process.name.value && registry.Find(invoke.operation.value) != nullptr;
      if (!nested) CheckInvoke(document, process, invoke, offers, &out);
    }
    PlanPtr plan = registry.Find(process.name.value);
    if (plan == nullptr || offered.empty()) continue;
    bool each = std::all_of(plan->steps.begin(), plan->steps.end(),
                            [&](const PlanStep& step) { return offers.contains(step.operation); });
    if (each && CapableRobots(*plan, offered).empty()) {
      out.push_back({document.file, process.name.span,
                     Concat("no single robot offers all operations of process ", process.name.value),
                     "one robot serves a process as a whole", Diagnostic::Severity::kWarning});
    }
  }
  for (Diagnostic& clash : CheckTypes(document, registry, offered)) out.push_back(std::move(clash));
  std::stable_sort(out.begin(), out.end(),
                   [](const Diagnostic& a, const Diagnostic& b) { return a.span.offset < b.span.offset; });
  return out;
}

}  // namespace docent::rsel
