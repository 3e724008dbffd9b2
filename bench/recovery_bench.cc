#include "bench/recovery_bench.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <utility>

#include "absl/strings/str_cat.h"
#include "bench/command_line.h"
#include "bench/measurement.h"
#include "graph/log/sqlite_log.h"
#include "graph/rdf/vocabulary.h"
#include "kb_server/writer/recovery.h"

namespace docent::bench {
namespace {

using SteadyClock = std::chrono::steady_clock;
constexpr size_t kBatch = 50000;          // quads of a loading turn
constexpr size_t kTurnsPerCommit = 2000;  // one-fact turns
constexpr int kMovers = 1000;             // visitors whose place changes, in runs that replace states
constexpr int kPlaces = 200;
constexpr double kTargetSeconds = 20;  // for a million of each

// Visitors have places; robots that serve at the place are near, and the hall follows from it.
constexpr char kRules[] = R"(PREFIX docent: <https://w3id.org/docent#>
RULE { ?v docent:isIn ?hall } WHERE { ?v docent:isAt ?place . ?place docent:partOf ?hall }
RULE { ?v docent:isNear ?r } WHERE { ?v docent:isAt ?place . ?r docent:serves ?place }
)";

Term Thing(const char* kind, int64_t number) {
  return Term::Iri(absl::StrCat("http://example.org/", kind, "/", number));
}

struct Options {
  int64_t triples = 1000000;
  int64_t records = 1000000;
  int runs = 1;
  bool json = false;
  std::string folder;
};

double Seconds(SteadyClock::time_point since) {
  return std::chrono::duration<double>(SteadyClock::now() - since).count();
}

// Writes the log as a server does, but without waiting for a disk at each turn.
class LogWriter {
 public:
  LogWriter(log::SqliteLog* log, const Options& options, bool replace)
      : log_(*log), options_(options), replace_(replace) {}

  absl::Status Write() {
    absl::Status status = World();
    if (status.ok()) status = Flush();
    if (status.ok()) status = Snapshot();
    for (int64_t i = 0; i < options_.records && status.ok(); ++i) {
      // an existing visitor moves to another place; or a new visitor comes, and none leaves
      const int64_t visitor = replace_ ? i % kMovers : i;
      WriteBatch batch;
      batch.operations.push_back({QuadOperation::Kind::kAdd,
                                  {Thing("visitor", visitor), Term::Iri(DocentIri("isAt")),
                                   Thing("place", (i * 7919 + i / kMovers) % kPlaces), Term()}});
      status = Turn(std::move(batch));
    }
    return status.ok() ? Flush() : status;
  }
  size_t snapshot_bytes() const { return snapshot_bytes_; }
  uint64_t quads() const { return stages_.writer.current().size(); }

 private:
  absl::Status Turn(WriteBatch batch) {
    batch.time_us = ++time_us_;
    std::string record;
    absl::StatusOr<server::TurnResult> result =
        server::RunTurn(&stages_, std::move(batch), head_ + pending_.size() + 1, &record);
    if (!result.ok()) return result.status();
    pending_.push_back(std::move(record));
    return pending_.size() < kTurnsPerCommit ? absl::OkStatus() : Flush();
  }
  absl::Status Flush() {
    auto appended = log_.Append(pending_, 1, head_);
    if (!appended.ok()) return appended.status();
    if (appended->outcome != log::AppendResult::Outcome::kAppended) {
      return absl::InvalidArgumentError(
          absl::StrCat(options_.folder, " holds a log already; choose another folder"));
    }
    head_ += pending_.size();
    pending_.clear();
    return absl::OkStatus();
  }

  absl::Status World() {
    WriteBatch ground;
    auto add = [&ground](Term s, const std::string& p, Term o) {
      ground.operations.push_back(
          {QuadOperation::Kind::kAdd, {std::move(s), Term::Iri(p), std::move(o), Term()}});
    };
    add(Term::Iri(DocentIri("isAt")), std::string(kRdfType), Term::Iri(DocentIri("StateProperty")));
    for (int i = 0; i < kPlaces; ++i) {
      add(Thing("place", i), DocentIri("partOf"), Thing("hall", i % 10));
      if (i % 4 == 0) add(Thing("robot", i), DocentIri("serves"), Thing("place", i));
    }
    absl::Status status = Turn(std::move(ground));
    WriteBatch rules;
    rules.documents.push_back({Document::Kind::kRules, Document::Action::kPut, "near.rules", kRules});
    if (status.ok()) status = Turn(std::move(rules));
    for (int64_t i = 0; i < options_.triples && status.ok();) {
      WriteBatch batch;
      batch.mode = WriteBatch::Mode::kLoad;
      for (; i < options_.triples && batch.operations.size() < kBatch; ++i) {
        // ten properties a thing; texts, numbers and links
        const int64_t property = i % 10;
        Term value = property < 3   ? Term::Literal(absl::StrCat("text ", i))
                     : property < 6 ? Term::Integer(i)
                                    : Thing("thing", (i * 31) % (options_.triples / 10 + 1));
        batch.operations.push_back(
            {QuadOperation::Kind::kAdd,
             {Thing("thing", i / 10), Thing("property", property), std::move(value), Term()}});
      }
      status = Turn(std::move(batch));
    }
    return status;
  }
  absl::Status Snapshot() {
    const auto start = SteadyClock::now();
    auto state = server::EncodeState(server::TakeState(stages_, server::RequestMemory(1),
                                                       stages_.writer.Freeze(Revision(head_)), time_us_),
                                     dictionary_);
    if (!state.ok()) return state.status();
    snapshot_bytes_ = state->size();
    absl::Status status = log_.SnapshotPut(head_, *state);
    std::fprintf(stderr, "snapshot of %llu quads: %zu bytes in %.2f s\n",
                 static_cast<unsigned long long>(quads()), snapshot_bytes_, Seconds(start));
    return status;
  }

  log::SqliteLog& log_;
  const Options& options_;
  const bool replace_;
  Dictionary dictionary_;
  sparql::FunctionRegistry functions_;
  server::Stages stages_{&dictionary_, &functions_, Limits()};
  std::vector<std::string> pending_;
  uint64_t head_ = 0;
  TimeMicros time_us_ = 1'700'000'000'000'000;
  size_t snapshot_bytes_ = 0;
};

struct Recovery {
  double snapshot_s = 0;
  double replay_s = 0;
  uint64_t quads = 0;
};

absl::StatusOr<Recovery> Recover(const std::string& folder) {
  Recovery recovery;
  auto start = SteadyClock::now();
  auto log = log::SqliteLog::Open(folder);
  if (!log.ok()) return log.status();
  const auto head = (*log)->Head();
  if (!head.ok()) return head.status();
  Dictionary dictionary;
  sparql::FunctionRegistry functions;
  auto state = server::FindStart(log->get(), head->offset, &dictionary, &functions, {});
  if (!state.ok()) return state.status();
  recovery.snapshot_s = Seconds(start);
  start = SteadyClock::now();
  const absl::Status status =
      server::ReplayTurns(log->get(), state->offset + 1, head->offset, state->stages.get(),
                          [](const server::TurnResult&, size_t) { return absl::OkStatus(); });
  if (!status.ok()) return status;
  recovery.replay_s = Seconds(start);
  recovery.quads = state->stages->writer.current().size();
  return recovery;
}

absl::Status Measure(const Options& options, bool replace, std::vector<Measurement>* out, double* worst_s) {
  uint64_t quads = 0;
  size_t snapshot_bytes = 0;
  {
    auto log = log::SqliteLog::Open(options.folder);
    if (!log.ok()) return log.status();
    LogWriter writer(log->get(), options, replace);
    if (absl::Status status = writer.Write(); !status.ok()) return status;
    quads = writer.quads();
    snapshot_bytes = writer.snapshot_bytes();
  }
  const std::string name = absl::StrCat(options.triples, " triples, then ", options.records,
                                        " records: ", replace ? "a state replaced" : "a fact added");
  Measurement whole{"recovery", name, "docent", "start, rules on", "s", {}, ""};
  Measurement snapshot{"recovery", name, "docent", "of it, the snapshot", "s", {}, ""};
  Measurement replay{"recovery", name, "docent", "of it, the replay", "s", {}, ""};
  for (int i = 0; i < options.runs; ++i) {
    const auto recovery = Recover(options.folder);
    if (!recovery.ok()) return recovery.status();
    if (recovery->quads != quads) {
      return absl::InternalError(absl::StrCat("recovered ", recovery->quads, " quads of ", quads));
    }
    whole.runs.push_back(recovery->snapshot_s + recovery->replay_s);
    snapshot.runs.push_back(recovery->snapshot_s);
    replay.runs.push_back(recovery->replay_s);
    *worst_s = std::max(*worst_s, whole.runs.back());
  }
  Measurement size{"recovery", name, "docent", "snapshot", "bytes a quad", {}, ""};
  size.runs.push_back(static_cast<double>(snapshot_bytes) / static_cast<double>(quads));
  out->insert(out->end(), {whole, snapshot, replay, size});
  return absl::OkStatus();
}

}  // namespace

int RunRecoveryBench(const std::vector<std::string>& args) {
  Options options;
  options.folder = std::filesystem::temp_directory_path() / absl::StrCat("docent-recovery-", getpid());
  CLI::App app{"How long a start takes, from a snapshot and the log after it", "docent-bench recovery"};
  app.add_option("--triples", options.triples, "In the snapshot")->capture_default_str();
  app.add_option("--records", options.records, "After it, one fact each")->capture_default_str();
  app.add_option("--runs", options.runs)->capture_default_str();
  app.add_option("--folder", options.folder, "Where the data folder is made, and removed afterwards")
      ->capture_default_str();
  app.add_flag("--json", options.json);
  if (std::optional<int> code = Parse(&app, args)) return *code;
  std::vector<Measurement> measurements;
  double worst_s = 0;
  absl::Status status;
  std::error_code error;
  if (std::filesystem::exists(options.folder, error)) {
    std::fprintf(stderr, "docent-bench: %s is there already; choose another folder\n",
                 options.folder.c_str());
    return 2;
  }
  for (const bool replace : {false, true}) {
    if (status.ok()) status = Measure(options, replace, &measurements, &worst_s);
    std::filesystem::remove_all(options.folder, error);
  }
  if (!status.ok()) {
    std::fprintf(stderr, "docent-bench: %s\n", std::string(status.message()).c_str());
    return 2;
  }
  Print(measurements, options.json);
  const bool full = options.triples >= 1000000 && options.records >= 1000000;
  return full && worst_s > kTargetSeconds ? 1 : 0;
}

}  // namespace docent::bench
