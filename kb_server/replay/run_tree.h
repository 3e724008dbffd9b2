// A run and the runs that are nested in it, learned turn by turn, and the paths of their nodes.
//
// A path names the same place in two lives of a run, whose ids differ: "Move2Booth" is a node of the run itself,
// "Visit/Move2Booth" a node of the sub-flow that its node Visit started. "Visit[2]/…": by its second invocation;
// "Visit#2/…": when it was entered for the second time, or tried again; "(undoing)/…": to undo what the run did. One thread.
#ifndef DOCENT_KB_SERVER_REPLAY_RUN_TREE_H_
#define DOCENT_KB_SERVER_REPLAY_RUN_TREE_H_

#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>

#include "graph/base/ids.h"
#include "kb_server/turn/turn.h"

namespace docent::server {

class RunTree {
 public:
  explicit RunTree(const RunId& root) { paths_[root.value()] = ""; }

  // The runs that began in a turn.
  void Observe(const TurnResult& result);
  bool Has(const RunId& run) const { return paths_.contains(run.value()); }
  // The runs that are nested in the outermost one, with their paths.
  std::map<RunId, std::string> nested() const;
  // Whether it is the graph in which one of the runs tells.
  bool IsOwnGraph(std::string_view iri) const;
  // Of what transitions and commands are about, "RUN", "RUN/NODE" or "RUN/NODE/…"; nullopt: not of these runs. The path of the
  // outermost run is empty.
  std::optional<std::string> PathOf(std::string_view subject) const;
  // The run with this path, empty for the outermost one; nullopt: there is none.
  std::optional<RunId> RunAt(std::string_view path) const;

 private:
  void Add(const engine::NestedRun& nested);

  std::map<std::string, std::string, std::less<>> paths_;  // run id → "" or "Visit"
  std::set<std::string> taken_;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_REPLAY_RUN_TREE_H_
