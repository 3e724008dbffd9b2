// A writer with all its ports, and a log that a test controls.
#ifndef DOCENT_TESTS_KB_SERVER_WRITER_NODE_H_
#define DOCENT_TESTS_KB_SERVER_WRITER_NODE_H_

#include <algorithm>
#include <functional>
#include <future>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "gtest/gtest.h"
#include "kb_server/writer/writer.h"
#include "tests/kb_server/test_world.h"

namespace docent::server::test {

// A status that a test sets while the writer reads it.
class SharedStatus {
 public:
  void operator=(absl::Status status) {
    absl::MutexLock lock(&mutex_);
    status_ = std::move(status);
  }
  operator absl::Status() const {
    absl::MutexLock lock(&mutex_);
    return status_;
  }

 private:
  mutable absl::Mutex mutex_;
  absl::Status status_ ABSL_GUARDED_BY(mutex_);
};

// A log in memory that refuses appends when told to.
class FakeLog : public log::ContextLog {
 public:
  absl::StatusOr<log::AppendResult> Append(absl::Span<const std::string> added, uint64_t epoch,
                                           uint64_t expected) override {
    if (on_append) on_append(added.size());
    absl::MutexLock lock(&mutex_);
    const absl::Status refuse = refusal, lose = lost_answer;
    if (once) {
      refusal = absl::OkStatus();
      lost_answer = absl::OkStatus();
    }
    if (!refuse.ok()) return refuse;
    if (fenced) return log::AppendResult{log::AppendResult::Outcome::kFenced, {records_.size(), epoch + 1}};
    EXPECT_EQ(expected, records_.size());
    records_.insert(records_.end(), added.begin(), added.end());
    if (!lose.ok()) return lose;
    return log::AppendResult{log::AppendResult::Outcome::kAppended, {records_.size(), epoch}};
  }
  absl::StatusOr<std::vector<log::LogEntry>> Read(uint64_t from, size_t max) override {
    absl::MutexLock lock(&mutex_);
    std::vector<log::LogEntry> entries;
    for (uint64_t i = from; i <= records_.size() && entries.size() < max; ++i)
      entries.push_back({i, 1, records_[i - 1]});
    return entries;
  }
  absl::StatusOr<uint64_t> Wait(uint64_t, std::chrono::milliseconds) override { return size(); }
  absl::StatusOr<log::LogHead> Head() override { return log::LogHead{size(), 1}; }
  absl::StatusOr<uint64_t> First() override { return 1; }
  absl::Status SnapshotPut(uint64_t, std::string_view) override { return absl::OkStatus(); }
  absl::StatusOr<std::optional<log::LogSnapshot>> SnapshotGet(uint64_t) override { return std::nullopt; }
  absl::StatusOr<std::vector<uint64_t>> SnapshotOffsets() override { return std::vector<uint64_t>(); }
  absl::Status SnapshotDrop(uint64_t) override { return absl::OkStatus(); }
  absl::Status Trim(uint64_t) override { return absl::OkStatus(); }
  absl::StatusOr<uint64_t> Bytes() override { return size(); }
  absl::Status Probe() override {
    const absl::Status there = place;
    return there.ok() ? absl::Status(refusal) : there;
  }

  absl::Status CheckPlace() override { return place; }

  uint64_t size() const {
    absl::MutexLock lock(&mutex_);
    return records_.size();
  }
  std::string& record(uint64_t offset) { return records_[offset - 1]; }  // while no writer runs

  // Set from on_append, or while nothing is in flight.
  std::function<void(size_t)> on_append;
  SharedStatus refusal;
  SharedStatus lost_answer;  // the append succeeds, and this is told
  SharedStatus place;        // see CheckPlace
  bool once = false;         // they are of one append only
  bool fenced = false;

 private:
  mutable absl::Mutex mutex_;
  std::vector<std::string> records_;
};

// A writer with all its ports.
class Node {
 public:
  explicit Node(log::ContextLog* log, bool with_robots = false, const Limits& limits = {})
      : inbox(&clock, limits) {
    if (with_robots) {
      proxies = std::make_unique<proxy::RobotProxies>(
          [this](WriteBatch batch) { inbox.Push(std::move(batch), nullptr); }, proxy::ProxySettings{},
          &clock);
    }
    feed.Subscribe([this] { TakeEvents(); });
    Writer::Ports ports;
    ports.inbox = &inbox;
    ports.log = log;
    ports.queries = &queries;
    ports.catalog = &catalog;
    ports.feed = &feed;
    ports.proxies = proxies.get();
    ports.dictionary = &dictionary;
    ports.functions = &functions;
    ports.limits = limits;
    writer = std::make_unique<Writer>(ports);
    recovered = writer->Recover(nullptr);
    next_event = feed.Next();
  }
  ~Node() { End().IgnoreError(); }

  std::future<absl::StatusOr<BatchOutcome>> Push(WriteBatch batch, BatchPreparation prepare = nullptr) {
    auto answer = std::make_shared<std::promise<absl::StatusOr<BatchOutcome>>>();
    inbox.Push(
        std::move(batch),
        [answer](const absl::StatusOr<BatchOutcome>& outcome) { answer->set_value(outcome); },
        std::move(prepare));
    return answer->get_future();
  }
  void Begin() {
    thread = std::thread([this] { ended = writer->Run(); });
  }
  absl::Status End() {
    inbox.Close();
    if (thread.joinable()) thread.join();
    return ended;
  }
  absl::StatusOr<BatchOutcome> Ask(WriteBatch batch) { return Push(std::move(batch)).get(); }
  // Sends all of these in one group, to a writer that did not run before and ends afterwards.
  std::vector<absl::StatusOr<BatchOutcome>> AskTogether(const std::vector<WriteBatch>& batches) {
    std::vector<std::future<absl::StatusOr<BatchOutcome>>> answers;
    for (const WriteBatch& batch : batches) answers.push_back(Push(batch));
    inbox.Close();
    ended = writer->Run();
    std::vector<absl::StatusOr<BatchOutcome>> outcomes;
    for (auto& answer : answers) outcomes.push_back(answer.get());
    return outcomes;
  }

  std::vector<std::string> Quads() const {
    GraphVersionPtr version = queries.Newest();
    std::vector<std::string> lines;
    version->ForEach({}, [&](const Quad& quad) {
      lines.push_back(absl::StrCat(
          ToNTriples(dictionary.Decode(quad.subject)), " ", ToNTriples(dictionary.Decode(quad.predicate)),
          " ", ToNTriples(dictionary.Decode(quad.object)), " ", ToNTriples(dictionary.Decode(quad.graph))));
      return true;
    });
    std::sort(lines.begin(), lines.end());
    return lines;
  }
  bool Knows(const std::string& text) const {
    std::vector<std::string> quads = Quads();
    return std::any_of(quads.begin(), quads.end(),
                       [&](const std::string& quad) { return quad.find(text) != std::string::npos; });
  }
  std::vector<std::string> Events() const {
    absl::MutexLock lock(&mutex);
    return events;
  }
  void TakeEvents() {
    absl::MutexLock lock(&mutex);
    for (; next_event < feed.Next(); ++next_event) {
      const RunEventPtr event = *feed.Get(next_event);
      events.push_back(event->kind + " " + event->run + "/" + event->node + " " + event->to);
    }
  }
  uint64_t revision() const { return queries.Newest()->revision().value(); }

  ManualClock clock{1'700'000'000'000'000};
  Inbox inbox;
  QueryPort queries;
  CatalogPort catalog;
  RunFeed feed;
  Dictionary dictionary;
  sparql::FunctionRegistry functions;
  std::unique_ptr<proxy::RobotProxies> proxies;
  std::unique_ptr<Writer> writer;
  absl::Status recovered;
  absl::Status ended;
  std::thread thread;
  mutable absl::Mutex mutex;
  std::vector<std::string> events;
  uint64_t next_event = 1;  // of the feed, to be taken
};

inline WriteBatch Named(const std::string& request_id, WriteBatch batch) {
  batch.request_id = request_id;
  return batch;
}

// World, rules, workflow, a waiting run, and the batch that lets it continue.
inline std::vector<WriteBatch> Story() {
  return {WorldFacts(), Put(Document::Kind::kRules, "near.rules", kRules),
          Put(Document::Kind::kCawl, "greeting.xml", kGreeting), Named("start", Start("Greeting")),
          Reading("tag-17")};
}

}  // namespace docent::server::test

#endif  // DOCENT_TESTS_KB_SERVER_WRITER_NODE_H_
