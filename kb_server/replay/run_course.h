// What a turn and the graph say of a run and of those nested in it. Functions without state.
#ifndef DOCENT_KB_SERVER_REPLAY_RUN_COURSE_H_
#define DOCENT_KB_SERVER_REPLAY_RUN_COURSE_H_

#include <cstdint>
#include <string>
#include <vector>

#include "kb_server/replay/run_case.h"
#include "kb_server/replay/run_tree.h"
#include "kb_server/turn/turn.h"

namespace docent::server {

// Adds what the turn decided about the runs of the tree, which has observed it. `turn`: the offset that is noted.
void AddDecisions(const TurnResult& result, uint64_t turn, const RunTree& tree,
                  std::vector<Decision>* decisions);

// State, reason, variables and results of the run, as the graph has them.
void ReadEnd(const Dictionary& dictionary, const GraphVersion& graph, const RunId& run, Course* course);
// Its variables alone.
std::map<std::string, Term> ReadVariables(const Dictionary& dictionary, const GraphVersion& graph,
                                          const RunId& run);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_REPLAY_RUN_COURSE_H_
