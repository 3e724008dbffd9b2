// Interfaces that a handler may use: the door in, the newest version out, and pictures that the writer publishes.
// Handlers never touch a stage. All of it is safe from any thread and outlives the handlers.
#ifndef DOCENT_KB_SERVER_DOOR_PORTS_H_
#define DOCENT_KB_SERVER_DOOR_PORTS_H_

#include <cstdint>
#include <functional>
#include <string>

#include "absl/status/status.h"
#include "graph/base/clock.h"
#include "graph/base/explain_limits.h"
#include "graph/base/limits.h"
#include "graph/rdf/dictionary.h"
#include "graph/sparql/run/evaluator.h"
#include "kb_server/door/catalog.h"
#include "kb_server/door/client.h"
#include "kb_server/door/inbox.h"
#include "kb_server/door/query_port.h"
#include "kb_server/door/run_feed.h"
#include "kb_server/door/worker_pool.h"

namespace docent {
class MemoryBudget;
}  // namespace docent

namespace docent::explain {
class FactHistory;
}  // namespace docent::explain

namespace docent::server {

class FollowedReads;
class HistoryPort;
class KnownPrefixes;
class LoadRunner;
class RemoteAccess;
class SendBudget;
class Subscriptions;
class UpdateRunner;
class WhatIfPort;

// What is done about a write of a client after which the graph violates the shapes of the ontology modules, as it did not
// before.
enum class OnViolation { kIgnore, kWarn, kRefuse };
// Handlers of requests take the smallest of these groups that has what they need, so that a test fills that much. A null
// pointer, where it is allowed, says so.

// To read the graph: its versions, and the bounds of evaluation.
struct ReadPorts {
  QueryPort* queries = nullptr;
  const Dictionary* dictionary = nullptr;
  const sparql::FunctionRegistry* functions = nullptr;
  KnownPrefixes* prefixes = nullptr;     // of queries and updates; null: the well-known ones
  WorkerPool* workers = nullptr;         // for what may take long: queries, parsing
  Clients* clients = nullptr;            // who asks; null: all are the server itself
  FollowedReads* followed = nullptr;     // null: reads do not note what they look at
  MemoryBudget* query_memory = nullptr;  // of all queries and updates; null: each is bounded alone
  HistoryPort* history = nullptr;        // null: only the newest version is there
  RemoteAccess* remote = nullptr;        // null: nothing is fetched
  const Clock* clock = nullptr;
  Limits limits;
  sparql::DefaultGraph default_graph = sparql::DefaultGraph::kUnion;
};

// To change it, too: through the door, or by updates and loads that are prepared beside the writer.
struct WritePorts : ReadPorts {
  Inbox* inbox = nullptr;
  UpdateRunner* updates = nullptr;
  LoadRunner* loads = nullptr;
  OnViolation on_violation = OnViolation::kIgnore;
  bool warn_unknown = false;  // of words that a loaded ontology does not have
};

// And to tell clients of documents and runs.
struct RunPorts : WritePorts {
  CatalogPort* catalog = nullptr;
  RunFeed* feed = nullptr;
  SendBudget* send_budget = nullptr;  // of all streams; null: each is bounded alone
};

// The process and its disk, as it is when it is asked.
struct ProcessStatus {
  std::string grpc_address, http_address;  // HOST:PORT, with the port that was taken
  std::string data_folder;                 // absolute path
  uint64_t uptime_s = 0;
  uint64_t log_bytes = 0;
  uint64_t live_runs = 0;
  absl::Status health;
};

// All of them.
struct ServicePorts : RunPorts {
  std::function<ProcessStatus()> process;        // null: not known
  explain::FactHistory* fact_history = nullptr;  // null: explanations name no log offsets
  Subscriptions* subscriptions = nullptr;
  WhatIfPort* what_if = nullptr;
  ExplainLimits explain_limits;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_DOOR_PORTS_H_
