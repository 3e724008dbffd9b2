// What the graph is told of times: whether a time trigger holds, when it occurs, whether a place is open.
//
// Triggers are the resources of class docent:TimeTrigger: those that workflows ask for, whose IRI says the time
// (graph/calendar/time_spec.h), and those that somebody describes by docent:between, docent:atTime and so on. The clock is
// a source like others: its facts enter through the door and the log, in the graph docent:clock. So a replay needs neither
// a clock nor the database of zones. A pure function of the graph and two times; any thread.
#ifndef DOCENT_KB_SERVER_CLOCK_CLOCK_FACTS_H_
#define DOCENT_KB_SERVER_CLOCK_CLOCK_FACTS_H_

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "graph/base/clock.h"
#include "graph/rdf/dictionary.h"
#include "graph/store/graph_version.h"
#include "graph/store/write_batch.h"

namespace docent::server {

// Told later than this, an occurrence is late: a server that was down, or a clock that was set ahead.
inline constexpr TimeMicros kLateUs = 60'000'000;
// A clock that is set back by up to this repeats nothing; by more, its new time counts.
inline constexpr TimeMicros kSetBackUs = 24 * 3600 * 1'000'000LL;
// Triggers and places together that are looked at; the first ones in the order of their IRIs.
inline constexpr size_t kTimeTriggers = 10000;

struct ClockTimes {
  TimeMicros wall_us = 0;    // times of day follow it
  TimeMicros steady_us = 0;  // intervals follow it: the clock of turns
  bool simulated = false;    // a simulator tells the time (docent:simulatedTime)
};

struct ClockFacts {
  std::vector<QuadOperation>
      operations;       // what is to be told and taken back now; empty: all is as it should be
  bool occurs = false;  // something occurs now: look again at once, which takes that back
  std::optional<TimeMicros> next_wall_us, next_steady_us;  // when to look again
  std::vector<std::string> news;  // for the server's own log: what is late or left out
};

// `only` (null: all): whether a trigger or place, by its IRI, is looked at; what the graph has of others stays as it is.
ClockFacts ClockFactsAt(const ClockTimes& now, const Dictionary& dictionary, const GraphVersion& graph,
                        const std::function<bool(const std::string& iri)>& only = nullptr);

// Whether facts with this predicate describe times. rdf:type is not among them.
bool DescribesTime(std::string_view predicate);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_CLOCK_CLOCK_FACTS_H_
