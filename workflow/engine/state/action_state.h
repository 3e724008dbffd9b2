// What nodes of a run have done of their own (cawl::Action), as a part of the run's state. Values.
#ifndef DOCENT_WORKFLOW_ENGINE_STATE_ACTION_STATE_H_
#define DOCENT_WORKFLOW_ENGINE_STATE_ACTION_STATE_H_

#include <array>
#include <cstddef>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "graph/rdf/term.h"
#include "graph/store/notification.h"
#include "workflow/engine/state/ports.h"

namespace docent::engine {

struct NodeActions {
  // Index in cawl::Node::actions of what comes next: of those at="open", of those at="done".
  std::array<size_t, 2> next = {0, 0};
  std::vector<TermBinding> bindings;  // the matches that opened it
  bool begun = false;                 // those at="open" are done, and the invocations have begun
  std::set<CommandId> awaited;        // notifications with wait="true" that are not delivered yet
};

struct TripleLess {
  bool operator()(const TermQuad& a, const TermQuad& b) const {
    return std::tie(a.subject, a.predicate, a.object) < std::tie(b.subject, b.predicate, b.object);
  }
};

// Of a SELECT, in its order.
using SolutionsPtr = std::shared_ptr<const std::vector<TermBinding>>;

// A notification that is neither delivered nor given up, and the node that decided it.
struct OpenNotification {
  Notification notification;
  RunId run;
  size_t node = 0;
};

struct RunActions {
  std::map<std::string, SolutionsPtr> solutions;  // by variables of forEach that an assignment set
  std::set<TermQuad, TripleLess> until_end;       // told with lifetime="run"
};

}  // namespace docent::engine

#endif  // DOCENT_WORKFLOW_ENGINE_STATE_ACTION_STATE_H_
