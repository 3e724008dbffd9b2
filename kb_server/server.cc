#include "kb_server/server.h"

#include <pthread.h>

#include <chrono>
#include <filesystem>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/synchronization/notification.h"
#include "graph/base/overload.h"
#include "graph/base/waiting_limits.h"
#include "graph/log/sqlite_log.h"
#include "graph/rdf/date_time.h"
#include "kb_server/door/descriptors.h"
#include "kb_server/http/http_graph_store.h"
#include "kb_server/http/http_guard.h"
#include "kb_server/http/http_health.h"
#include "kb_server/http/http_sparql.h"
#include "kb_server/server_metrics.h"
#include "kb_server/start_files.h"
#include "kb_server/turn/spatial_functions.h"
#include "kb_server/web/app_routes.h"
#include "spdlog/spdlog.h"

namespace docent::server {
namespace {

struct Address {
  std::string host;
  int port = 0;
};

absl::StatusOr<Address> ParseAddress(const std::string& text, bool insecure) {
  size_t colon = text.rfind(':');
  Address address;
  if (colon == std::string::npos || colon == 0 || !absl::SimpleAtoi(text.substr(colon + 1), &address.port) ||
      address.port < 0 || address.port > 65535) {
    return absl::InvalidArgumentError(
        absl::StrCat("\"", text, "\" is not HOST:PORT, such as 127.0.0.1:7400 (port 0 takes a free one)"));
  }
  address.host = text.substr(0, colon);
  bool loopback =
      address.host == "localhost" || address.host == "[::1]" || absl::StartsWith(address.host, "127.");
  if (!loopback && !insecure) {
    return absl::FailedPreconditionError(absl::StrCat(
        address.host,
        " is not a loopback address and nothing authenticates clients; add --insecure if that is meant"));
  }
  return address;
}

}  // namespace

Server::Server(const ServerSettings& settings, std::unique_ptr<SimulatedClock> simulated_clock)
    : settings_(settings),
      simulated_clock_(std::move(simulated_clock)),
      clock_(simulated_clock_ != nullptr ? simulated_clock_.get() : settings.clock),
      inbox_(&clock_, settings.limits),
      feed_(settings.limits.run_events_kept),
      leases_(&clock_, simulated_clock_ != nullptr ? static_cast<const Clock*>(&real_clock_) : &clock_),
      query_memory_("queries_memory_bytes", settings.limits.queries_memory_bytes),
      send_budget_(settings.limits.streams_bytes) {
  RegisterSpatialFunctions(&functions_);
}

absl::StatusOr<std::unique_ptr<Server>> Server::Start(
    const ServerSettings& settings, const std::function<void(uint64_t, uint64_t)>& progress) {
  for (const std::string& name : settings.http_names) {
    if (absl::Status status = HttpGuard::CheckName(name); !status.ok()) return status;
  }
  for (const std::string& origin : settings.http_origins) {
    if (absl::Status status = HttpGuard::CheckOrigin(origin); !status.ok()) return status;
  }
  for (const std::string& entry : settings.allow) {
    if (absl::Status status = RemoteAccess::CheckAllowed(entry); !status.ok()) return status;
  }
  for (const std::string& entry : settings.notify) {
    if (absl::Status status = RemoteAccess::CheckAllowed(entry); !status.ok()) return status;
  }
  std::unique_ptr<SimulatedClock> simulated;
  if (!settings.simulated_clock.empty()) {
    auto clock = SimulatedClock::Open(settings.simulated_clock);
    if (!clock.ok()) return clock.status();
    simulated = *std::move(clock);
  }
  std::unique_ptr<Server> server(new Server(settings, std::move(simulated)));
  if (absl::Status status = server->Recover(progress); !status.ok()) return status;
  server->MakeWorkers();
  server->StartWriter();
  // Nobody is listened to before there is a writer to answer, nor before the graph has what it is to begin with.
  if (absl::Status status = LoadOntologyFiles(server->ports_, settings.ontologies); !status.ok())
    return status;
  if (absl::Status status = LoadRuleFiles(server->ports_, settings.rules); !status.ok()) return status;
  const ConnectionShares shares = ShareDescriptors(DescriptorLimit(), OpenDescriptors(), settings.limits);
  if (absl::Status status = server->StartGrpc(shares.grpc); !status.ok()) return status;
  if (absl::Status status = server->StartHttp(shares.http); !status.ok()) return status;
  return server;
}

// The log, what is made of it, and the writer that goes on from there.
absl::Status Server::Recover(const std::function<void(uint64_t, uint64_t)>& progress) {
  log::SqliteLogOptions log_options;
  log_options.snapshots_kept = settings_.limits.snapshots_kept;
  auto log = log::SqliteLog::Open(settings_.data_folder, log_options);
  if (!log.ok()) return log.status();
  log_ = *std::move(log);
  proxies_ = std::make_unique<proxy::RobotProxies>(
      [this](WriteBatch batch) { inbox_.Push(std::move(batch), nullptr); }, proxy::ProxySettings{}, &clock_);
  notifier_ = std::make_unique<Notifier>(
      Notifier::Settings{.allow = settings_.notify, .mqtt = settings_.mqtt},
      [this](WriteBatch batch, std::function<void(bool)> done) {
        inbox_.Push(std::move(batch), [done = std::move(done)](const absl::StatusOr<BatchOutcome>& outcome) {
          done(outcome.ok());
        });
      });
  snapshots_ = std::make_unique<SnapshotKeeper>(log_.get(), &dictionary_, settings_.limits);
  history_ = std::make_unique<History>(log_.get(), &queries_, &dictionary_, &functions_, settings_.limits);
  fact_history_ = std::make_unique<LogHistory>(log_.get(), &dictionary_, settings_.explain_limits);
  Subscriptions::Settings following;
  following.dictionary = &dictionary_;
  following.functions = &functions_;
  following.prefixes = &prefixes_;
  following.clock = &clock_;
  following.query_memory = &query_memory_;
  following.limits = settings_.limits;
  following.subscription_limits = settings_.subscription_limits;
  following.default_graph = settings_.default_graph;
  following.epoch = absl::StrCat(clock_.Now());
  subscriptions_ = std::make_unique<Subscriptions>(following);

  Writer::Ports ports;
  ports.inbox = &inbox_;
  ports.log = log_.get();
  ports.queries = &queries_;
  ports.catalog = &catalog_;
  ports.feed = &feed_;
  ports.proxies = proxies_.get();
  ports.notifications = notifier_.get();
  ports.snapshots = snapshots_.get();
  ports.history = history_.get();
  ports.subscriptions = subscriptions_.get();
  ports.followed = &followed_;
  ports.dictionary = &dictionary_;
  ports.functions = &functions_;
  ports.limits = settings_.limits;
  const Clock* wall = simulated_clock_ != nullptr       ? simulated_clock_.get()
                      : settings_.wall_clock != nullptr ? settings_.wall_clock
                      : settings_.clock != nullptr      ? settings_.clock
                                                        : &system_clock_;
  clock_source_ =
      std::make_unique<ClockSource>(wall, &clock_, simulated_clock_ != nullptr, &inbox_, &dictionary_);
  ports.saw = [this](const Delta& delta) { clock_source_->Saw(delta); };
  writer_ = std::make_unique<Writer>(ports);
  if (const absl::Status recovered = writer_->Recover(progress); !recovered.ok()) return recovered;
  const TimeMicros newest_us = writer_->newest_time_us();
  if (simulated_clock_ != nullptr && newest_us > simulated_clock_->Now()) {
    return absl::FailedPreconditionError(absl::StrCat(
        "the simulated clock ", settings_.simulated_clock, " says ",
        DateTimeTerm(simulated_clock_->Now()).lexical, ", and the data folder has a turn of ",
        DateTimeTerm(newest_us).lexical, "; write a later time, or begin with another data folder"));
  }
  clock_.NotBefore(newest_us);
  return absl::OkStatus();
}

// What works for clients beside the writer, and the ports by which handlers reach it.
void Server::MakeWorkers() {
  workers_ = std::make_unique<WorkerPool>(WorkerPoolLimitsOf(settings_.limits));
  WorkerPoolLimits replays;
  replays.queue = kWaitingLimits.replays_waiting;
  replay_workers_ = std::make_unique<WorkerPool>(replays);
  remote_ = std::make_unique<RemoteAccess>(settings_.allow, settings_.limits);
  what_if_ = std::make_unique<WhatIf>(WhatIf::Ports{&inbox_, workers_.get(), &dictionary_, &functions_,
                                                    &clock_, settings_.limits, settings_.explain_limits});
  replays_ = std::make_unique<RunReplays>(
      RunReplays::Ports{log_.get(), &queries_, &dictionary_, &functions_, settings_.limits, ReplayLimits{}});
  ports_.queries = &queries_;
  ports_.dictionary = &dictionary_;
  ports_.functions = &functions_;
  ports_.prefixes = &prefixes_;
  ports_.workers = workers_.get();
  ports_.clients = &clients_;
  ports_.followed = &followed_;
  ports_.query_memory = &query_memory_;
  ports_.history = history_.get();
  ports_.remote = remote_.get();
  ports_.clock = &clock_;
  ports_.limits = settings_.limits;
  ports_.default_graph = settings_.default_graph;
  ports_.inbox = &inbox_;
  ports_.updates = &updates_;
  ports_.loads = &loads_;
  ports_.on_violation = settings_.on_violation;
  ports_.warn_unknown = settings_.warn_unknown;
  ports_.catalog = &catalog_;
  ports_.feed = &feed_;
  ports_.send_budget = &send_budget_;
  ports_.fact_history = fact_history_.get();
  ports_.subscriptions = subscriptions_.get();
  ports_.what_if = what_if_.get();
  ports_.explain_limits = settings_.explain_limits;
  ports_.process = [this] { return Process(); };
}

ProcessStatus Server::Process() const {
  ProcessStatus process;
  process.grpc_address = grpc_address_;
  process.http_address = http_address_;
  std::error_code error;
  process.data_folder = std::filesystem::absolute(settings_.data_folder, error).lexically_normal().string();
  process.uptime_s = static_cast<uint64_t>(
      std::chrono::duration_cast<std::chrono::seconds>(std::chrono::steady_clock::now() - started_).count());
  process.log_bytes = log_->Bytes().value_or(0);
  process.live_runs = writer_->counters().live_runs;
  process.health = Health();
  return process;
}

void Server::StartWriter() {
  lease_watch_.Begin();
  writer_->ResumeCommands();  // before the writer's thread has it
  writer_thread_ = std::thread([this] {
    pthread_setname_np(pthread_self(), "writer");
    absl::Status status = writer_->Run();
    absl::MutexLock lock(&status_mutex_);
    writer_status_ = status;
    writer_ended_ = true;
  });
  clock_source_->Start();
  if (simulated_clock_ == nullptr) return;
  spdlog::warn("the time is simulated: {} tells it, now {}", settings_.simulated_clock,
               DateTimeTerm(simulated_clock_->Now()).lexical);
  simulated_clock_->OnMove([this] {
    inbox_.Wake();
    clock_source_->Wake();
  });
}

std::optional<TimeMicros> Server::NextDue() const {
  const std::optional<TimeMicros> turn = writer_->NextDue(), clock = clock_source_->NextDue();
  if (!turn && !clock) return std::nullopt;
  return std::max(clock_.Now(), std::min(turn.value_or(INT64_MAX), clock.value_or(INT64_MAX)));
}

Server::~Server() {
  auto deadline = std::chrono::system_clock::now() + std::chrono::seconds(1);
  // Longer than calls may take that wait for no turn: where none is long, all that came is still decided.
  absl::Notification writer_done;
  std::thread patience([this, &writer_done] {
    if (!writer_done.WaitForNotificationWithTimeout(absl::Seconds(2)) && writer_) writer_->EndTurns();
  });
  if (simulated_clock_) simulated_clock_->OnMove(nullptr);
  if (clock_source_) clock_source_->Stop();
  // Whatever runs ends soon, and what waits is refused.
  queries_.Stop();
  if (replay_workers_) replay_workers_->Stop();
  if (workers_) workers_->Stop();
  if (live_) live_->Stop();
  http_server_.reset();
  if (grpc_server_) grpc_server_->Stop(deadline);
  inbox_.Close();
  const bool snapshot = writer_thread_.joinable();
  if (snapshot) writer_thread_.join();
  writer_done.Notify();
  patience.join();
  if (snapshot) LeaveSnapshot();
  notifier_.reset();  // these after the writer, which sends to the last
  proxies_.reset();
  replay_workers_.reset();
  workers_.reset();
  calls_.reset();  // after the workers, which may begin some
  live_.reset();
  grpc_server_.reset();
}

void Server::LeaveSnapshot() {
  if (absl::Status ended = status(); !ended.ok()) return;  // whatever stopped it is for people to look at
  absl::Status written = snapshots_->TakeLast(writer_->State());
  if (!written.ok()) spdlog::error("no snapshot at the end: {}", std::string(written.message()));
}

absl::Status Server::StartGrpc(size_t connections) {
  auto address = ParseAddress(settings_.grpc_address, settings_.insecure);
  if (!address.ok()) return address.status();
  replays_service_ = std::make_unique<ReplaysService>(ports_, replays_.get(), replay_workers_.get());
  auto server =
      GrpcServer::Start(settings_.grpc_address, connections, ports_, &leases_, replays_service_.get());
  if (!server.ok()) {
    return absl::Status(
        server.status().code(),
        absl::StrCat(server.status().message(),
                     "; choose another with --grpc, and give it to clients as DOCENT_SERVER"));
  }
  grpc_server_ = *std::move(server);
  grpc_address_ = absl::StrCat(address->host, ":", grpc_server_->listener().port());
  return absl::OkStatus();
}

absl::Status Server::StartHttp(size_t connections) {
  auto address = ParseAddress(settings_.http_address, settings_.insecure);
  if (!address.ok()) return address.status();
  if (absl::Status status = ReadApp(); !status.ok()) return status;
  AddServerMetrics({writer_.get(), proxies_.get(), &leases_, &inbox_, &queries_, snapshots_.get(), log_.get(),
                    history_.get(), &query_memory_, &dictionary_, &grpc_server_->listener(), &send_budget_,
                    subscriptions_.get(), workers_.get(), &clients_, &clock_, simulated_clock_ != nullptr,
                    [this] { return NextDue(); }},
                   &metrics_);
  HttpRoutes routes;
  AddHealthRoute(&routes, [this] { return Health(); });
  AddMetricsRoute(&routes, &metrics_);
  AddSparqlRoutes(&routes, &ports_, &metrics_);
  AddGraphStoreRoutes(&routes, &ports_);
  calls_ = std::make_unique<RpcChannel>(grpc_server_->InProcess());
  connect_ = {calls_.get(), workers_.get(), settings_.limits};
  AddConnectRoutes(&routes, GrpcServer::ServiceNames(), &connect_);
  live_ = std::make_unique<Live>(LivePorts{calls_.get(), workers_.get(), &queries_, &followed_,
                                           GrpcServer::ServiceNames(), WebLimits{}});
  live_->AddRoute(&routes);
  AddAppRoutes(&routes, &app_);
  HttpServerOptions options;
  options.listen = settings_.http_address;
  options.allowed_hosts = settings_.http_names;
  options.allowed_origins = settings_.http_origins;
  options.clients = &clients_;
  options.connections = connections;
  options.body_bytes = settings_.limits.http_body_bytes;
  options.bodies_bytes = settings_.limits.http_bodies_bytes;
  options.send_budget = &send_budget_;
  options.clock = simulated_clock_ != nullptr ? static_cast<const Clock*>(&system_clock_)
                                              : &clock_;  // of Date: of this world
  auto server = HttpServer::Start(options, std::move(routes));
  if (!server.ok()) {
    return absl::Status(server.status().code(),
                        absl::StrCat(server.status().message(), "; choose another with --http"));
  }
  http_server_ = *std::move(server);
  http_address_ = http_server_->address();
  AddHttpMetrics(&metrics_, http_server_.get());
  metrics_.AddGaugeFunction("docent_live_connections", "Open WebSocket connections at /live.",
                            [this] { return static_cast<double>(live_->open()); });
  AddGateMetrics();
  return absl::OkStatus();
}

void Server::AddGateMetrics() {
  const MessageGate* gate = &grpc_server_->gate();
  metrics_.AddGaugeFunction("docent_grpc_requests_bytes",
                            "Messages of gRPC calls that arrive or are in work (grpc_requests_bytes).",
                            [gate] { return static_cast<double>(gate->bytes()); });
  metrics_.AddGaugeFunction("docent_grpc_arriving", "gRPC calls whose message arrives.",
                            [gate] { return static_cast<double>(gate->arriving()); });
  metrics_.AddGaugeFunction("docent_grpc_waiting", "gRPC calls whose message waits for room to arrive.",
                            [gate] { return static_cast<double>(gate->waiting()); });
  metrics_.AddCounterFunction("docent_grpc_late_total",
                              "gRPC calls ended since their message did not arrive in time.",
                              [gate] { return static_cast<double>(gate->late()); });
  metrics_.AddCounterFunction("docent_grpc_refused_total", "gRPC calls refused for want of room.",
                              [gate] { return static_cast<double>(gate->refused()); });
}

// An app that is named has to be there; without the one that comes with the program the server is whole.
absl::Status Server::ReadApp() {
  const std::string folder = settings_.web_folder.empty() ? AppFiles::FindFolder() : settings_.web_folder;
  if (folder.empty()) return absl::OkStatus();
  absl::StatusOr<AppFiles> app = AppFiles::Read(folder);
  if (!app.ok() && !settings_.web_folder.empty())
    return absl::Status(app.status().code(),
                        absl::StrCat(app.status().message(), "; choose another with --web"));
  if (!app.ok()) spdlog::warn("the web app is left out: {}", std::string(app.status().message()));
  if (app.ok()) app_ = *std::move(app);
  return absl::OkStatus();
}

bool Server::Tend() {
  if (!writer_->LogStatus().ok()) writer_->AskLogAgain();
  lease_watch_.Look();
  absl::MutexLock lock(&status_mutex_);
  return !writer_ended_;
}

absl::Status Server::Health() const {
  if (absl::Status ended = status(); !ended.ok()) return ended;
  if (absl::Status there = log_->CheckPlace(); !there.ok()) return there;
  if (absl::Status log = writer_->LogStatus(); !log.ok()) return log;
  const std::optional<uint64_t> free = log_->FreeBytes();
  if (free && *free < settings_.limits.disk_free_bytes) {
    return OverloadError(absl::StrCat("the disk of the data folder has ", *free, " bytes left, less than ",
                                      settings_.limits.disk_free_bytes,
                                      " (disk_free_bytes); make room on it"));
  }
  return grpc_server_->listener().status();
}

absl::Status Server::status() const {
  absl::MutexLock lock(&status_mutex_);
  return writer_status_;
}

}  // namespace docent::server
