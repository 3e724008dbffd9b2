// Comparison of two courses of one run, node by node. Pure; any thread.
#ifndef DOCENT_KB_SERVER_REPLAY_PLAY_DIFFERENCE_H_
#define DOCENT_KB_SERVER_REPLAY_PLAY_DIFFERENCE_H_

#include <cstdint>
#include <string>
#include <vector>

#include "kb_server/replay/case_player.h"
#include "kb_server/replay/run_case.h"
#include "workflow/cawl/ast.h"

namespace docent::server {

struct Difference {
  // activator | turn | state | not reached | no such node | further | command | robot | value | variable | result
  std::string kind;
  uint64_t turn = 0;     // the earlier one of the two
  std::string recorded;  // for people; empty: nothing
  std::string replayed;
};

// One node, or the run itself.
struct NodeComparison {
  std::string node;  // path; empty: the run itself; kActivator
  // In their order; empty: the node did the same. What follows from the first state that differs is left out.
  std::vector<Difference> differences;
  std::vector<Decision> recorded;
  std::vector<Decision> replayed;
  std::string waits_for;  // at the end of the replay: SPARQL
  std::string missing;

  bool same() const { return differences.empty(); }
};

// The node that differs first in front, then those that differ later, then those that are the same; the run itself last of its
// group.
std::vector<NodeComparison> Compare(const RunCase& recorded, const cawl::Document& document,
                                    const Play& play);

bool IsSame(const std::vector<NodeComparison>& nodes);

// "opened", "sent moveToBooth(booth=expo:B03) to expo:R01", … without the turn.
std::string Describe(const Decision& decision);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_REPLAY_PLAY_DIFFERENCE_H_
