// The composition root: makes every part, gives each its ports, starts and stops them in order.
#ifndef DOCENT_KB_SERVER_SERVER_H_
#define DOCENT_KB_SERVER_SERVER_H_

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "graph/base/clock.h"
#include "graph/base/limits.h"
#include "graph/base/memory_budget.h"
#include "graph/base/steady_clock.h"
#include "kb_server/clock/clock_source.h"
#include "kb_server/clock/simulated_clock.h"
#include "kb_server/connect/connect_routes.h"
#include "kb_server/door/door_clock.h"
#include "kb_server/door/metrics.h"
#include "kb_server/door/ports.h"
#include "kb_server/door/send_budget.h"
#include "kb_server/grpc/grpc_server.h"
#include "kb_server/grpc/replay/replays_service.h"
#include "kb_server/http/http_server.h"
#include "kb_server/live/live.h"
#include "kb_server/robots/fleet_leases.h"
#include "kb_server/robots/lease_watch.h"
#include "kb_server/web/app_files.h"
#include "kb_server/work/known_prefixes.h"
#include "kb_server/work/load_runner.h"
#include "kb_server/work/notifier.h"
#include "kb_server/work/remote_access.h"
#include "kb_server/work/update_runner.h"
#include "kb_server/writer/log_history.h"
#include "kb_server/writer/what_if.h"
#include "kb_server/writer/writer.h"

namespace docent::server {

struct ServerSettings {
  std::string data_folder;                      // made if absent
  std::string grpc_address = "127.0.0.1:7400";  // port 0: a free one
  std::string http_address = "127.0.0.1:7480";
  std::vector<std::string>
      http_names;  // NAME or NAME:PORT that HTTP answers to, beside localhost and addresses
  std::vector<std::string> http_origins;  // origins of other servers' web pages that may use HTTP (CORS)
  std::string web_folder;  // of the built browser app; empty: the one that comes with the program
  bool insecure = false;   // allow addresses other than loopback although nothing authenticates clients
  sparql::DefaultGraph default_graph = sparql::DefaultGraph::kUnion;
  std::vector<std::string> ontologies;  // files, loaded at start unless the graph has them as they are
  std::vector<std::string> rules;       // likewise; or names of built-in sets, or "none"
  OnViolation on_violation =
      OnViolation::kIgnore;         // of the shapes in ontology modules, by what a client writes
  bool warn_unknown = false;        // of words that a loaded ontology does not have
  std::vector<std::string> allow;   // addresses that SERVICE and LOAD may reach: see RemoteAccess
  std::vector<std::string> notify;  // webhooks that workflows may notify: likewise
  std::string mqtt;                 // HOST:PORT of the broker to whose topics workflows publish; empty: none
  Limits limits;
  ExplainLimits explain_limits;
  SubscriptionLimits subscription_limits;
  const Clock* clock = nullptr;  // null: steady time since the start; must outlive the server
  // Tells times of day; null: `clock`, or where that is null the system's. It must outlive the server.
  const Clock* wall_clock = nullptr;
  std::string simulated_clock;  // file in which a simulator tells the time, in place of both; empty: none
};

class Server {
 public:
  // Opens the log, replays it, loads the files, listens. Errors are one clear line: a port in use, an
  // unreadable folder, a log of a newer format, damage with its offset. `progress(done, all)` tells of the
  // replay.
  static absl::StatusOr<std::unique_ptr<Server>> Start(
      const ServerSettings& settings, const std::function<void(uint64_t, uint64_t)>& progress);
  // Stops: no new requests, batches that wait are answered, what is written is durable; the state is left as a
  // snapshot, so that the next start replays nothing.
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  const std::string& grpc_address() const { return grpc_address_; }
  const std::string& http_address() const { return http_address_; }

  // To be called now and then (about once a second): tells the graph of robots that were lost. False: the
  // writer had to stop, see status().
  bool Tend();
  absl::Status status() const;
  // OK, or what keeps it from serving as it should: the writer, the log and its disk, the data folder, the gRPC port. Any
  // thread; quick.
  absl::Status Health() const;

 private:
  Server(const ServerSettings& settings, std::unique_ptr<SimulatedClock> simulated_clock);
  absl::Status Recover(const std::function<void(uint64_t, uint64_t)>& progress);
  void MakeWorkers();
  void StartWriter();
  void LeaveSnapshot();
  absl::Status StartGrpc(size_t connections);
  absl::Status StartHttp(size_t connections);
  void AddGateMetrics();
  absl::Status ReadApp();
  ProcessStatus Process() const;
  // The time at which something falls due without input; none: nothing does. Where something is under way it is now.
  std::optional<TimeMicros> NextDue() const;

  const ServerSettings settings_;
  const std::unique_ptr<SimulatedClock> simulated_clock_;  // null: the time is that of this world
  const SteadyClock real_clock_;
  DoorClock clock_;
  const SystemClock system_clock_;
  const std::chrono::steady_clock::time_point started_ =
      std::chrono::steady_clock::now();  // for people alone
  Dictionary dictionary_;
  sparql::FunctionRegistry functions_;
  std::unique_ptr<log::ContextLog> log_;
  Inbox inbox_;
  QueryPort queries_;
  FollowedReads followed_{&dictionary_};
  CatalogPort catalog_;
  KnownPrefixes prefixes_{&catalog_};
  RunFeed feed_;
  FleetLeases leases_;
  LeaseWatch lease_watch_{&leases_, &inbox_, &queries_, &dictionary_};
  Metrics metrics_;
  std::unique_ptr<ClockSource> clock_source_;
  std::unique_ptr<proxy::RobotProxies> proxies_;
  std::unique_ptr<SnapshotKeeper> snapshots_;
  std::unique_ptr<History> history_;
  std::unique_ptr<Writer> writer_;
  std::unique_ptr<Subscriptions> subscriptions_;
  std::unique_ptr<LogHistory> fact_history_;
  std::unique_ptr<WhatIf> what_if_;
  Clients clients_;
  std::unique_ptr<WorkerPool> workers_;
  std::unique_ptr<WorkerPool> replay_workers_;  // replays and simulations do not take the places of queries
  MemoryBudget query_memory_;
  SendBudget send_budget_;
  ServicePorts ports_;
  UpdateRunner updates_{&ports_};
  LoadRunner loads_{&ports_, &catalog_};
  std::unique_ptr<RemoteAccess> remote_;
  std::unique_ptr<Notifier> notifier_;
  std::unique_ptr<RunReplays> replays_;
  std::unique_ptr<ReplaysService> replays_service_;
  std::unique_ptr<GrpcServer> grpc_server_;
  AppFiles app_;
  ConnectPorts connect_;
  std::unique_ptr<RpcChannel> calls_;  // of HTTP clients
  std::unique_ptr<Live> live_;
  std::unique_ptr<HttpServer> http_server_;
  std::thread writer_thread_;
  mutable absl::Mutex status_mutex_;
  absl::Status writer_status_ ABSL_GUARDED_BY(status_mutex_);
  bool writer_ended_ ABSL_GUARDED_BY(status_mutex_) = false;
  std::string grpc_address_;
  std::string http_address_;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_SERVER_H_
