#include "workflow/rsel/service_registry.h"

#include <algorithm>
#include <set>
#include <tuple>
#include <utility>

#include "absl/strings/str_cat.h"
#include "graph/base/text.h"
#include "workflow/rsel/plan_builder.h"
#include "workflow/xml/element_reader.h"

namespace docent::rsel {
namespace {

constexpr size_t kListedNames = 20;  // in a message

// "; did you mean X?", or what there is.
std::string HintOf(std::string_view name, const std::vector<std::string>& names) {
  const std::string near = Nearest(name, names);
  if (!near.empty()) return Concat("; did you mean ", near, "?");
  if (names.empty()) return "; there are none, load an RSEL document first";
  return names.size() <= kListedNames ? Concat("; there are ", xml::ListOf(names)) : "";
}

}  // namespace

Diagnostics ServiceRegistry::Put(DocumentPtr document) {
  std::map<std::string, DocumentPtr, std::less<>> documents = documents_;
  const Document* changed = document.get();
  documents[changed->name.value] = std::move(document);
  std::map<std::string, PlanPtr, std::less<>> plans;
  Diagnostics diagnostics = MakePlans(documents, changed, &plans);
  if (HasErrors(diagnostics)) return diagnostics;
  documents_ = std::move(documents);
  plans_ = std::move(plans);
  ++version_;
  return diagnostics;
}

absl::Status ServiceRegistry::Remove(std::string_view document_name, bool force) {
  auto it = documents_.find(document_name);
  if (it == documents_.end()) return NoDocument(document_name);
  // A process that others contain would silently become a robot's operation in them.
  for (const auto& [name, document] : documents_) {
    if (name == document_name || force) continue;
    for (const Process& process : document->processes) {
      for (const Invoke& invoke : process.invokes) {
        if (invoke.operation.value == process.name.value ||
            it->second->FindProcess(invoke.operation.value) == nullptr)
          continue;
        return absl::FailedPreconditionError(Concat(
            "process ", invoke.operation.value, " of RSEL document ", document_name, " is part of process ",
            process.name.value, " of document ", name, "; remove that document first, or force the removal"));
      }
    }
  }
  std::map<std::string, DocumentPtr, std::less<>> documents = documents_;
  documents.erase(std::string(document_name));
  std::map<std::string, PlanPtr, std::less<>> plans;
  if (const Diagnostics diagnostics = MakePlans(documents, nullptr, &plans); HasErrors(diagnostics)) {
    return absl::FailedPreconditionError(Concat("without RSEL document ", document_name,
                                                " another one cannot work: ", diagnostics[0].message));
  }
  documents_ = std::move(documents);
  plans_ = std::move(plans);
  ++version_;
  return absl::OkStatus();
}

PlanPtr ServiceRegistry::Find(std::string_view process) const {
  auto it = plans_.find(process);
  return it == plans_.end() ? nullptr : it->second;
}

absl::Status ServiceRegistry::NotRegistered(std::string_view process) const {
  return absl::NotFoundError(
      Concat("no robot service \"", process, "\" is registered", HintOf(process, ProcessNames())));
}

absl::Status ServiceRegistry::NoDocument(std::string_view document_name) const {
  std::vector<std::string> names;
  for (const auto& [name, document] : documents_) names.push_back(name);
  return absl::NotFoundError(
      Concat("no RSEL document \"", document_name, "\" is registered", HintOf(document_name, names)));
}

std::vector<PlanPtr> ServiceRegistry::Plans() const {
  std::vector<PlanPtr> out;
  for (const auto& [name, plan] : plans_) out.push_back(plan);
  return out;
}

std::vector<std::string> ServiceRegistry::ProcessNames() const {
  std::vector<std::string> out;
  for (const auto& [name, plan] : plans_) out.push_back(name);
  return out;
}

std::vector<DocumentPtr> ServiceRegistry::Documents() const {
  std::vector<DocumentPtr> out;
  for (const auto& [name, document] : documents_) out.push_back(document);
  return out;
}

absl::StatusOr<ServiceRegistry> ServiceRegistry::Restore(const std::vector<DocumentPtr>& documents,
                                                         uint64_t version) {
  ServiceRegistry registry;
  for (const DocumentPtr& document : documents) registry.documents_[document->name.value] = document;
  const Diagnostics diagnostics = MakePlans(registry.documents_, nullptr, &registry.plans_);
  if (HasErrors(diagnostics)) {
    return absl::InternalError(
        Concat("RSEL documents that were registered do not go together: ", diagnostics[0].message));
  }
  registry.version_ = version;
  return registry;
}

Diagnostics ServiceRegistry::MakePlans(const std::map<std::string, DocumentPtr, std::less<>>& documents,
                                       const Document* changed,
                                       std::map<std::string, PlanPtr, std::less<>>* plans) {
  constexpr size_t kMaxDiagnostics = 200;
  Diagnostics out;
  std::set<std::tuple<const Document*, size_t, std::string>> told;
  auto report = [&](const Document& document, const SourceSpan& span, std::string message, std::string hint) {
    if (out.size() >= kMaxDiagnostics || !told.emplace(&document, span.offset, message).second) return;
    if (&document == changed) {
      out.push_back({document.file, span, std::move(message), std::move(hint)});
    } else {
      out.push_back(
          {changed != nullptr ? changed->file : document.file,
           {},
           Concat("the registered document ", document.name.value, " would no longer work: ", message),
           std::move(hint)});
    }
  };
  ProcessMap processes;
  for (const auto& [name, document] : documents) {
    for (const Process& process : document->processes) {
      auto [it, is_new] = processes.emplace(process.name.value, ProcessPlace{document.get(), &process});
      if (is_new || it->second.document == document.get()) continue;
      const Document* other = it->second.document == changed ? document.get() : it->second.document;
      const Process* ours = changed != nullptr ? changed->FindProcess(process.name.value) : nullptr;
      report(changed != nullptr ? *changed : *document, ours != nullptr ? ours->name.span : process.name.span,
             Concat("process ", process.name.value, " is already registered by document ", other->name.value),
             "remove that document, or choose another name");
    }
  }
  PlanBuilder builder(processes, report);
  for (const auto& [name, place] : processes) {
    if (PlanPtr plan = builder.Build(name)) plans->emplace(name, std::move(plan));
  }
  std::stable_sort(out.begin(), out.end(),
                   [](const Diagnostic& a, const Diagnostic& b) { return a.span.offset < b.span.offset; });
  return out;
}

PlanPtr OperationPlan(std::string operation, std::vector<std::string> inputs) {
  auto plan = std::make_shared<Plan>();
  plan->process = operation;
  plan->inputs = inputs;
  PlanStep step;
  step.path = operation;
  step.operation = std::move(operation);
  for (std::string& input : inputs) step.inputs.emplace_back(input, PlanSource{std::nullopt, input});
  plan->steps.push_back(std::move(step));
  return plan;
}

}  // namespace docent::rsel
