// Runs that activators started, and firings that wait until such a run has ended (ext:mode of an activator).
//
// A *firing* is one appearance of a binding of the activator's condition. Firings are counted per key: the values of the key
// variables, without the events that told them. What is counted outlives the deployment, as its runs do.
//
// Private to this folder. Writer thread only.
#ifndef DOCENT_WORKFLOW_ENGINE_ACTIVATIONS_H_
#define DOCENT_WORKFLOW_ENGINE_ACTIVATIONS_H_

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "graph/base/ids.h"
#include "graph/rdf/dictionary.h"
#include "graph/store/quad.h"
#include "workflow/engine/state/ports.h"

namespace docent::engine {

// A key as text: "a=… b=…", in order of the names.
std::string KeyText(const TermBinding& key);

class Activations {
 public:
  struct Firing {
    TermBinding variables;
    std::string cause;  // for people
    friend bool operator==(const Firing&, const Firing&) = default;
  };
  struct Key {
    std::vector<RunId> live;      // runs, the oldest first
    std::vector<Firing> waiting;  // the first is the next
    bool empty() const { return live.empty() && waiting.empty(); }
    friend bool operator==(const Key&, const Key&) = default;
  };
  using Place = std::pair<std::string, std::string>;  // workflow, key
  struct State {
    std::map<Place, Key> keys;
    std::map<std::string, uint64_t> ignored;  // firings, by workflow
  };

  // Null: no run of the key is live, and no firing waits.
  const Key* Find(const Place& place) const;
  // The keys of a workflow, in order.
  std::vector<std::string> KeysOf(const std::string& workflow) const;
  size_t Waiting(const std::string& workflow) const;

  void Started(const Place& place, const RunId& run);
  // Where the run was counted, if it was; it is counted no longer.
  std::optional<Place> Ended(const RunId& run);
  void Wait(const Place& place, Firing firing);
  // The next that waits; there is one.
  Firing Next(const Place& place);
  void Ignored(const std::string& workflow);
  // The workflow is gone: so many firings that waited are dropped, and nothing is known of ignored ones.
  size_t Forget(const std::string& workflow);

  // What the graph is told of what changed since, per workflow: docent:waitingFirings and docent:ignoredFirings.
  void Tell(Dictionary* dictionary, std::vector<Quad>* add, std::vector<Quad>* remove);

  const State& state() const { return state_; }
  // `dictionary`: the graph has been told of this state.
  void Restore(State state, Dictionary* dictionary);
  bool changed() const { return !undo_keys_.empty() || !undo_ignored_.empty() || !undo_told_.empty(); }
  void Commit();
  void Rollback();

 private:
  using Facts = std::vector<Quad>;
  Key& Mutable(const Place& place);
  void Drop(const Place& place);
  Facts FactsOf(const std::string& workflow, Dictionary* dictionary) const;
  void Index();

  State state_;
  std::map<RunId, Place> places_;          // of live runs
  std::map<std::string, size_t> waiting_;  // firings, by workflow
  std::set<std::string> changed_;          // workflows of which the graph may have to be told
  std::map<std::string, Facts> told_;
  std::map<Place, std::optional<Key>> undo_keys_;
  std::map<std::string, std::optional<uint64_t>> undo_ignored_;
  std::map<std::string, Facts> undo_told_;
};

}  // namespace docent::engine

#endif  // DOCENT_WORKFLOW_ENGINE_ACTIVATIONS_H_
