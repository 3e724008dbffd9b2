// A message of a workflow's run for somebody outside, as a turn decided it (ext:notify). It is sent at least once; a CloudEvents id
// lets the receiver tell a repeat. What became of it comes back as a CommandReport of its id. Value; any thread.
#ifndef DOCENT_GRAPH_STORE_NOTIFICATION_H_
#define DOCENT_GRAPH_STORE_NOTIFICATION_H_

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "graph/base/clock.h"
#include "graph/base/ids.h"
#include "graph/rdf/term.h"

namespace docent {

struct Notification {
  CommandId id;         // run/node/iteration/notify.action.binding@time: unique within a data folder
  std::string target;   // "https://…", "http://…" or "mqtt:TOPIC"
  std::string source;   // IRI of the run
  std::string type;     // of the event
  std::string subject;  // empty: none
  TimeMicros time_us = 0;
  std::vector<std::pair<std::string, std::optional<Term>>> data;  // nullopt: the variable has no value

  friend bool operator==(const Notification&, const Notification&) = default;
};

}  // namespace docent

#endif  // DOCENT_GRAPH_STORE_NOTIFICATION_H_
