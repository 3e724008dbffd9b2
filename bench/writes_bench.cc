#include "bench/writes_bench.h"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <thread>

#include "absl/strings/str_cat.h"
#include "absl/synchronization/mutex.h"
#include "bench/command_line.h"
#include "bench/kb/kb_process.h"
#include "bench/measurement.h"
#include "graph/base/clock.h"
#include "graph/log/sqlite_log.h"
#include "graph/sparql/run/evaluator.h"
#include "graph/sparql/syntax/parser.h"
#include "kb_server/writer/writer.h"

namespace docent::bench {
namespace {

using SteadyClock = std::chrono::steady_clock;

struct Arguments {
  bool json = false;
  size_t triples = 100000;
  int clients = 64;
  size_t in_flight = 16;  // of each client
  double seconds = 5;     // of each measurement
  int runs = 3;
  std::string folder = ".";
};

QuadOperation Fact(const std::string& subject, const std::string& predicate, Term object) {
  return {QuadOperation::Kind::kAdd, {Term::Iri(subject), Term::Iri(predicate), std::move(object), Term()}};
}

// A new fact: number `n` of `client`.
WriteBatch OneFact(int client, uint64_t n) {
  WriteBatch batch;
  batch.operations.push_back(Fact(absl::StrCat("urn:client:", client, "-", n % 1000), "urn:bench:counted",
                                  Term::Integer(static_cast<int64_t>(n))));
  return batch;
}

// Things that know other things and have a number: `triples` in total.
WriteBatch Background(size_t triples) {
  WriteBatch batch;
  batch.mode = WriteBatch::Mode::kLoad;
  const size_t things = triples / 2;
  for (size_t i = 0; i < things; ++i) {
    const std::string thing = absl::StrCat("urn:thing:", i);
    batch.operations.push_back(
        Fact(thing, "urn:bench:knows", Term::Iri(absl::StrCat("urn:thing:", i * 7919 % things))));
    batch.operations.push_back(Fact(thing, "urn:bench:number", Term::Integer(static_cast<int64_t>(i))));
  }
  return batch;
}

// The writer with its surroundings, as in the server, with snapshots and history, but without network and
// robots.
class LocalWriter {
 public:
  static absl::StatusOr<std::unique_ptr<LocalWriter>> Start(const std::string& folder) {
    auto log = log::SqliteLog::Open(folder);
    if (!log.ok()) return log.status();
    std::unique_ptr<LocalWriter> local(new LocalWriter(*std::move(log)));
    if (absl::Status status = local->writer_->Recover(nullptr); !status.ok()) return status;
    local->thread_ = std::thread([w = local->writer_.get()] { (void)w->Run(); });
    return local;
  }
  ~LocalWriter() {
    inbox_.Close();
    if (thread_.joinable()) thread_.join();
  }

  absl::Status Tell(WriteBatch batch) {
    absl::Mutex mutex;
    std::optional<absl::Status> answer;
    inbox_.Push(std::move(batch), [&](const absl::StatusOr<server::BatchOutcome>& outcome) {
      absl::MutexLock lock(&mutex);
      answer = outcome.status();
    });
    absl::MutexLock lock(&mutex);
    const auto answered = [&answer] { return answer.has_value(); };
    mutex.Await(absl::Condition(&answered));
    return *answer;
  }
  server::Inbox& inbox() { return inbox_; }
  const server::QueryPort& queries() const { return queries_; }
  const Dictionary& dictionary() const { return dictionary_; }

 private:
  explicit LocalWriter(std::unique_ptr<log::SqliteLog> log) : log_(std::move(log)) {
    snapshots_ = std::make_unique<server::SnapshotKeeper>(log_.get(), &dictionary_, Limits{});
    history_ = std::make_unique<server::History>(log_.get(), &queries_, &dictionary_, &functions_, Limits{});
    server::Writer::Ports ports;
    ports.inbox = &inbox_;
    ports.log = log_.get();
    ports.queries = &queries_;
    ports.catalog = &catalog_;
    ports.feed = &feed_;
    ports.snapshots = snapshots_.get();
    ports.history = history_.get();
    ports.dictionary = &dictionary_;
    ports.functions = &functions_;
    writer_ = std::make_unique<server::Writer>(ports);
  }

  SystemClock clock_;
  Dictionary dictionary_;
  server::Inbox inbox_{&clock_, Limits{}};
  server::QueryPort queries_;
  server::CatalogPort catalog_;
  server::RunFeed feed_;
  sparql::FunctionRegistry functions_;
  std::unique_ptr<log::SqliteLog> log_;
  std::unique_ptr<server::SnapshotKeeper> snapshots_;
  std::unique_ptr<server::History> history_;
  std::unique_ptr<server::Writer> writer_;
  std::thread thread_;
};

// One client: limits its facts in flight, and records the time of each from sending to acknowledgement.
class Client {
 public:
  Client(LocalWriter* writer, int number, size_t in_flight)
      : writer_(*writer), number_(number), in_flight_(in_flight) {}

  // Sends facts until `end`: as fast as answers come, or one every `period` (0: no pace).
  void Run(SteadyClock::time_point end, SteadyClock::duration period, std::atomic<uint64_t>* next) {
    SteadyClock::time_point due = SteadyClock::now();
    while (SteadyClock::now() < end) {
      if (period.count() > 0) std::this_thread::sleep_until(due);
      {
        absl::MutexLock lock(&mutex_);
        mutex_.Await(absl::Condition(this, &Client::HasRoom));
        ++open_;
      }
      // A paced client counts the waiting time for a free place, too; an unpaced one sends when it has one.
      const auto told = period.count() > 0 ? due : SteadyClock::now();
      due += period;
      writer_.inbox().Push(OneFact(number_, next->fetch_add(1)),
                           [this, told](const absl::StatusOr<server::BatchOutcome>& outcome) {
                             const double ms =
                                 std::chrono::duration<double, std::milli>(SteadyClock::now() - told).count();
                             absl::MutexLock lock(&mutex_);
                             --open_;
                             if (outcome.ok()) {
                               latencies_ms_.push_back(ms);
                             } else {
                               ++refused_;
                             }
                           });
    }
    absl::MutexLock lock(&mutex_);
    mutex_.Await(absl::Condition(this, &Client::Done));
  }
  const std::vector<double>& latencies_ms() const ABSL_NO_THREAD_SAFETY_ANALYSIS { return latencies_ms_; }
  uint64_t refused() const ABSL_NO_THREAD_SAFETY_ANALYSIS { return refused_; }

 private:
  bool HasRoom() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) { return open_ < in_flight_; }
  bool Done() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) { return open_ == 0; }

  LocalWriter& writer_;
  const int number_;
  const size_t in_flight_;
  absl::Mutex mutex_;
  size_t open_ ABSL_GUARDED_BY(mutex_) = 0;
  std::vector<double> latencies_ms_ ABSL_GUARDED_BY(mutex_);
  uint64_t refused_ ABSL_GUARDED_BY(mutex_) = 0;
};

struct Load {
  double rate = 0;
  std::vector<double> latencies_ms;
  uint64_t refused = 0;
};

// Runs all clients for `seconds`; `rate` facts a second in total, 0: as many as possible.
Load Drive(LocalWriter* writer, const Arguments& arguments, double rate, std::atomic<uint64_t>* next) {
  std::vector<std::unique_ptr<Client>> clients;
  std::vector<std::thread> threads;
  const auto start = SteadyClock::now();
  const auto end = start + std::chrono::duration_cast<SteadyClock::duration>(
                               std::chrono::duration<double>(arguments.seconds));
  SteadyClock::duration period{};
  if (rate > 0)
    period = std::chrono::duration_cast<SteadyClock::duration>(
        std::chrono::duration<double>(arguments.clients / rate));
  for (int i = 0; i < arguments.clients; ++i) {
    clients.push_back(std::make_unique<Client>(writer, i, arguments.in_flight));
    threads.emplace_back(
        [client = clients.back().get(), end, period, next] { client->Run(end, period, next); });
  }
  for (std::thread& thread : threads) thread.join();
  Load load;
  const double seconds = SecondsSince(start);
  for (const auto& client : clients) {
    load.latencies_ms.insert(load.latencies_ms.end(), client->latencies_ms().begin(),
                             client->latencies_ms().end());
    load.refused += client->refused();
  }
  load.rate = static_cast<double>(load.latencies_ms.size()) / seconds;
  return load;
}

// Runs a query on the newest version repeatedly until `stop`, or until `seconds` have passed.
std::vector<double> QueryLatencies(const LocalWriter& writer, const std::string& text, double seconds,
                                   const std::atomic<bool>* stop) {
  std::vector<double> out;
  const sparql::ParsedQuery parsed = sparql::ParseQuery(text);
  const auto query = sparql::PreparedQuery::Prepare(parsed.query, writer.dictionary());
  const auto begun = SteadyClock::now();
  while (SecondsSince(begun) < seconds && !stop->load()) {
    const auto start = SteadyClock::now();
    const GraphVersionPtr version = writer.queries().Newest();
    (void)(*query)->Select({version.get(), nullptr, 0, 0}, {}, [](absl::Span<const TermId>) { return true; });
    out.push_back(SecondsSince(start) * 1e3);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return out;
}

// A query of about a millisecond on this machine.
std::string MillisecondQuery(const LocalWriter& writer) {
  const std::atomic<bool> never{false};
  for (size_t limit = 500;; limit *= 2) {
    const std::string text =
        absl::StrCat("SELECT ?a ?n { ?a <urn:bench:knows> ?b . ?b <urn:bench:number> ?n } LIMIT ", limit);
    if (limit > 1000000 || Percentile(QueryLatencies(writer, text, 0.2, &never), 0.5) > 0.7) return text;
  }
}

double VersionsPerSecond(size_t triples, double seconds) {
  Dictionary dictionary;
  server::Stages stages(&dictionary, nullptr, Limits{});
  uint64_t offset = 0;
  (void)server::RunTurn(&stages, Background(triples), ++offset);
  GraphVersionPtr newest;
  const auto start = SteadyClock::now();
  uint64_t n = 0;
  for (; n % 1024 != 0 || SecondsSince(start) < seconds; ++n) {
    auto result = server::RunTurn(&stages, OneFact(static_cast<int>(n % 64), n), ++offset);
    if (!result.ok()) return 0;
    newest = std::move(result->version);
  }
  return static_cast<double>(n) / SecondsSince(start);
}

int Measure(const Arguments& arguments, std::vector<Measurement>* figures) {
  const auto add = [&](const std::string& name, const std::string& metric, const std::string& unit,
                       std::vector<double> runs) {
    figures->push_back({"writes", name, "docent", metric, unit, std::move(runs), ""});
  };
  const std::string over = absl::StrCat(", over ", arguments.triples, " triples");
  std::vector<double> versions, rates, p50, p99, idle, loaded, ratio, half_p99, half_rate;
  for (int run = 0; run < arguments.runs; ++run)
    versions.push_back(VersionsPerSecond(arguments.triples, arguments.seconds));
  add(absl::StrCat("one-fact versions in memory", over), "text to new version", "versions/s", versions);

  const std::string folder =
      std::filesystem::path(arguments.folder) / absl::StrCat("docent-writes-", getpid());
  uint64_t refused = 0;
  {
    auto writer = LocalWriter::Start(folder);
    absl::Status status = writer.status();
    if (status.ok()) status = (*writer)->Tell(Background(arguments.triples));
    if (!status.ok()) {
      std::fprintf(stderr, "docent-bench: %s\n", std::string(status.message()).c_str());
      return 2;
    }
    std::atomic<uint64_t> next{0};
    const std::string query = MillisecondQuery(**writer);
    for (int run = 0; run < arguments.runs; ++run) {
      const Load full = Drive(writer->get(), arguments, 0, &next);
      rates.push_back(full.rate);
      p50.push_back(Percentile(full.latencies_ms, 0.5));
      p99.push_back(Percentile(full.latencies_ms, 0.99));
      std::atomic<bool> stop{false};
      idle.push_back(Percentile(QueryLatencies(**writer, query, arguments.seconds, &stop), 0.99));
      std::vector<double> latencies;
      std::thread reader([&] { latencies = QueryLatencies(**writer, query, 1e9, &stop); });
      const Load half = Drive(writer->get(), arguments, std::min(full.rate, 50000.0) / 2, &next);
      stop = true;
      reader.join();
      half_rate.push_back(half.rate);
      half_p99.push_back(Percentile(half.latencies_ms, 0.99));
      loaded.push_back(Percentile(latencies, 0.99));
      ratio.push_back(loaded.back() / idle.back());
      refused += full.refused + half.refused;
    }
  }
  std::filesystem::remove_all(folder);
  const std::string name = absl::StrCat("durable facts, ", arguments.clients, " clients, ",
                                        arguments.in_flight, " in flight each");
  add(name, "acknowledged", "facts/s", rates);
  add(name, "latency p50", "ms", p50);
  add(name, "latency p99", "ms", p99);
  add(name, "refused", "facts", {static_cast<double>(refused)});
  const std::string with = "a query of about 1 ms beside half that load";
  add(with, "facts meanwhile", "facts/s", half_rate);
  add(with, "p99 of the facts", "ms", half_p99);
  add(with, "p99 idle", "ms", idle);
  add(with, "p99 under load", "ms", loaded);
  add(with, "p99 under load / idle", "x", ratio);
  const bool met = Median(versions) >= 50000 && Median(rates) >= 50000 && Median(p99) < 20 &&
                   Median(ratio) <= 4 && refused == 0;
  return met ? 0 : 1;
}

}  // namespace

int RunWritesBench(const std::vector<std::string>& args) {
  CLI::App app{"Versions and durable facts a second in process, and a query's latency beside them",
               "docent-bench writes"};
  Arguments arguments;
  app.add_flag("--json", arguments.json, "One JSON object a line");
  app.add_option("--triples", arguments.triples, "Background triples")->capture_default_str();
  app.add_option("--clients", arguments.clients, "Threads that tell facts")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000));
  app.add_option("--in-flight", arguments.in_flight, "Facts of one client that wait for their answer")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000));
  app.add_option("--seconds", arguments.seconds, "Of each measurement")->capture_default_str();
  app.add_option("--runs", arguments.runs, "Runs; the median is reported")->capture_default_str();
  app.add_option("--folder", arguments.folder, "Folder of the durable log (its disk is measured)")
      ->capture_default_str();
  if (std::optional<int> code = Parse(&app, args)) return *code;
  std::vector<Measurement> figures;
  const int code = Measure(arguments, &figures);
  Print(figures, arguments.json);
  return code;
}

}  // namespace docent::bench
