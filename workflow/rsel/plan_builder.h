// Opens up a process and those that it contains into one flat plan. For service_registry.cc; one thread.
#ifndef DOCENT_WORKFLOW_RSEL_PLAN_BUILDER_H_
#define DOCENT_WORKFLOW_RSEL_PLAN_BUILDER_H_

#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "workflow/rsel/service_registry.h"

namespace docent::rsel {

// Where each process is defined.
struct ProcessPlace {
  const Document* document = nullptr;
  const Process* process = nullptr;
};
using ProcessMap = std::map<std::string, ProcessPlace, std::less<>>;

class PlanBuilder {
 public:
  // Told of each mistake: the document, the place in it, what, hint.
  using Report =
      std::function<void(const Document&, const SourceSpan&, std::string message, std::string hint)>;

  // Both must outlive the builder.
  PlanBuilder(const ProcessMap& processes, Report report);

  // Null after a reported mistake.
  PlanPtr Build(const std::string& process);

 private:
  using Names = std::map<std::string, PlanSource>;  // what a name of the running process stands for

  const ProcessPlace* Nested(const Process& caller, const Invoke& invoke) const;
  // The parts that a process takes, in order of its message or of first use.
  const std::vector<std::string>& InputsOf(const ProcessPlace& place);
  // Adds the process's steps after the steps `after`; changes `names` by its results and `after` to its last steps.
  bool Expand(const ProcessPlace& place, const std::string& path, Names* names, std::vector<int>* after);
  bool AddStep(const ProcessPlace& place, const Invoke& invoke, const std::string& path, const Names& names,
               const std::vector<int>& after, Names* results);
  bool AddNested(const ProcessPlace& place, const Invoke& invoke, const ProcessPlace& nested,
                 const std::string& path, const Names& names, std::vector<int>* after, Names* results);
  bool Error(const ProcessPlace& place, const SourceSpan& span, std::string message, std::string hint = "");

  const ProcessMap& processes_;
  Report report_;
  // Processes that contain each other no deeper than the limit, and never themselves.
  std::set<const Process*> sound_;
  std::map<const Process*, std::vector<std::string>> inputs_;
  size_t all_steps_ = 0;
  // Of the plan being built:
  std::vector<std::string> open_;    // processes being expanded, outermost first
  std::set<const Process*> broken_;  // whose mistakes are reported; not expanded again
  Plan plan_;
};

}  // namespace docent::rsel

#endif  // DOCENT_WORKFLOW_RSEL_PLAN_BUILDER_H_
