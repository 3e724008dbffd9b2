// Bounds of one turn: how much of it workflows have used of what graph/base/run_limits.h allows. Reset when the turn ends.
// Private to this folder. Writer thread only.
//
// Facts of runs may start runs, for example when another workflow's run fails. So an activator that its own runs start again
// is not wrong in itself; it must only come to an end in each turn. Beyond a bound a match starts no run and is not tried again
// while it lasts; the turn that deploys such an activator is refused.
#ifndef DOCENT_WORKFLOW_ENGINE_TURN_BOUNDS_H_
#define DOCENT_WORKFLOW_ENGINE_TURN_BOUNDS_H_

#include <cstddef>
#include <map>
#include <set>
#include <string>

#include "absl/status/status.h"

namespace docent::engine {

class TurnBounds {
 public:
  void BeginRound() { ++round_; }
  void Clear();

  // A run did as much as `changes` changes of a node take.
  void Worked(size_t changes) { work_ += changes; }
  // No run goes on in this turn any more.
  bool spent() const;

  // The workflow's document is of this turn.
  void Deployed(const std::string& workflow) { deployed_.insert(workflow); }
  bool IsOfThisTurn(const std::string& workflow) const { return deployed_.contains(workflow); }

  // Why the workflow's activator does not fire now, for people; empty: it may. `rounds`: the limit engine_rounds_per_turn.
  std::string WhyNotFire(const std::string& workflow, int rounds) const;
  void Fired() { ++firings_; }
  void Started(const std::string& workflow);
  // A match of the workflow's activator starts no run. `of_turn`: because of a bound of the turn.
  void NotStarted(const std::string& workflow, const std::string& match, const std::string& why,
                  bool of_turn);

  // What starts no run since the last call, by workflow.
  struct Missed {
    std::string first;  // match
    std::string why;
    size_t more = 0;
    bool of_turn = false;
  };
  std::map<std::string, Missed> TakeMissed();

 private:
  struct Activated {
    int rounds = 0;  // in which it started runs
    int last = 0;    // of these rounds
  };
  int round_ = 0;
  size_t work_ = 0;
  size_t firings_ = 0;
  size_t runs_ = 0;
  std::map<std::string, Activated> activated_;
  std::set<std::string> deployed_;
  std::map<std::string, Missed> missed_;
};

}  // namespace docent::engine

#endif  // DOCENT_WORKFLOW_ENGINE_TURN_BOUNDS_H_
