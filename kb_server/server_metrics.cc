#include "kb_server/server_metrics.h"

#include <atomic>
#include <cstdint>
#include <limits>
#include <optional>

namespace docent::server {
namespace {

void Count(Metrics* metrics, const char* name, const char* help, const std::atomic<uint64_t>* value) {
  metrics->AddCounterFunction(name, help, [value] { return static_cast<double>(value->load()); });
}

void AddTurnMetrics(const MeasuredParts& parts, Metrics* metrics) {
  const WriterCounters* counters = &parts.writer->counters();
  Count(metrics, "docent_turns_total", "Batches applied and durable", &counters->turns);
  Count(metrics, "docent_commits_total", "Commits of the log; each is one fdatasync for all turns in it",
        &counters->commits);
  Count(metrics, "docent_batches_refused_total", "Batches refused: bad input, limits, the log",
        &counters->refused);
  Count(metrics, "docent_commands_total", "Commands sent to robots", &counters->commands);
  Count(metrics, "docent_inferred_total", "Facts that rules added or withdrew", &counters->inferred);
  Count(metrics, "docent_condition_candidates_total",
        "Pairs of a condition and a changed quad that can match it", &counters->condition_candidates);
  Count(metrics, "docent_condition_evaluations_total",
        "Conditions evaluated because a change could match them", &counters->condition_evaluations);
  Count(metrics, "docent_condition_whole_evaluations_total",
        "Of those, the ones that the change does not narrow: what they cost grows with the graph",
        &counters->condition_whole_evaluations);
  metrics->AddCounterFunction("docent_condition_whole_seconds_total", "Time that these took", [counters] {
    return static_cast<double>(counters->condition_whole_ns.load()) / 1e9;
  });
  metrics->AddGaugeFunction("docent_conditions", "Conditions of workflows that are kept true or false",
                            [counters] { return static_cast<double>(counters->conditions.load()); });
  // The names of version 0.1.
  metrics->AddDeprecatedName("docent_constraint_candidates_total", "docent_condition_candidates_total");
  metrics->AddDeprecatedName("docent_constraint_evaluations_total", "docent_condition_evaluations_total");
  metrics->AddDeprecatedName("docent_constraint_whole_evaluations_total",
                             "docent_condition_whole_evaluations_total");
  metrics->AddDeprecatedName("docent_constraint_whole_seconds_total", "docent_condition_whole_seconds_total");
  metrics->AddDeprecatedName("docent_constraints", "docent_conditions");
  Count(metrics, "docent_firings_ignored_total",
        "Firings of activators that started no run: by ext:mode, ext:max or a limit, or while the workflow "
        "was paused or disabled",
        &counters->firings_ignored);
  metrics->AddGaugeFunction("docent_live_runs", "Workflow runs that have not ended (runs_live)",
                            [counters] { return static_cast<double>(counters->live_runs.load()); });
  metrics->AddGaugeFunction("docent_commands_open", "Commands that have no final report yet",
                            [parts] { return static_cast<double>(parts.proxies->open()); });
  metrics->AddCounterFunction("docent_robot_feedback_refused_total",
                              "Messages of robot adapters that cannot be about their command",
                              [parts] { return static_cast<double>(parts.proxies->refused_feedback()); });
  metrics->AddCounterFunction("docent_joins_refused_total",
                              "Joins of adapters refused because another one speaks for their robot",
                              [parts] { return static_cast<double>(parts.leases->refused()); });
}

void AddTimeMetrics(const MeasuredParts& parts, Metrics* metrics) {
  constexpr double kMicros = 1e6;
  metrics->AddGaugeFunction("docent_time_seconds", "Time of the server's clock, since 1970",
                            [parts] { return static_cast<double>(parts.clock->Now()) / kMicros; });
  metrics->AddGaugeFunction("docent_time_is_simulated", "1 where a simulator tells the time, else 0",
                            [parts] { return parts.simulated_time ? 1.0 : 0.0; });
  metrics->AddGaugeFunction(
      "docent_next_due_seconds",
      "When something falls due though nothing comes in, by that clock; now, while something is under way",
      [parts] {
        const std::optional<TimeMicros> due = parts.next_due();
        return due ? static_cast<double>(*due) / kMicros : std::numeric_limits<double>::infinity();
      });
}

void AddGraphMetrics(const MeasuredParts& parts, Metrics* metrics) {
  metrics->AddGaugeFunction("docent_inbox_batches", "Batches that wait at the door",
                            [parts] { return static_cast<double>(parts.inbox->size()); });
  metrics->AddGaugeFunction("docent_quads", "Quads in the newest version",
                            [parts] { return static_cast<double>(parts.queries->Newest()->size()); });
  metrics->AddGaugeFunction("docent_revision", "Revision of the newest version", [parts] {
    return static_cast<double>(parts.queries->Newest()->revision().value());
  });
}

void AddLogMetrics(const MeasuredParts& parts, Metrics* metrics) {
  const SnapshotKeeper::Counters* snapshots = &parts.snapshots->counters();
  Count(metrics, "docent_snapshots_total", "Snapshots written", &snapshots->written);
  Count(metrics, "docent_snapshots_failed_total", "Snapshots that could not be written", &snapshots->failed);
  metrics->AddGaugeFunction("docent_snapshot_offset", "Offset of the newest snapshot that this process wrote",
                            [snapshots] { return static_cast<double>(snapshots->newest_offset.load()); });
  metrics->AddGaugeFunction("docent_snapshot_bytes", "Size of that snapshot",
                            [snapshots] { return static_cast<double>(snapshots->newest_bytes.load()); });
  metrics->AddGaugeFunction("docent_log_wal_bytes", "Length of the log's write-ahead file on disk",
                            [parts] { return static_cast<double>(parts.log->Upkeep().wal_bytes); });
  metrics->AddCounterFunction(
      "docent_log_checkpoint_failures_total",
      "Attempts to carry that file over into the log that failed: the disk is full or broken",
      [parts] { return static_cast<double>(parts.log->Upkeep().failures); });
}

void AddMemoryMetrics(const MeasuredParts& parts, Metrics* metrics) {
  metrics->AddGaugeFunction("docent_history_versions", "Past graph versions kept in memory",
                            [parts] { return static_cast<double>(parts.history->kept_versions()); });
  metrics->AddGaugeFunction("docent_history_bytes", "Memory that these versions alone hold",
                            [parts] { return static_cast<double>(parts.history->kept_bytes()); });
  metrics->AddGaugeFunction(
      "docent_query_memory_bytes",
      "Memory that queries and updates hold, beyond what is small (queries_memory_bytes)",
      [parts] { return static_cast<double>(parts.query_memory->taken()); });
  metrics->AddGaugeFunction("docent_dictionary_bytes", "Memory of the dictionary",
                            [parts] { return static_cast<double>(parts.dictionary->bytes()); });
}

void AddConnectionMetrics(const MeasuredParts& parts, Metrics* metrics) {
  GrpcListener* listener = parts.listener;
  metrics->AddGaugeFunction("docent_grpc_connections", "Open gRPC connections",
                            [listener] { return static_cast<double>(listener->open()); });
  metrics->AddCounterFunction("docent_grpc_connections_total", "gRPC connections accepted",
                              [listener] { return static_cast<double>(listener->accepted()); });
  metrics->AddCounterFunction("docent_grpc_connections_idle_closed_total",
                              "gRPC connections without a call that were closed to make room for others",
                              [listener] { return static_cast<double>(listener->closed_idle()); });
  metrics->AddCounterFunction("docent_grpc_connections_refused_total",
                              "gRPC connections closed at once: the limit grpc_connections",
                              [listener] { return static_cast<double>(listener->refused()); });
  metrics->AddGaugeFunction("docent_streams_bytes",
                            "Made for clients and not taken by them, of all streams and answers",
                            [parts] { return static_cast<double>(parts.send_budget->taken()); });
  metrics->AddCounterFunction(
      "docent_streams_cut_total",
      "Streams and answers cut since all together held too much: the limit streams_bytes",
      [parts] { return static_cast<double>(parts.send_budget->cut()); });
}

void AddSubscriptionMetrics(const MeasuredParts& parts, Metrics* metrics) {
  const SubscriptionCounters* counters = &parts.subscriptions->counters();
  const auto read = [](const std::atomic<uint64_t>* value) {
    return [value] { return static_cast<double>(value->load()); };
  };
  metrics->AddGaugeFunction(
      "docent_subscriptions",
      "Queries that clients follow, each as often as it is followed (subscriptions_open)",
      read(&counters->open));
  metrics->AddGaugeFunction("docent_subscription_queries", "Different queries that are followed",
                            read(&counters->queries));
  metrics->AddGaugeFunction("docent_subscription_revision",
                            "Revision up to which followed queries are looked at", read(&counters->revision));
  metrics->AddGaugeFunction("docent_subscription_bytes",
                            "Memory of followed queries and their answers, about (subscriptions_bytes)",
                            [parts] { return static_cast<double>(parts.subscriptions->bytes()); });
  metrics->AddCounterFunction("docent_subscription_evaluations_total",
                              "Followed queries evaluated because a change could match them",
                              read(&counters->evaluations));
  metrics->AddCounterFunction("docent_subscription_seconds_total", "Time that these took", [counters] {
    return static_cast<double>(counters->evaluation_ns.load()) / 1e9;
  });
  metrics->AddCounterFunction("docent_subscription_changes_total", "Changes of followed answers",
                              read(&counters->changes));
  metrics->AddCounterFunction("docent_subscription_replies_total", "Replies sent to those who follow",
                              read(&counters->replies));
  metrics->AddCounterFunction("docent_subscription_resets_total",
                              "Clients that fell behind and were given the whole answer anew",
                              read(&counters->resets));
  metrics->AddCounterFunction("docent_subscription_turns_coalesced_total",
                              "Turns looked at together with others: the limit subscription_backlog",
                              read(&counters->coalesced));
}

void AddWorkMetrics(const MeasuredParts& parts, Metrics* metrics) {
  const WorkerPool* workers = parts.workers;
  const auto add = [&](const char* name, const char* help, double (*read)(const WorkerPool::Load&)) {
    metrics->AddGaugeFunction(name, help, [workers, read] { return read(workers->load()); });
  };
  add("docent_work_running", "Queries, updates and other work that have a place to run",
      [](const WorkerPool::Load& load) { return static_cast<double>(load.running + load.short_running); });
  add("docent_work_held_up", "Work that has begun and gave its place to clients that had less",
      [](const WorkerPool::Load& load) { return static_cast<double>(load.held_up); });
  add("docent_work_begun", "Work that has begun and not ended: each piece holds a thread",
      [](const WorkerPool::Load& load) { return static_cast<double>(load.begun); });
  add("docent_work_queued", "Work that waits to begin",
      [](const WorkerPool::Load& load) { return static_cast<double>(load.queued); });
  add("docent_work_clients", "Clients that have work which wants to run",
      [](const WorkerPool::Load& load) { return static_cast<double>(load.clients); });
  metrics->AddGaugeFunction("docent_revisions_waiting", "Requests that wait for a revision",
                            [parts] { return static_cast<double>(parts.queries->waiting()); });
  metrics->AddGaugeFunction("docent_clients", "Connections of clients that ask",
                            [parts] { return static_cast<double>(parts.clients->size()); });
}

}  // namespace

void AddServerMetrics(const MeasuredParts& parts, Metrics* metrics) {
  AddTurnMetrics(parts, metrics);
  AddTimeMetrics(parts, metrics);
  AddGraphMetrics(parts, metrics);
  AddLogMetrics(parts, metrics);
  AddMemoryMetrics(parts, metrics);
  AddConnectionMetrics(parts, metrics);
  AddSubscriptionMetrics(parts, metrics);
  AddWorkMetrics(parts, metrics);
}

}  // namespace docent::server
