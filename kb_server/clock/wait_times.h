// When the times come for which a node of a run waits, as the graph and the node's condition (docent:waitsFor) say: of
// <ext:time …/> and of ext:for. What waits is told of by the same words wherever that is asked. Pure functions; any thread.
#ifndef DOCENT_KB_SERVER_CLOCK_WAIT_TIMES_H_
#define DOCENT_KB_SERVER_CLOCK_WAIT_TIMES_H_

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "graph/base/clock.h"
#include "graph/store/graph_reader.h"

namespace docent::server {

// The conditions of docent:waitsFor, any of which opens the node.
std::vector<std::string> AlternativesOf(std::string_view waits_for);

struct WaitTime {
  TimeMicros at_us = 0;  // the node opens no earlier
  std::string text;  // for people: "its condition holds, and may open it from … on, 20s after it was entered"
};
struct WaitingNode {
  std::string iri;
  TimeMicros since_us = 0;  // when it was entered
};
// The time that is not over where the condition of a node holds; nullopt: none is known.
std::optional<WaitTime> TimeOfNode(const GraphReader& graph, const WaitingNode& node, const std::string& ask,
                                   TimeMicros now_us);

// "its condition holds, but not yet for the 5min that it has to hold"
std::string NotYetForLong(const std::string& ask);

// When the times of a condition come that do not hold or occur now: the last of them, since all are needed. nullopt: none is to
// come.
std::optional<TimeMicros> NextTime(const GraphReader& graph, const std::string& ask, TimeMicros now_us);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_CLOCK_WAIT_TIMES_H_
