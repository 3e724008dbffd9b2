// Interfaces that a handler may use: the door in, the newest version out, and pictures that the writer publishes.
// Handlers never touch a stage. All of it is safe from any thread and outlives the handlers.
#ifndef DOCENT_KB_SERVER_DOOR_PORTS_H_
#define DOCENT_KB_SERVER_DOOR_PORTS_H_

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "graph/base/cancellation.h"
#include "graph/base/clock.h"
#include "graph/base/explain_limits.h"
#include "graph/base/limits.h"
#include "graph/rdf/dictionary.h"
#include "graph/sparql/run/evaluator.h"
#include "kb_server/door/catalog.h"
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

class HistoryPort;
class LoadRunner;
class RemoteAccess;
class SendBudget;
class Subscriptions;
class UpdateRunner;
class WhatIfPort;

// What is done about a load after which the graph violates the shapes of the ontology modules, as it did not before.
enum class OnViolation { kIgnore, kWarn, kRefuse };
// What a change of the rules would do (Ontologies.PreviewRules).
struct RulesPreview {
  uint64_t revision = 0;
  size_t added = 0;
  size_t removed = 0;
  std::vector<std::string> added_triples;
  std::vector<std::string> removed_triples;
};
// `text` null: the set would be removed. Any thread; may take long, until `cancellation` ends it.
using PreviewRulesPort = std::function<absl::StatusOr<RulesPreview>(
    const std::string& name, const std::string* text, size_t shown, Cancellation* cancellation)>;

struct ServicePorts {
  Inbox* inbox = nullptr;
  QueryPort* queries = nullptr;
  const Dictionary* dictionary = nullptr;
  const sparql::FunctionRegistry* functions = nullptr;
  CatalogPort* catalog = nullptr;
  RunFeed* feed = nullptr;
  WorkerPool* workers = nullptr;         // for what may take long: queries, parsing
  MemoryBudget* query_memory = nullptr;  // of all queries and updates; null: each is bounded alone
  SendBudget* send_budget = nullptr;     // of all streams; null: each is bounded alone
  UpdateRunner* updates = nullptr;
  HistoryPort* history = nullptr;  // null: only the newest version is there
  LoadRunner* loads = nullptr;
  RemoteAccess* remote = nullptr;  // null: nothing is fetched
  PreviewRulesPort preview_rules;
  explain::FactHistory* fact_history = nullptr;  // null: explanations name no log offsets
  Subscriptions* subscriptions = nullptr;
  WhatIfPort* what_if = nullptr;
  const Clock* clock = nullptr;
  Limits limits;
  ExplainLimits explain_limits;
  sparql::DefaultGraph default_graph = sparql::DefaultGraph::kUnion;
  OnViolation on_violation = OnViolation::kIgnore;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_DOOR_PORTS_H_
