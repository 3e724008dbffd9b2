// Times that armed conditions ask for (workflow/cawl/time_reader.h). The graph is told of each as a docent:TimeTrigger while
// somebody asks for it, so that the clock tells when it holds or occurs. Writer thread only.
#ifndef DOCENT_WORKFLOW_ENGINE_STATE_ASKED_TIMES_H_
#define DOCENT_WORKFLOW_ENGINE_STATE_ASKED_TIMES_H_

#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "graph/rdf/dictionary.h"
#include "graph/store/quad.h"
#include "workflow/engine/state/ports.h"

namespace docent::engine {

class AskedTimes {
 public:
  void Arm(const ConditionRequest& request);
  void Disarm(ConditionHandle handle);
  // The facts that say so, as far as they changed since they were told last.
  void Tell(Dictionary* dictionary, std::vector<Quad>* add, std::vector<Quad>* remove);

  // These are armed, and the graph knows it.
  void Restore(const std::vector<ConditionRequest>& armed);
  bool changed() const { return !undo_.empty(); }
  void Commit() {
    undo_.clear();
    told_before_.reset();
  }
  void Rollback();

 private:
  using Iris = std::vector<std::string>;
  void Set(ConditionHandle handle, Iris iris);
  void Count(const Iris& iris, bool more);

  absl::flat_hash_map<ConditionHandle, Iris> asked_by_;
  std::map<std::string, size_t> asked_;  // how many conditions ask for it
  std::set<std::string> changed_;        // of which the graph may have to be told
  std::set<std::string> told_;
  std::vector<std::pair<ConditionHandle, Iris>> undo_;  // what each asked for before
  std::optional<std::set<std::string>> told_before_;
};

}  // namespace docent::engine

#endif  // DOCENT_WORKFLOW_ENGINE_STATE_ASKED_TIMES_H_
