// What /metrics tells of the parts of a server; HTTP adds its own.
#ifndef DOCENT_KB_SERVER_SERVER_METRICS_H_
#define DOCENT_KB_SERVER_SERVER_METRICS_H_

#include <functional>
#include <optional>

#include "graph/base/clock.h"
#include "graph/base/memory_budget.h"
#include "graph/log/context_log.h"
#include "graph/rdf/dictionary.h"
#include "kb_server/door/client.h"
#include "kb_server/door/inbox.h"
#include "kb_server/door/metrics.h"
#include "kb_server/door/query_port.h"
#include "kb_server/door/send_budget.h"
#include "kb_server/door/worker_pool.h"
#include "kb_server/grpc/grpc_listener.h"
#include "kb_server/robots/fleet_leases.h"
#include "kb_server/subscriptions/subscriptions.h"
#include "kb_server/writer/history.h"
#include "kb_server/writer/snapshot_keeper.h"
#include "kb_server/writer/writer.h"
#include "robot_adapters/proxy/robot_proxies.h"

namespace docent::server {

struct MeasuredParts {
  const Writer* writer = nullptr;
  const proxy::RobotProxies* proxies = nullptr;
  const FleetLeases* leases = nullptr;
  const Inbox* inbox = nullptr;
  const QueryPort* queries = nullptr;
  const SnapshotKeeper* snapshots = nullptr;
  log::ContextLog* log = nullptr;
  const History* history = nullptr;
  const MemoryBudget* query_memory = nullptr;
  const Dictionary* dictionary = nullptr;
  GrpcListener* listener = nullptr;
  const SendBudget* send_budget = nullptr;
  Subscriptions* subscriptions = nullptr;
  const WorkerPool* workers = nullptr;
  Clients* clients = nullptr;
  const Clock* clock = nullptr;
  bool simulated_time = false;
  std::function<std::optional<TimeMicros>()> next_due;  // Server::NextDue
};

// The parts must outlive the last reading of the metrics.
void AddServerMetrics(const MeasuredParts& parts, Metrics* metrics);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_SERVER_METRICS_H_
