// The robot that is to be preferred, by queries on the graph of the turn (workflow/cawl/robot_choice.h). Each query is prepared
// once. Writer thread only.
#ifndef DOCENT_KB_SERVER_TURN_ROBOT_RANKING_H_
#define DOCENT_KB_SERVER_TURN_ROBOT_RANKING_H_

#include <initializer_list>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "graph/base/cancellation.h"
#include "graph/base/limits.h"
#include "graph/rdf/dictionary.h"
#include "graph/sparql/run/evaluator.h"
#include "graph/store/graph_version.h"
#include "kb_server/turn/default_robot_choice.h"
#include "workflow/engine/state/ports.h"

namespace docent::server {

class GraphRobotRanking final : public engine::RobotRanking {
 public:
  // Both must outlive it; `functions` may be null.
  GraphRobotRanking(Dictionary* dictionary, const sparql::FunctionRegistry* functions, const Limits& limits)
      : dictionary_(*dictionary), functions_(functions), limits_(limits), default_(dictionary) {}

  // Goes by this version from now on, to which `deltas` lead from the one before. `cancellation`: null: none.
  void BeginRound(const GraphVersion& version, std::initializer_list<const Delta*> deltas, TimeMicros now_us,
                  Cancellation* cancellation);
  // The turn is refused: queries that were prepared in it may name terms that are gone.
  void Rollback() {
    prepared_.clear();
    default_.Forget();
  }

  RobotId Best(const std::string& select, const std::vector<RobotId>& able,
               const engine::TermBinding& values) const override;

  // The same, by the query in any case. Requires BeginRound.
  RobotId BestByQuery(const std::string& select, const std::vector<RobotId>& able,
                      const engine::TermBinding& values) const;

 private:
  using Key =
      std::pair<std::string, std::vector<std::string>>;  // the text, and the variables that have values
  sparql::PreparedQuery* Prepared(const Key& key) const;

  const Dictionary& dictionary_;
  const sparql::FunctionRegistry* functions_;
  const Limits limits_;
  const GraphVersion* version_ = nullptr;
  TimeMicros now_us_ = 0;
  Cancellation* cancellation_ = nullptr;
  mutable DefaultRobotChoice default_;
  mutable std::map<Key, std::unique_ptr<sparql::PreparedQuery>> prepared_;  // null: it cannot be prepared
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_TURN_ROBOT_RANKING_H_
