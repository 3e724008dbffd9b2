#include "workflow/rsel/plan_builder.h"

#include <algorithm>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "graph/base/text.h"
#include "graph/base/workflow_limits.h"
#include "workflow/xml/element_reader.h"

namespace docent::rsel {
namespace {

// Of the parts that have one.
PartTypes TypesOf(const Message* message) {
  PartTypes out;
  if (message == nullptr) return out;
  for (const Part& part : message->parts) {
    if (part.type_term && part.type_term->IsIri()) out[part.name.value] = part.type_term->lexical;
  }
  return out;
}

std::string Join(const std::string& path, const std::string& name) {
  if (path.empty()) return name;
  // A process that wraps the operation of its own name shows the name once.
  bool same = path == name || path.ends_with("/" + name);
  return same ? path : path + "/" + name;
}

}  // namespace

PlanBuilder::PlanBuilder(const ProcessMap& processes, Report report)
    : processes_(processes), report_(std::move(report)) {
  // A process is sound when all that it contains were found sound in the rounds before.
  for (int round = 0; round <= kWorkflowLimits.process_nesting; ++round) {
    std::vector<const Process*> found;
    for (const auto& [name, place] : processes_) {
      if (sound_.contains(place.process)) continue;
      const std::vector<Invoke>& invokes = place.process->invokes;
      bool sound =
          std::all_of(invokes.begin(), invokes.end(), [&, caller = place.process](const Invoke& invoke) {
            const ProcessPlace* nested = Nested(*caller, invoke);
            return nested == nullptr || sound_.contains(nested->process);
          });
      if (sound) found.push_back(place.process);
    }
    if (found.empty()) return;
    sound_.insert(found.begin(), found.end());
  }
}

PlanPtr PlanBuilder::Build(const std::string& process) {
  const ProcessPlace& place = processes_.find(process)->second;
  plan_ = Plan();
  open_.clear();
  broken_.clear();
  plan_.process = process;
  plan_.document = place.document->name.value;
  plan_.version = place.document->version.value;
  plan_.inputs = InputsOf(place);
  plan_.input_types = TypesOf(place.document->FindMessage(place.process->input.value));
  Names names;
  for (const std::string& input : plan_.inputs) names[input] = {std::nullopt, input};
  std::vector<int> after;
  if (!Expand(place, "", &names, &after)) return nullptr;
  all_steps_ += plan_.steps.size();
  if (all_steps_ > kWorkflowLimits.all_plan_steps) {
    Error(place, place.process->name.span,
          absl::StrCat("all processes together have more than ", kWorkflowLimits.all_plan_steps,
                       " steps, the limit all_plan_steps"),
          "remove documents that are not needed");
    return nullptr;
  }
  const Message* output = place.document->FindMessage(place.process->output.value);
  std::set<std::string> parts;
  if (output != nullptr) {
    for (const Part& part : output->parts) parts.insert(part.name.value);
    plan_.output_types = TypesOf(output);
  } else {
    for (const Invoke& invoke : place.process->invokes) {
      for (const Output& o : invoke.outputs) parts.insert(o.to.value);
    }
  }
  for (const std::string& part : parts) {
    auto it = names.find(part);
    if (it != names.end()) plan_.outputs.emplace_back(part, it->second);
  }
  return std::make_shared<const Plan>(std::move(plan_));
}

const ProcessPlace* PlanBuilder::Nested(const Process& caller, const Invoke& invoke) const {
  if (invoke.operation.value == caller.name.value) return nullptr;  // the robot's operation of that name
  auto it = processes_.find(invoke.operation.value);
  return it == processes_.end() ? nullptr : &it->second;
}

const std::vector<std::string>& PlanBuilder::InputsOf(const ProcessPlace& place) {
  auto known = inputs_.find(place.process);
  if (known != inputs_.end()) return known->second;
  std::vector<std::string> out;
  if (const Message* message = place.document->FindMessage(place.process->input.value)) {
    for (const Part& part : message->parts) out.push_back(part.name.value);
    return inputs_[place.process] = std::move(out);
  }
  if (!sound_.contains(place.process)) return inputs_[place.process];  // Expand reports why
  std::set<std::string> made;
  auto need = [&](const std::string& name) {
    if (made.contains(name) || std::find(out.begin(), out.end(), name) != out.end()) return;
    out.push_back(name);
  };
  for (const Invoke& invoke : place.process->invokes) {
    const ProcessPlace* nested = Nested(*place.process, invoke);
    if (nested != nullptr && invoke.inputs.empty()) {
      for (const std::string& name : InputsOf(*nested)) need(name);
    }
    for (const Input& input : invoke.inputs) {
      if (input.from.given()) need(input.from.value);
    }
    for (const Output& output : invoke.outputs) made.insert(output.to.value);
  }
  return inputs_[place.process] = std::move(out);
}

bool PlanBuilder::Expand(const ProcessPlace& place, const std::string& path, Names* names,
                         std::vector<int>* after) {
  open_.push_back(place.process->name.value);
  bool good = true;
  const std::vector<Invoke>& invokes = place.process->invokes;
  for (size_t i = 0; i < invokes.size() && plan_.steps.size() <= kWorkflowLimits.plan_steps;) {
    // A group: an invoke and the ones after it that are marked parallel. All see the names from before the group.
    Names results;
    std::vector<int> ends;
    size_t first = i;
    for (; i < invokes.size() && (i == first || invokes[i].parallel); ++i) {
      const ProcessPlace* nested = Nested(*place.process, invokes[i]);
      if (nested != nullptr) {
        std::vector<int> nested_after = *after;
        good = AddNested(place, invokes[i], *nested, path, *names, &nested_after, &results) && good;
        ends.insert(ends.end(), nested_after.begin(), nested_after.end());
      } else {
        good = AddStep(place, invokes[i], path, *names, *after, &results) && good;
        ends.push_back(static_cast<int>(plan_.steps.size()) - 1);
      }
      if (plan_.steps.size() > kWorkflowLimits.plan_steps) {
        good = Error(place, invokes[i].span,
                     absl::StrCat("process ", plan_.process, " has more than ", kWorkflowLimits.plan_steps,
                                  " steps, the limit plan_steps"));
        break;
      }
    }
    for (auto& [name, source] : results) (*names)[name] = source;
    *after = std::move(ends);
  }
  open_.pop_back();
  if (!good) broken_.insert(place.process);
  return good;
}

bool PlanBuilder::AddStep(const ProcessPlace& place, const Invoke& invoke, const std::string& path,
                          const Names& names, const std::vector<int>& after, Names* results) {
  PlanStep step;
  step.path = Join(path, invoke.operation.value);
  step.operation = invoke.operation.value;
  step.service = invoke.service.value;
  step.after = after;
  step.retry = invoke.retry;
  step.timeout_ms = invoke.timeout_ms;
  step.on_failure = invoke.on_failure;
  bool good = true;
  for (const Input& input : invoke.inputs) {
    if (input.value) {
      step.inputs.emplace_back(input.part.value, PlanSource{input.value, ""});
      continue;
    }
    auto it = names.find(input.from.value);
    if (it == names.end()) {
      good = Error(place, input.from.span, Concat("nothing gives ", input.from.value, " here"));
      continue;
    }
    step.inputs.emplace_back(input.part.value, it->second);
  }
  const Message* message = place.document->FindMessage(place.process->input.value);
  if (invoke.inputs.empty() && message != nullptr) {
    for (const Part& part : message->parts) {
      auto it = names.find(part.name.value);
      if (it != names.end()) step.inputs.emplace_back(part.name.value, it->second);
    }
  }
  std::string number = absl::StrCat(plan_.steps.size() + 1);
  for (const Output& output : invoke.outputs)
    (*results)[output.to.value] = {std::nullopt, number + "." + output.part.value};
  plan_.steps.push_back(std::move(step));
  return good;
}

bool PlanBuilder::AddNested(const ProcessPlace& place, const Invoke& invoke, const ProcessPlace& nested,
                            const std::string& path, const Names& names, std::vector<int>* after,
                            Names* results) {
  const std::string& name = invoke.operation.value;
  auto again = std::find(open_.begin(), open_.end(), name);
  if (again != open_.end()) {
    std::string way;
    for (auto it = again; it != open_.end(); ++it) way += *it + " → ";
    return Error(place, invoke.operation.span, Concat("process ", name, " contains itself: ", way, name),
                 "a process may not be part of itself");
  }
  if (broken_.contains(nested.process)) return false;
  if (static_cast<int>(open_.size()) > kWorkflowLimits.process_nesting) {
    return Error(place, invoke.operation.span,
                 absl::StrCat("processes inside each other deeper than ", kWorkflowLimits.process_nesting,
                              ", the limit process_nesting"));
  }
  if (invoke.retry > 0 || invoke.timeout_ms || invoke.on_failure != Invoke::OnFailure::kFail) {
    return Error(place, invoke.span,
                 Concat("retry, timeout and onFailure stand on an invoke of a robot's operation, and ", name,
                        " is a process"),
                 Concat("write them on the invokes of process ", name));
  }
  const std::vector<std::string>& inputs = InputsOf(nested);
  Names inner;
  if (!sound_.contains(nested.process)) return Expand(nested, Join(path, name), &inner, after);
  bool good = true;
  for (const Input& input : invoke.inputs) {
    if (std::find(inputs.begin(), inputs.end(), input.part.value) == inputs.end()) {
      good = Error(place, input.part.span, Concat("process ", name, " has no input part ", input.part.value),
                   inputs.empty() ? "it takes none" : Concat("it takes ", xml::ListOf(inputs)));
    }
    auto it = names.find(input.from.value);
    if (input.value) {
      inner[input.part.value] = {input.value, ""};
    } else if (it != names.end()) {
      inner[input.part.value] = it->second;
    }
  }
  for (const std::string& part : inputs) {
    if (inner.contains(part)) continue;
    auto it = names.find(part);
    if (invoke.inputs.empty() && it != names.end()) {
      inner[part] = it->second;
    } else {
      good = Error(place, invoke.operation.span,
                   Concat("process ", name, " takes part ", part, ", which nothing gives here"),
                   Concat("write <input part=\"", part, "\" from=\"…\"/>"));
    }
  }
  if (!good || !Expand(nested, Join(path, name), &inner, after)) return false;
  for (const Output& output : invoke.outputs) {
    auto it = inner.find(output.part.value);
    if (it == inner.end()) {
      good = Error(place, output.part.span, Concat("process ", name, " gives no part ", output.part.value));
    } else {
      (*results)[output.to.value] = it->second;
    }
  }
  return good;
}

bool PlanBuilder::Error(const ProcessPlace& place, const SourceSpan& span, std::string message,
                        std::string hint) {
  report_(*place.document, span, std::move(message), std::move(hint));
  return false;
}

}  // namespace docent::rsel
