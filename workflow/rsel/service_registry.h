// The registered RSEL documents and the processes that they define, and from them plans that can be run.
//
// Copyable: a copy shares the documents (immutable) and is otherwise independent, so a turn that fails can go back.
// Not thread-safe; the writer thread owns it, others read a copy.
#ifndef DOCENT_WORKFLOW_RSEL_SERVICE_REGISTRY_H_
#define DOCENT_WORKFLOW_RSEL_SERVICE_REGISTRY_H_

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "graph/base/diagnostic.h"
#include "workflow/rsel/ast.h"
#include "workflow/rsel/part_types.h"

namespace docent::rsel {

// Where a step's argument comes from: a constant, or a named value of the running process.
struct PlanSource {
  std::optional<Term> constant;
  std::string slot;  // input part of the process, or "STEP.part" for a result of plan step STEP (from 1)
};

// One operation of a robot, in its place in a process with all nested processes opened up.
struct PlanStep {
  std::string path;       // "moveToUser", or "displayInformation/displayBoothInfo" beneath a nested process
  std::string operation;  // the robot's
  std::string service;
  std::vector<std::pair<std::string, PlanSource>> inputs;  // part → where from
  std::vector<int> after;                                  // indexes of the steps that must have ended before
  int retry = 0;
  std::optional<int64_t> timeout_ms;
  Invoke::OnFailure on_failure = Invoke::OnFailure::kFail;
};

// A process, flat and immutable. A running one keeps its plan, whatever is registered meanwhile.
struct Plan {
  std::string process;
  std::string document;                                     // rsel/@name
  std::string version;                                      // rsel/@version
  std::vector<std::string> inputs;                          // part names that arguments must give
  std::vector<std::pair<std::string, PlanSource>> outputs;  // part → where from
  std::vector<PlanStep> steps;
  // Of the messages' parts; of a registered plan, not of one that a run was begun with before a restart.
  PartTypes input_types = {}, output_types = {};
};
using PlanPtr = std::shared_ptr<const Plan>;

class ServiceRegistry {
 public:
  // Registers a correct document under document->name, in place of the one of that name. Errors, and nothing
  // changed: a process name that another document has, processes that contain each other, a nested process's
  // input that nothing gives, a plan of more than plan_steps, all plans of more than all_plan_steps, nesting over
  // process_nesting. They point into `document`'s source, or have no place
  // where another registered document stops working.
  Diagnostics Put(DocumentPtr document);
  // Errors, and nothing changed: a process of it is part of another document's. NOT_FOUND: no such document. With `force` the
  // name means the robots' operation there from then on; refused only where that cannot work.
  absl::Status Remove(std::string_view document_name, bool force = false);

  // The plan of a process; null if there is none of this name.
  PlanPtr Find(std::string_view process) const;
  // NOT_FOUND: no process of this name, with the nearest that there is, or all.
  absl::Status NotRegistered(std::string_view process) const;
  // The same of a document.
  absl::Status NoDocument(std::string_view document_name) const;
  // In order of their names.
  std::vector<PlanPtr> Plans() const;
  std::vector<std::string> ProcessNames() const;
  // The registered documents by name; and a registry of documents that were registered together before, at this
  // version. INTERNAL where they do not go together.
  std::vector<DocumentPtr> Documents() const;
  static absl::StatusOr<ServiceRegistry> Restore(const std::vector<DocumentPtr>& documents, uint64_t version);
  // Grows with each Put and Remove that changed something.
  uint64_t version() const { return version_; }

 private:
  // All plans anew from `documents`; diagnostics that concern `changed` have places.
  static Diagnostics MakePlans(const std::map<std::string, DocumentPtr, std::less<>>& documents,
                               const Document* changed, std::map<std::string, PlanPtr, std::less<>>* plans);

  std::map<std::string, DocumentPtr, std::less<>> documents_;
  std::map<std::string, PlanPtr, std::less<>> plans_;
  uint64_t version_ = 0;
};

// A plan of one step: the robot's operation itself, for an `invoke` that names no process. Its inputs are `inputs`.
PlanPtr OperationPlan(std::string operation, std::vector<std::string> inputs);

}  // namespace docent::rsel

#endif  // DOCENT_WORKFLOW_RSEL_SERVICE_REGISTRY_H_
