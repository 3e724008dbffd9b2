// Past versions of the graph, for queries `as of` a revision or a time. Thread-safe.
#ifndef DOCENT_KB_SERVER_DOOR_HISTORY_PORT_H_
#define DOCENT_KB_SERVER_DOOR_HISTORY_PORT_H_

#include <memory>
#include <optional>
#include <string>
#include <variant>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "graph/base/cancellation.h"
#include "graph/base/clock.h"
#include "graph/base/ids.h"
#include "graph/rdf/dictionary.h"
#include "graph/store/graph_version.h"
#include "kb_server/door/ports.h"

namespace docent::server {

// A version and the dictionary of its ids: a version that was made again from the log has its own.
struct QueryGraph {
  std::shared_ptr<const Dictionary> dictionary;
  GraphVersionPtr version;
};

// A revision; or a time: the newest revision that was made then or before.
using AsOf = std::variant<Revision, TimeMicros>;

// "1234", or an xsd:dateTime (without a zone it is UTC). INVALID_ARGUMENT for anything else.
absl::StatusOr<AsOf> ParseAsOf(const std::string& text);

// The time, where it is one.
std::optional<TimeMicros> TimeAsOf(const std::string& text);

class HistoryPort {
 public:
  virtual ~HistoryPort() = default;
  // OUT_OF_RANGE: it is not there yet, or no longer kept; the newest or oldest that is there is named.
  // RESOURCE_EXHAUSTED naming the limit: making it again would take too much. CANCELLED, DEADLINE_EXCEEDED;
  // errors of the log.
  virtual absl::StatusOr<QueryGraph> At(const AsOf& when, Cancellation* cancellation) = 0;
};

// What a query reads: the version as of `as_of`, or where that is empty the newest. On a worker of the pool.
absl::StatusOr<QueryGraph> GraphForQuery(const ReadPorts& ports, const std::string& as_of,
                                         Cancellation* cancellation);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_DOOR_HISTORY_PORT_H_
