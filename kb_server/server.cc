#include "kb_server/server.h"

#include <grpcpp/ext/proto_server_reflection_plugin.h>
#include <grpcpp/health_check_service_interface.h>
#include <pthread.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <future>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "absl/synchronization/notification.h"
#include "graph/base/overload.h"
#include "graph/log/sqlite_log.h"
#include "graph/rdf/document_name.h"
#include "graph/rdf/formats/parser.h"
#include "graph/rdf/formats/text_input.h"
#include "graph/rdf/vocabulary.h"
#include "kb_server/door/descriptors.h"
#include "kb_server/http/http_graph_store.h"
#include "kb_server/http/http_health.h"
#include "kb_server/http/http_sparql.h"
#include "kb_server/robots/robot_facts.h"
#include "kb_server/robots/robot_records.h"
#include "kb_server/turn/spatial_functions.h"
#include "reasoner/rules/rule_preview.h"
#include "reasoner/rules/rule_sets.h"
#include "spdlog/spdlog.h"

namespace docent::server {
namespace {

constexpr size_t kBesideDocument = 1u << 20;  // of a gRPC message that brings a document
constexpr int kKeepaliveMs = 60000;
constexpr int kHandshakeMs = 10000;  // from a connection's begin to the first frame of HTTP/2

struct Address {
  std::string host;
  int port = 0;
};

absl::StatusOr<Address> ParseAddress(const std::string& text, bool insecure) {
  size_t colon = text.rfind(':');
  Address address;
  if (colon == std::string::npos || !absl::SimpleAtoi(text.substr(colon + 1), &address.port) ||
      address.port < 0 || address.port > 65535) {
    return absl::InvalidArgumentError(absl::StrCat("\"", text, "\" is not HOST:PORT"));
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

// True if the module's graph holds exactly these triples.
bool SameGraph(const Dictionary& dictionary, const GraphVersion& version, const std::string& graph,
               const std::vector<TermQuad>& quads) {
  auto id = dictionary.FindIri(graph);
  if (!id) return false;
  uint64_t count = 0;
  version.ForEach({{}, {}, {}, *id}, [&count](const Quad&) {
    ++count;
    return true;
  });
  if (count != quads.size()) return false;
  for (const TermQuad& quad : quads) {
    auto s = dictionary.Find(quad.subject);
    auto p = dictionary.Find(quad.predicate);
    auto o = dictionary.Find(quad.object);
    if (!s || !p || !o || !version.Contains({*s, *p, *o, *id})) return false;
  }
  return true;
}

}  // namespace

Server::Server(const ServerSettings& settings)
    : settings_(settings),
      clock_(settings.clock != nullptr ? *settings.clock : system_clock_),
      inbox_(&clock_, settings.limits),
      feed_(settings.limits.run_events_kept),
      leases_(&clock_),
      query_memory_("queries_memory_bytes", settings.limits.queries_memory_bytes),
      send_budget_(settings.limits.streams_bytes) {
  RegisterSpatialFunctions(&functions_);
}

absl::StatusOr<std::unique_ptr<Server>> Server::Start(
    const ServerSettings& settings, const std::function<void(uint64_t, uint64_t)>& progress) {
  for (const std::string& entry : settings.allow) {
    if (absl::Status status = RemoteAccess::CheckAllowed(entry); !status.ok()) return status;
  }
  std::unique_ptr<Server> server(new Server(settings));
  Server& s = *server;
  log::SqliteLogOptions log_options;
  log_options.snapshots_kept = settings.limits.snapshots_kept;
  auto log = log::SqliteLog::Open(settings.data_folder, log_options);
  if (!log.ok()) return log.status();
  s.log_ = *std::move(log);
  s.proxies_ = std::make_unique<proxy::RobotProxies>(
      [inbox = &s.inbox_](WriteBatch batch) { inbox->Push(std::move(batch), nullptr); },
      proxy::ProxySettings{}, &s.clock_);
  s.snapshots_ = std::make_unique<SnapshotKeeper>(s.log_.get(), &s.dictionary_, settings.limits);
  s.history_ =
      std::make_unique<History>(s.log_.get(), &s.queries_, &s.dictionary_, &s.functions_, settings.limits);
  Writer::Ports ports;
  ports.inbox = &s.inbox_;
  ports.log = s.log_.get();
  ports.queries = &s.queries_;
  ports.catalog = &s.catalog_;
  ports.feed = &s.feed_;
  ports.proxies = s.proxies_.get();
  ports.snapshots = s.snapshots_.get();
  ports.history = s.history_.get();
  ports.dictionary = &s.dictionary_;
  ports.functions = &s.functions_;
  ports.limits = settings.limits;
  Subscriptions::Settings following;
  following.dictionary = &s.dictionary_;
  following.functions = &s.functions_;
  following.clock = &s.clock_;
  following.limits = settings.limits;
  following.subscription_limits = settings.subscription_limits;
  following.default_graph = settings.default_graph;
  following.epoch = absl::StrCat(s.clock_.Now());
  s.subscriptions_ = std::make_unique<Subscriptions>(following);
  ports.subscriptions = s.subscriptions_.get();
  s.writer_ = std::make_unique<Writer>(ports);
  if (absl::Status status = s.writer_->Recover(progress); !status.ok()) return status;

  s.workers_ = std::make_unique<WorkerPool>(WorkerPoolLimitsOf(settings.limits));
  s.ports_.inbox = &s.inbox_;
  s.ports_.queries = &s.queries_;
  s.ports_.dictionary = &s.dictionary_;
  s.ports_.functions = &s.functions_;
  s.ports_.catalog = &s.catalog_;
  s.ports_.feed = &s.feed_;
  s.ports_.workers = s.workers_.get();
  s.ports_.query_memory = &s.query_memory_;
  s.ports_.send_budget = &s.send_budget_;
  s.ports_.history = s.history_.get();
  s.ports_.updates = &s.updates_;
  s.ports_.loads = &s.loads_;
  s.ports_.on_violation = settings.on_violation;
  s.remote_ = std::make_unique<RemoteAccess>(settings.allow, settings.limits, s.workers_.get());
  s.ports_.remote = s.remote_.get();
  s.ports_.preview_rules = [&s](const std::string& name, const std::string* text, size_t shown,
                                Cancellation* cancellation) {
    return s.PreviewRuleChange(name, text, shown, cancellation);
  };
  s.fact_history_ = std::make_unique<LogHistory>(s.log_.get(), &s.dictionary_, settings.explain_limits);
  s.ports_.explain_limits = settings.explain_limits;
  s.ports_.fact_history = s.fact_history_.get();
  s.ports_.subscriptions = s.subscriptions_.get();
  s.what_if_ =
      std::make_unique<WhatIf>(WhatIf::Ports{&s.inbox_, s.workers_.get(), &s.dictionary_, &s.functions_,
                                             &s.clock_, settings.limits, settings.explain_limits});
  s.ports_.what_if = s.what_if_.get();
  s.ports_.clock = &s.clock_;
  s.ports_.limits = settings.limits;
  s.ports_.default_graph = settings.default_graph;

  s.ExpectRobots();
  s.writer_->ResumeCommands();  // before the writer's thread has it
  s.writer_thread_ = std::thread([&s] {
    pthread_setname_np(pthread_self(), "writer");
    absl::Status status = s.writer_->Run();
    absl::MutexLock lock(&s.status_mutex_);
    s.writer_status_ = status;
    s.writer_ended_ = true;
  });
  // Nobody is listened to before there is a writer to answer, nor before the graph has what it is to begin
  // with.
  if (absl::Status status = s.LoadFiles(); !status.ok()) return status;
  const ConnectionShares shares = ShareDescriptors(DescriptorLimit(), OpenDescriptors(), settings.limits);
  if (absl::Status status = s.StartGrpc(shares.grpc); !status.ok()) return status;
  if (absl::Status status = s.StartHttp(shares.http); !status.ok()) return status;
  return server;
}

Server::~Server() {
  auto deadline = std::chrono::system_clock::now() + std::chrono::seconds(1);
  // Longer than calls may take that wait for no turn: where none is long, all that came is still decided.
  absl::Notification writer_done;
  std::thread patience([this, &writer_done] {
    if (!writer_done.WaitForNotificationWithTimeout(absl::Seconds(2)) && writer_) writer_->EndTurns();
  });
  http_server_.reset();
  if (grpc_listener_) grpc_listener_->Stop();
  if (grpc_server_) grpc_server_->Shutdown(deadline);
  inbox_.Close();
  const bool snapshot = writer_thread_.joinable();
  if (snapshot) writer_thread_.join();
  writer_done.Notify();
  patience.join();
  if (snapshot) LeaveSnapshot();
  proxies_.reset();  // after the writer, which sends to the last
  workers_.reset();
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
  auto listener = GrpcListener::Listen(settings_.grpc_address, connections);
  if (!listener.ok()) {
    return absl::Status(listener.status().code(),
                        absl::StrCat(listener.status().message(), "; choose another with --grpc"));
  }
  grpc_listener_ = *std::move(listener);
  context_service_ = std::make_unique<ContextService>(ports_);
  ontologies_service_ = std::make_unique<OntologiesService>(ports_);
  workflows_service_ = std::make_unique<WorkflowsService>(ports_);
  robot_services_service_ = std::make_unique<RobotServicesService>(ports_);
  fleet_service_ = std::make_unique<FleetService>(ports_, &leases_);
  grpc::EnableDefaultHealthCheckService(true);
  grpc::reflection::InitProtoReflectionServerBuilderPlugin();
  grpc::ServerBuilder builder;
  grpc_listener_->AddTo(&builder);
  builder.AddChannelArgument(GRPC_ARG_SERVER_HANDSHAKE_TIMEOUT_MS, kHandshakeMs);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIME_MS, kKeepaliveMs);  // a client that vanished is noticed
  // A message holds a document and little else; what is larger than document_bytes is refused by that name.
  const size_t message_bytes =
      std::max(settings_.limits.grpc_message_bytes, settings_.limits.document_bytes + kBesideDocument);
  builder.SetMaxReceiveMessageSize(static_cast<int>(message_bytes));
  const std::array<std::pair<const char*, grpc::Service*>, 5> services = {
      {{v1::Context::service_full_name(), context_service_.get()},
       {v1::Ontologies::service_full_name(), ontologies_service_.get()},
       {v1::Workflows::service_full_name(), workflows_service_.get()},
       {v1::RobotServices::service_full_name(), robot_services_service_.get()},
       {v1::Fleet::service_full_name(), fleet_service_.get()}}};
  for (const auto& [name, service] : services) builder.RegisterService(service);
  grpc_server_ = builder.BuildAndStart();
  if (grpc_server_ == nullptr) return absl::InternalError("the gRPC server does not start");
  for (const auto& [name, service] : services)
    grpc_server_->GetHealthCheckService()->SetServingStatus(name, true);
  grpc_listener_->Start();
  grpc_address_ = absl::StrCat(address->host, ":", grpc_listener_->port());
  return absl::OkStatus();
}

absl::Status Server::StartHttp(size_t connections) {
  auto address = ParseAddress(settings_.http_address, settings_.insecure);
  if (!address.ok()) return address.status();
  RegisterMetrics();
  RegisterConnectionMetrics();
  RegisterSubscriptionMetrics();
  HttpRoutes routes;
  AddHealthRoute(&routes, [this] { return Health(); });
  AddMetricsRoute(&routes, &metrics_);
  AddSparqlRoutes(&routes, &ports_, &metrics_);
  AddGraphStoreRoutes(&routes, &ports_);
  HttpServerOptions options;
  options.listen = settings_.http_address;
  options.allowed_hosts = settings_.http_names;
  options.connections = connections;
  options.body_bytes = settings_.limits.http_body_bytes;
  options.bodies_bytes = settings_.limits.http_bodies_bytes;
  options.send_budget = &send_budget_;
  options.clock = ports_.clock;
  auto server = HttpServer::Start(options, std::move(routes));
  if (!server.ok()) {
    return absl::Status(server.status().code(),
                        absl::StrCat(server.status().message(), "; choose another with --http"));
  }
  http_server_ = *std::move(server);
  http_address_ = http_server_->address();
  AddHttpMetrics(&metrics_, http_server_.get());
  return absl::OkStatus();
}

void Server::RegisterMetrics() {
  const WriterCounters* counters = &writer_->counters();
  auto add = [this](const char* name, const char* help, const std::atomic<uint64_t>* value) {
    metrics_.AddCounterFunction(name, help, [value] { return static_cast<double>(value->load()); });
  };
  add("docent_turns_total", "Batches applied and durable", &counters->turns);
  add("docent_commits_total", "Commits of the log; each is one fdatasync for all turns in it",
      &counters->commits);
  add("docent_batches_refused_total", "Batches refused: bad input, limits, the log", &counters->refused);
  add("docent_commands_total", "Commands sent to robots", &counters->commands);
  add("docent_inferred_total", "Facts that rules added or withdrew", &counters->inferred);
  add("docent_condition_candidates_total", "Pairs of a condition and a changed quad that can match it",
      &counters->condition_candidates);
  add("docent_condition_evaluations_total", "Conditions evaluated because a change could match them",
      &counters->condition_evaluations);
  add("docent_condition_whole_evaluations_total",
      "Of those, the ones that the change does not narrow: what they cost grows with the graph",
      &counters->condition_whole_evaluations);
  metrics_.AddCounterFunction("docent_condition_whole_seconds_total", "Time that these took", [counters] {
    return static_cast<double>(counters->condition_whole_ns.load()) / 1e9;
  });
  metrics_.AddGaugeFunction("docent_conditions", "Conditions of workflows that are kept true or false",
                            [counters] { return static_cast<double>(counters->conditions.load()); });
  // The names of version 0.1.
  metrics_.AddDeprecatedName("docent_constraint_candidates_total", "docent_condition_candidates_total");
  metrics_.AddDeprecatedName("docent_constraint_evaluations_total", "docent_condition_evaluations_total");
  metrics_.AddDeprecatedName("docent_constraint_whole_evaluations_total",
                             "docent_condition_whole_evaluations_total");
  metrics_.AddDeprecatedName("docent_constraint_whole_seconds_total", "docent_condition_whole_seconds_total");
  metrics_.AddDeprecatedName("docent_constraints", "docent_conditions");
  metrics_.AddGaugeFunction("docent_live_runs", "Workflow runs that have not ended",
                            [counters] { return static_cast<double>(counters->live_runs.load()); });
  metrics_.AddCounterFunction("docent_robot_feedback_refused_total",
                              "Messages of robot adapters that cannot be about their command",
                              [this] { return static_cast<double>(proxies_->refused_feedback()); });
  metrics_.AddGaugeFunction("docent_inbox_batches", "Batches that wait at the door",
                            [this] { return static_cast<double>(inbox_.size()); });
  metrics_.AddGaugeFunction("docent_quads", "Quads in the newest version",
                            [this] { return static_cast<double>(queries_.Newest()->size()); });
  metrics_.AddGaugeFunction("docent_revision", "Revision of the newest version",
                            [this] { return static_cast<double>(queries_.Newest()->revision().value()); });
  const SnapshotKeeper::Counters* snapshots = &snapshots_->counters();
  add("docent_snapshots_total", "Snapshots written", &snapshots->written);
  add("docent_snapshots_failed_total", "Snapshots that could not be written", &snapshots->failed);
  metrics_.AddGaugeFunction("docent_snapshot_offset", "Offset of the newest snapshot that this process wrote",
                            [snapshots] { return static_cast<double>(snapshots->newest_offset.load()); });
  metrics_.AddGaugeFunction("docent_snapshot_bytes", "Size of that snapshot",
                            [snapshots] { return static_cast<double>(snapshots->newest_bytes.load()); });
  metrics_.AddGaugeFunction("docent_log_wal_bytes", "Length of the log's write-ahead file on disk",
                            [this] { return static_cast<double>(log_->Upkeep().wal_bytes); });
  metrics_.AddCounterFunction(
      "docent_log_checkpoint_failures_total",
      "Attempts to carry that file over into the log that failed: the disk is full or broken",
      [this] { return static_cast<double>(log_->Upkeep().failures); });
  metrics_.AddGaugeFunction("docent_history_versions", "Past graph versions kept in memory",
                            [this] { return static_cast<double>(history_->kept_versions()); });
  metrics_.AddGaugeFunction("docent_history_bytes", "Memory that these versions alone hold",
                            [this] { return static_cast<double>(history_->kept_bytes()); });
  metrics_.AddGaugeFunction("docent_query_memory_bytes",
                            "Memory that queries and updates hold, beyond what is small",
                            [this] { return static_cast<double>(query_memory_.taken()); });
  metrics_.AddGaugeFunction("docent_dictionary_bytes", "Memory of the dictionary",
                            [this] { return static_cast<double>(dictionary_.bytes()); });
}

absl::Status Server::PushAndWait(WriteBatch batch, const std::string& what) {
  std::promise<absl::Status> answer;
  LoadJob job;
  job.batch = std::move(batch);
  job.cancellation =
      std::make_shared<Cancellation>(std::chrono::milliseconds(settings_.limits.query_timeout_ms));
  job.done = [&answer, &what](const absl::StatusOr<BatchOutcome>& outcome, const Diagnostics& warnings) {
    for (const Diagnostic& warning : warnings) spdlog::warn("{}: {}", what, warning.message);
    answer.set_value(outcome.status());
  };
  if (!workers_->Submit([this, &job] { loads_.Run(std::move(job)); })) {
    return absl::ResourceExhaustedError(absl::StrCat(what, ": too much work waits"));
  }
  absl::Status status = answer.get_future().get();
  return status.ok() ? status : WithMessage(status, absl::StrCat(what, ": ", status.message()));
}

void Server::RegisterConnectionMetrics() {
  GrpcListener* listener = grpc_listener_.get();
  metrics_.AddGaugeFunction("docent_grpc_connections", "Open gRPC connections",
                            [listener] { return static_cast<double>(listener->open()); });
  metrics_.AddCounterFunction("docent_grpc_connections_total", "gRPC connections accepted",
                              [listener] { return static_cast<double>(listener->accepted()); });
  metrics_.AddCounterFunction("docent_grpc_connections_idle_closed_total",
                              "gRPC connections without a call that were closed to make room for others",
                              [listener] { return static_cast<double>(listener->closed_idle()); });
  metrics_.AddCounterFunction("docent_grpc_connections_refused_total",
                              "gRPC connections closed at once: the limit grpc_connections",
                              [listener] { return static_cast<double>(listener->refused()); });
  metrics_.AddGaugeFunction("docent_streams_bytes",
                            "Made for clients and not taken by them, of all streams and answers",
                            [this] { return static_cast<double>(send_budget_.taken()); });
  metrics_.AddCounterFunction(
      "docent_streams_cut_total",
      "Streams and answers cut since all together held too much: the limit streams_bytes",
      [this] { return static_cast<double>(send_budget_.cut()); });
}

void Server::RegisterSubscriptionMetrics() {
  const SubscriptionCounters* counters = &subscriptions_->counters();
  const auto read = [](const std::atomic<uint64_t>* value) {
    return [value] { return static_cast<double>(value->load()); };
  };
  metrics_.AddGaugeFunction("docent_subscriptions",
                            "Queries that clients follow, each as often as it is followed",
                            read(&counters->open));
  metrics_.AddGaugeFunction("docent_subscription_queries", "Different queries that are followed",
                            read(&counters->queries));
  metrics_.AddGaugeFunction("docent_subscription_revision",
                            "Revision up to which followed queries are looked at", read(&counters->revision));
  metrics_.AddCounterFunction("docent_subscription_evaluations_total",
                              "Followed queries evaluated because a change could match them",
                              read(&counters->evaluations));
  metrics_.AddCounterFunction("docent_subscription_seconds_total", "Time that these took", [counters] {
    return static_cast<double>(counters->evaluation_ns.load()) / 1e9;
  });
  metrics_.AddCounterFunction("docent_subscription_changes_total", "Changes of followed answers",
                              read(&counters->changes));
  metrics_.AddCounterFunction("docent_subscription_replies_total", "Replies sent to those who follow",
                              read(&counters->replies));
  metrics_.AddCounterFunction("docent_subscription_resets_total",
                              "Clients that fell behind and were given the whole answer anew",
                              read(&counters->resets));
  metrics_.AddCounterFunction("docent_subscription_turns_coalesced_total",
                              "Turns looked at together with others: the limit subscription_backlog",
                              read(&counters->coalesced));
}

// The ontologies and rules named on the command line, unless the graph has them as they are.
absl::Status Server::LoadFiles() {
  if (absl::Status status = LoadOntologies(); !status.ok()) return status;
  return LoadRules();
}

absl::Status Server::LoadOntologies() {
  for (const std::string& file : settings_.ontologies) {
    auto rdf = ReadRdf(file, "");
    if (!rdf.ok()) return rdf.status();
    std::string name = std::filesystem::path(file).filename().string();
    ParseRdfOptions options = rdf->Options(file);
    options.blank_node_scope = absl::StrCat(NameInBlankLabel(name), "_");
    ParsedRdf parsed = ParseRdf(rdf->text, rdf->format, options);
    if (!parsed.ok()) return ToStatus(parsed, rdf->text);
    std::string graph = OntologyGraph(name);
    if (SameGraph(dictionary_, *queries_.Newest(), graph, parsed.quads)) continue;
    WriteBatch batch;
    batch.mode = WriteBatch::Mode::kLoad;
    batch.documents.push_back(
        {Document::Kind::kOntology, Document::Action::kPut, name, DeclarePrefixes(parsed.prefixes)});
    for (TermQuad& quad : parsed.quads) {
      quad.graph = Term::Iri(graph);
      batch.operations.push_back({QuadOperation::Kind::kAdd, std::move(quad)});
    }
    if (absl::Status status = PushAndWait(std::move(batch), file); !status.ok()) return status;
  }
  return absl::OkStatus();
}

// Naming a built-in rule set, or none, says which of them are in force.
absl::Status Server::LoadRules() {
  const std::vector<std::string> built_in = rules::BuiltInRuleSets();
  const auto named = [&](const std::string& name) {
    return std::find(settings_.rules.begin(), settings_.rules.end(), name) != settings_.rules.end();
  };
  const bool chosen = named("none") || std::any_of(built_in.begin(), built_in.end(), named);
  const auto catalog = catalog_.Get();
  for (const ModuleEntry& module : catalog->modules) {
    if (!chosen || module.kind != Document::Kind::kRules || named(module.name)) continue;
    if (std::find(built_in.begin(), built_in.end(), module.name) == built_in.end()) continue;
    WriteBatch batch;
    batch.documents.push_back({Document::Kind::kRules, Document::Action::kRemove, module.name, ""});
    if (absl::Status status = PushAndWait(std::move(batch), module.name); !status.ok()) return status;
  }
  for (const std::string& given : settings_.rules) {
    if (given == "none") continue;
    std::string name = given;
    std::string text = rules::BuiltInRuleSet(given);
    if (text.empty()) {
      auto file = ReadText(given);
      if (!file.ok()) {
        return absl::Status(
            file.status().code(),
            absl::StrCat(file.status().message(), "; --rules takes .rules files, none, and the sets ",
                         absl::StrJoin(built_in, ", ")));
      }
      text = *std::move(file);
      name = std::filesystem::path(given).filename().string();
    }
    const size_t fingerprint = std::hash<std::string>()(text);
    const bool same =
        std::any_of(catalog->modules.begin(), catalog->modules.end(), [&](const ModuleEntry& module) {
          return module.kind == Document::Kind::kRules && module.name == name &&
                 module.fingerprint == fingerprint;
        });
    if (same) continue;
    WriteBatch batch;
    batch.documents.push_back({Document::Kind::kRules, Document::Action::kPut, name, std::move(text)});
    if (absl::Status status = PushAndWait(std::move(batch), given); !status.ok()) return status;
  }
  return absl::OkStatus();
}

absl::StatusOr<RulesPreview> Server::PreviewRuleChange(const std::string& name, const std::string* text,
                                                       size_t shown, Cancellation* cancellation) const {
  // The version first: the catalog that goes with it may be a turn newer, never older than its rules.
  const GraphVersionPtr version = queries_.Newest();
  std::vector<rules::RuleSetText> current;
  for (const ModuleEntry& module : catalog_.Get()->modules) {
    if (module.kind == Document::Kind::kRules && module.text != nullptr)
      current.push_back({module.name, *module.text});
  }
  const auto preview = rules::PreviewRules(dictionary_, version, current, name,
                                           text != nullptr ? std::optional<std::string>(*text) : std::nullopt,
                                           shown, settings_.limits, &functions_, cancellation);
  if (!preview.ok()) return preview.status();
  return RulesPreview{version->revision().value(), preview->added, preview->removed, preview->added_triples,
                      preview->removed_triples};
}

// Robots that were there before a restart get one lease to show themselves.
void Server::ExpectRobots() {
  for (const std::string& robot : RobotsOnline(dictionary_, *queries_.Newest())) leases_.Expect(robot);
}

bool Server::Tend() {
  if (!writer_->LogStatus().ok()) writer_->AskLogAgain();
  for (const auto& [robot, seen_us] : leases_.TakeLost()) {
    WriteBatch batch = FactsOfLoss(robot, seen_us, dictionary_, *queries_.Newest());
    inbox_.Push(std::move(batch), [this, robot = robot](const absl::StatusOr<BatchOutcome>& outcome) {
      if (outcome.ok()) spdlog::warn("{} has not renewed its lease: offline", robot);
      leases_.ToldLost(robot, outcome.ok());
    });
  }
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
  return grpc_listener_->status();
}

absl::Status Server::status() const {
  absl::MutexLock lock(&status_mutex_);
  return writer_status_;
}

}  // namespace docent::server
