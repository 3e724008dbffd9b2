// The choice of a robot by the default query of workflow/cawl/robot_choice.h, without the query, which looks at every robot
// of the graph: most of the work of a short run. What it goes by is read once for each robot, and again when it changes. Both
// choose the same robot; where only the query can tell, there is no answer here. Writer thread only.
#ifndef DOCENT_KB_SERVER_TURN_DEFAULT_ROBOT_CHOICE_H_
#define DOCENT_KB_SERVER_TURN_DEFAULT_ROBOT_CHOICE_H_

#include <optional>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "graph/base/ids.h"
#include "graph/rdf/dictionary.h"
#include "graph/rdf/term_id.h"
#include "graph/store/delta.h"
#include "graph/store/graph_version.h"

namespace docent::server {

class DefaultRobotChoice {
 public:
  // `dictionary` must outlive it.
  explicit DefaultRobotChoice(Dictionary* dictionary);

  // The next version differs from the one before by `delta`.
  void Refresh(const Delta& delta);
  // Nothing that was read counts.
  void Forget() { known_.clear(); }

  // Of `able`, of which there is at least one, the robot to be preferred; of those that are no docent:Robot the first.
  // `goal`: the place to go to; none: there is none. nullopt: the goal has a place, so that distances count, or a robot has
  // several values of one property.
  std::optional<RobotId> Best(const GraphVersion& version, std::optional<TermId> goal,
                              const std::vector<RobotId>& able);

 private:
  // What the query orders by, where no distance counts. None: unbound.
  struct Standing {
    bool is_robot = false;
    bool several = false;  // values of one property
    TermId charge, load, used;
  };

  const Standing& Of(const RobotId& robot, const GraphVersion& version);
  bool Has(const GraphVersion& version, TermId subject, TermId predicate, TermId object = {}) const;
  int Compare(TermId a, TermId b) const;
  bool IsBefore(const Standing& a, const RobotId& of_a, const Standing& b, const RobotId& of_b) const;

  const Dictionary& dictionary_;
  const TermId type_, robot_, battery_, load_, last_used_, x_, service_point_;
  absl::flat_hash_map<RobotId, Standing> known_;  // by its name: no look into the dictionary for each choice
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_TURN_DEFAULT_ROBOT_CHOICE_H_
