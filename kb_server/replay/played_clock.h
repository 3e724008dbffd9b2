// The clock of a replay: tells times of day in played time, as the clock of a server does in its own (kb_server/clock/clock_facts.h).
//
// In a simulation, and where one node is tried, it tells all times. In the replay of a recorded run the recorded clock tells
// those that were asked for then, in its recorded turns; this one tells those that only the replay asks for, at once.
// One thread.
#ifndef DOCENT_KB_SERVER_REPLAY_PLAYED_CLOCK_H_
#define DOCENT_KB_SERVER_REPLAY_PLAYED_CLOCK_H_

#include <functional>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "graph/base/clock.h"
#include "graph/rdf/dictionary.h"
#include "graph/store/delta.h"
#include "graph/store/graph_version.h"
#include "kb_server/clock/clock_facts.h"
#include "kb_server/replay/run_case.h"

namespace docent::server {

class PlayedClock {
 public:
  enum class Tells { kAll, kUnrecorded, kNothing };
  explicit PlayedClock(Tells tells) : tells_(tells) {}

  // Before the first turn, on the graph that there is then.
  void Begin(const Dictionary& dictionary, const GraphVersion& graph);
  // A recorded turn is to be played: what it says of times that this clock tells is left out of it.
  void TakeTurn(const CaseTurn& turn, WriteBatch* batch);
  // Whether a turn changed what times there are, or one is due: Tell may have something to say.
  bool IsConcerned(TimeMicros now_us, const Dictionary& dictionary, const Delta& delta) const;
  // What is to be told now; nothing: all is as it should be. Then NextDue is known.
  std::vector<QuadOperation> Tell(TimeMicros now_us, const Dictionary& dictionary, const GraphVersion& graph);
  // When it has something to tell next, if ever.
  std::optional<TimeMicros> NextDue() const { return next_us_; }
  // When it will tell or take back a fact that concerns somebody, if nothing else changes the graph. nullopt: not within the next
  // changes, of which it looks at some hundred.
  std::optional<TimeMicros> NextChange(const Dictionary& dictionary, const GraphVersion& graph,
                                       const std::function<bool(const TermQuad&)>& concerns) const;

 private:
  static std::optional<TimeMicros> NextLook(const ClockFacts& facts);

  const Tells tells_;
  bool simulated_ = false;       // the recorded clock was a simulator's
  std::set<std::string> asked_;  // by the recorded runs
  std::set<std::string> own_;    // told of by this clock
  std::optional<TimeMicros> next_us_;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_REPLAY_PLAYED_CLOCK_H_
