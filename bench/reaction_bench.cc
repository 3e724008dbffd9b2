#include "bench/reaction_bench.h"

#include <grpcpp/grpcpp.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <thread>

#include "absl/container/flat_hash_map.h"
#include "absl/strings/str_cat.h"
#include "absl/synchronization/mutex.h"
#include "bench/assert_client.h"
#include "bench/command_line.h"
#include "bench/instant_robots.h"
#include "bench/measurement.h"
#include "bench/server_process.h"
#include "bench/worlds/workflow_mix.h"
#include "docent/v1/context.grpc.pb.h"
#include "docent/v1/robot_adapter.grpc.pb.h"
#include "kb_server/grpc/convert.h"
#include "kb_server/grpc/one_callback_thread.h"

namespace docent::bench {
namespace {

using SteadyClock = std::chrono::steady_clock;
constexpr int kRobots = 64;  // more than updates in flight, so that no update waits for a free robot
constexpr size_t kInFlight = 32;

// Times at which updates were due, and at which their Invokes came.
class Reactions {
 public:
  void Due(const std::string& token, SteadyClock::time_point when) {
    absl::MutexLock lock(&mutex_);
    due_[token] = when;
  }
  void Invoked(const std::string& token) {
    SteadyClock::time_point now = SteadyClock::now();
    absl::MutexLock lock(&mutex_);
    auto it = due_.find(token);
    if (it == due_.end()) return;
    latencies_us_.push_back(std::chrono::duration<double, std::micro>(now - it->second).count());
    due_.erase(it);
    last_ = now;
  }
  // Waits until all due ones have come, or `timeout`.
  bool WaitForAll(absl::Duration timeout) {
    absl::MutexLock lock(&mutex_);
    auto none = [this]() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) { return due_.empty(); };
    return mutex_.AwaitWithTimeout(absl::Condition(&none), timeout);
  }
  // Waits until fewer than `limit` are outstanding.
  void WaitForRoom(size_t limit) {
    absl::MutexLock lock(&mutex_);
    auto room = [this, limit]() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) { return due_.size() < limit; };
    mutex_.AwaitWithTimeout(absl::Condition(&room), absl::Seconds(10));
  }
  std::vector<double> Take(SteadyClock::time_point* last) {
    absl::MutexLock lock(&mutex_);
    *last = last_;
    due_.clear();
    return std::move(latencies_us_);
  }

 private:
  absl::Mutex mutex_;
  absl::flat_hash_map<std::string, SteadyClock::time_point> due_ ABSL_GUARDED_BY(mutex_);
  std::vector<double> latencies_us_ ABSL_GUARDED_BY(mutex_);
  SteadyClock::time_point last_ ABSL_GUARDED_BY(mutex_);
};

std::string WorkflowText(size_t i) {
  return absl::StrCat("<CAWL name=\"W", i,
                      "\" namespace=\"urn:mix:\" version=\"1\"><activator name=\"a\"><activate flow=\"F", i,
                      "\"/><condition><context name=\"c\">", CawlRuleNumber(i),
                      "</context></condition></activator><flow name=\"F", i,
                      "\"><source name=\"s\"/><node name=\"n\"><invoke operation=\"ping_", TokenVariable(i),
                      "\"/></node><sink "
                      "name=\"t\"/><link from=\"s\" to=\"n\"/>"
                      "<link from=\"n\" to=\"t\"/></flow></CAWL>");
}

// Fills the server: background, state properties, robots, workflows.
grpc::Status Prepare(const std::shared_ptr<grpc::Channel>& channel, const std::string& adapter,
                     size_t triples, size_t constraints) {
  std::vector<TermQuad> quads = Background(triples, constraints);
  for (TermQuad& quad : StateProperties()) quads.push_back(std::move(quad));
  for (TermQuad& quad : InstantRobots(kRobots, adapter, {{"ping_t", "t"}, {"ping_v", "v"}}))
    quads.push_back(std::move(quad));
  if (grpc::Status status = LoadQuads(channel, quads); !status.ok()) return status;
  for (size_t i = 0; i < constraints; ++i) {
    if (grpc::Status status = Deploy(channel, absl::StrCat("W", i), WorkflowText(i)); !status.ok())
      return status;
  }
  return grpc::Status::OK;
}

v1::AssertRequest ToRequest(const MixedUpdate& update) {
  v1::AssertRequest request;
  request.set_source("urn:mix:sensors");
  v1::Quad* quad = request.add_add();
  ToProto(update.add.subject, quad->mutable_subject());
  ToProto(update.add.predicate, quad->mutable_predicate());
  ToProto(update.add.object, quad->mutable_object());
  return request;
}

struct Phase {
  std::vector<double> latencies_us;
  double seconds = 0;
  size_t lost = 0;
};

// Sends `count` updates over one AssertStream. `rate` per second on a fixed schedule (open loop: an update is
// due at its time, whether the earlier ones are done or not); 0: as fast as `in_flight` allows.
Phase Drive(const std::shared_ptr<grpc::Channel>& channel, Reactions* reactions, uint64_t first, size_t count,
            double rate, size_t in_flight, size_t constraints, size_t triples) {
  AssertClient client(channel);
  SteadyClock::time_point start = SteadyClock::now();
  for (size_t n = 0; n < count; ++n) {
    MixedUpdate update = UpdateNumber(first + n, constraints, triples);
    SteadyClock::time_point due = SteadyClock::now();
    if (rate > 0) {
      due =
          start + std::chrono::duration_cast<SteadyClock::duration>(std::chrono::duration<double>(n / rate));
      std::this_thread::sleep_until(due);
    } else {
      reactions->WaitForRoom(in_flight);
      due = SteadyClock::now();
    }
    reactions->Due(update.token, due);
    client.Send(ToRequest(update));
  }
  Phase phase;
  bool all = reactions->WaitForAll(absl::Seconds(20));
  client.Finish();
  SteadyClock::time_point last;
  phase.latencies_us = reactions->Take(&last);
  phase.seconds = std::chrono::duration<double>(last - start).count();
  phase.lost = all ? 0 : count - phase.latencies_us.size();
  return phase;
}

struct Arguments {
  bool json = false;
  size_t triples = 100000;
  size_t constraints = 1000;
  size_t updates = 6000;
  int runs = 3;
  double rate = 0;
  std::string folder = ".";
};

Measurement Figure(const std::string& name, const std::string& system, const std::string& metric,
                   const std::string& unit, std::vector<double> runs) {
  return {"reaction", name, system, metric, unit, std::move(runs), ""};
}

int EndToEnd(const Arguments& arguments, std::vector<Measurement>* figures) {
  const server::OneCallbackThread one_callback_thread;  // as in the server
  Reactions reactions;
  InstantAdapter adapter([&reactions](const v1::InvokeRequest& request) {
    for (const v1::NamedTerm& argument : request.arguments()) {
      reactions.Invoked(argument.value().has_literal() ? argument.value().literal().lexical()
                                                       : argument.value().iri());
    }
  });
  auto server = ServerProcess::Start(arguments.folder);
  if (!server.ok()) {
    std::fprintf(stderr, "docent-bench: %s\n", std::string(server.status().message()).c_str());
    return 2;
  }
  auto channel = grpc::CreateChannel((*server)->grpc_address(), grpc::InsecureChannelCredentials());
  std::fprintf(stderr, "loading %zu triples and deploying %zu workflows ...\n", arguments.triples,
               arguments.constraints);
  grpc::Status prepared = Prepare(channel, adapter.address(), arguments.triples, arguments.constraints);
  if (!prepared.ok()) {
    std::fprintf(stderr, "docent-bench: %s\n", prepared.error_message().c_str());
    return 2;
  }
  uint64_t next = 0;
  auto drive = [&](size_t count, double rate) {
    Phase phase =
        Drive(channel, &reactions, next, count, rate, kInFlight, arguments.constraints, arguments.triples);
    next += count;
    return phase;
  };
  drive(500, 0);  // warm-up
  std::vector<double> saturation, p50, p99;
  size_t lost = 0;
  for (int run = 0; run < arguments.runs; ++run) {
    std::fprintf(stderr, "run %d of %d ...\n", run + 1, arguments.runs);
    Phase full = drive(arguments.updates / 3, 0);
    saturation.push_back(full.latencies_us.size() / full.seconds);
    const double rate = arguments.rate > 0 ? arguments.rate : saturation.back() / 2;
    Phase open = drive(arguments.updates * 2 / 3, rate);
    p50.push_back(Percentile(open.latencies_us, 0.50) / 1000);
    p99.push_back(Percentile(open.latencies_us, 0.99) / 1000);
    lost += full.lost + open.lost;
  }
  const std::string open = arguments.rate > 0 ? absl::StrCat("open loop at ", arguments.rate, "/s")
                                              : "open loop at half saturation";
  std::string name = absl::StrCat("Assert to Invoke, ", arguments.triples, " triples, ",
                                  arguments.constraints, " constraints");
  figures->push_back(Figure(name, "docent", "saturation, 32 in flight", "updates/s", saturation));
  figures->push_back(Figure(name, "docent", "latency p50, " + open, "ms", p50));
  figures->push_back(Figure(name, "docent", "latency p99, " + open, "ms", p99));
  figures->push_back(
      Figure(name, "docent", "updates without an Invoke", "updates", {static_cast<double>(lost)}));
  return lost == 0 ? 0 : 1;
}

}  // namespace

int RunReactionBench(const std::vector<std::string>& args) {
  CLI::App app{"From Assert sent to Invoke received at the adapter, over loopback, durable",
               "docent-bench reaction"};
  Arguments arguments;
  app.add_flag("--json", arguments.json, "One JSON object a line");
  app.add_option("--triples", arguments.triples, "Background triples")->capture_default_str();
  app.add_option("--constraints", arguments.constraints, "Workflows whose conditions wait")
      ->capture_default_str();
  app.add_option("--updates", arguments.updates, "Updates of each run")->capture_default_str();
  app.add_option("--rate", arguments.rate, "Updates a second of the open loop; 0: half of the saturation")
      ->capture_default_str();
  app.add_option("--runs", arguments.runs, "Runs; the median is reported")->capture_default_str();
  app.add_option("--folder", arguments.folder, "Folder of the durable log (its disk is measured)")
      ->capture_default_str();
  if (std::optional<int> code = Parse(&app, args)) return *code;
  if (arguments.runs * arguments.updates + 500 > arguments.triples / 4) {
    std::fprintf(stderr,
                 "docent-bench: %zu triples give %zu different updates; ask for fewer updates or runs\n",
                 arguments.triples, arguments.triples / 4);
    return 2;
  }
  std::vector<Measurement> figures;
  const int code = EndToEnd(arguments, &figures);
  if (code == 2) return code;
  Print(figures, arguments.json);
  return code;
}

}  // namespace docent::bench
