#include "bench/workflow_bench.h"

#include <chrono>
#include <cstdio>
#include <thread>

#include "absl/container/flat_hash_map.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/synchronization/mutex.h"
#include "bench/assert_client.h"
#include "bench/command_line.h"
#include "bench/instant_robots.h"
#include "bench/measurement.h"
#include "bench/server_process.h"
#include "docent/v1/context.grpc.pb.h"
#include "graph/rdf/vocabulary.h"
#include "kb_server/grpc/convert.h"
#include "kb_server/grpc/one_callback_thread.h"

namespace docent::bench {
namespace {

using SteadyClock = std::chrono::steady_clock;
constexpr int kRobots = 64;         // more than runs in flight, so that none waits for a free robot
constexpr size_t kInFlight = 32;    // runs
constexpr int kNodes = 10;          // of a flow
constexpr size_t kFreed = 2000;     // waiting runs that a fact frees
constexpr double kFreedRate = 200;  // of them a second

struct Arguments {
  bool json = false;
  size_t waiting = 100000;
  size_t runs_of_flows = 3000;
  int runs = 3;
  std::string folder = ".";
};

double MillisSince(SteadyClock::time_point then) {
  return std::chrono::duration<double, std::milli>(SteadyClock::now() - then).count();
}

// The commands that came: how long after what caused them, by the job that their argument names.
class Commands {
 public:
  // Something causes a command of `job` now, or did at `when`.
  void Caused(const std::string& job, SteadyClock::time_point when) {
    absl::MutexLock lock(&mutex_);
    jobs_[job].caused = when;
  }
  void Invoked(const v1::InvokeRequest& request) {
    if (request.arguments().empty()) return;
    const SteadyClock::time_point now = SteadyClock::now();
    absl::MutexLock lock(&mutex_);
    Job& job = jobs_[request.arguments(0).value().iri()];
    (job.commands == 0 ? first_ : next_)
        .push_back(std::chrono::duration<double, std::milli>(now - job.caused).count());
    job.caused = now;  // the adapter's answer goes out now, and causes the next
    ++commands_;
    last_ = now;
    if (++job.commands == of_a_job_) jobs_.erase(request.arguments(0).value().iri());
  }
  // Each job has so many commands.
  void Begin(int of_a_job) {
    absl::MutexLock lock(&mutex_);
    of_a_job_ = of_a_job;
    jobs_.clear();
    first_.clear();
    next_.clear();
    commands_ = 0;
  }
  // Waits until fewer than `limit` jobs are outstanding, or `timeout`.
  bool WaitForRoom(size_t limit, absl::Duration timeout) {
    absl::MutexLock lock(&mutex_);
    auto room = [this, limit]() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) { return jobs_.size() < limit; };
    return mutex_.AwaitWithTimeout(absl::Condition(&room), timeout);
  }

  struct Result {
    std::vector<double> first_ms, next_ms;  // to the first command of a job, and from one to the next
    size_t commands = 0;
    SteadyClock::time_point last;
  };
  Result Take() {
    absl::MutexLock lock(&mutex_);
    return {std::move(first_), std::move(next_), commands_, last_};
  }

 private:
  struct Job {
    SteadyClock::time_point caused;
    int commands = 0;
  };
  absl::Mutex mutex_;
  absl::flat_hash_map<std::string, Job> jobs_ ABSL_GUARDED_BY(mutex_);
  std::vector<double> first_ ABSL_GUARDED_BY(mutex_), next_ ABSL_GUARDED_BY(mutex_);
  int of_a_job_ ABSL_GUARDED_BY(mutex_) = 1;
  size_t commands_ ABSL_GUARDED_BY(mutex_) = 0;
  SteadyClock::time_point last_ ABSL_GUARDED_BY(mutex_);
};

std::string Constraint(const std::string& subject, const std::string& verb, const std::string& object) {
  return absl::StrCat("<context><rule><constraint><subject>", subject, "</subject><verb>", verb,
                      "</verb><object>", object, "</object></constraint></rule></context>");
}

// One run for each job; its node waits for the job's word, then commands a robot.
std::string WaitingFlow() {
  return absl::StrCat(
      "<CAWL name=\"Waiting\" namespace=\"urn:mix:\" version=\"1\" xmlns:m=\"urn:mix:\"><activator "
      "name=\"a\"><activate flow=\"W\"/><condition>",
      Constraint("?job", "a", "m:Job"),
      "</condition></activator><flow name=\"W\"><variable name=\"job\"/><source name=\"s\"/><node "
      "name=\"n\"><condition>",
      Constraint("$job", "m:may", "m:Go"),
      "</condition><invoke operation=\"step\"/></node><sink name=\"t\"/><link from=\"s\" "
      "to=\"n\"/><link from=\"n\" to=\"t\"/></flow></CAWL>");
}

// One run for each task; ten nodes, one after the other.
std::string Chain() {
  std::string text = absl::StrCat(
      "<CAWL name=\"Chain\" namespace=\"urn:mix:\" version=\"1\" xmlns:m=\"urn:mix:\"><activator "
      "name=\"a\"><activate flow=\"C\"/><condition>",
      Constraint("?job", "a", "m:Task"),
      "</condition></activator><flow name=\"C\"><variable name=\"job\"/><source name=\"n0\"/>");
  for (int i = 1; i <= kNodes; ++i)
    absl::StrAppend(&text, "<node name=\"n", i, "\"><invoke operation=\"step\"/></node>");
  absl::StrAppend(&text, "<sink name=\"n", kNodes + 1, "\"/>");
  for (int i = 0; i <= kNodes; ++i) absl::StrAppend(&text, "<link from=\"n", i, "\" to=\"n", i + 1, "\"/>");
  return absl::StrCat(text, "</flow></CAWL>");
}

std::string Job(const std::string& kind, size_t n) {
  return absl::StrCat("urn:mix:", kind, n);
}

v1::AssertRequest Fact(const std::string& subject, const std::string& predicate, const std::string& object) {
  v1::AssertRequest request;
  request.set_source("urn:mix:desk");
  v1::Quad* quad = request.add_add();
  ToProto(Term::Iri(subject), quad->mutable_subject());
  ToProto(Term::Iri(predicate), quad->mutable_predicate());
  ToProto(Term::Iri(object), quad->mutable_object());
  return request;
}

size_t LiveRuns(const std::shared_ptr<grpc::Channel>& channel) {
  v1::QueryRequest request;
  request.set_query("SELECT (COUNT(?run) AS ?n) { ?run docent:runState \"running\" }");
  grpc::ClientContext context;
  auto reader = v1::Context::NewStub(channel)->Query(&context, request);
  v1::QueryReply reply;
  size_t live = 0;
  while (reader->Read(&reply)) {
    if (reply.has_row() && reply.row().values_size() == 1)
      (void)absl::SimpleAtoi(reply.row().values(0).literal().lexical(), &live);
  }
  reader->Finish();
  return live;
}

Measurement Figure(const std::string& name, const std::string& metric, const std::string& unit,
                   std::vector<double> runs) {
  return {"workflow", name, "docent", metric, unit, std::move(runs), ""};
}

// False: something was lost.
bool Waiting(const std::shared_ptr<grpc::Channel>& channel, const ServerProcess& server,
             const Arguments& arguments, Commands* commands, std::vector<Measurement>* figures) {
  const double before = server.ResidentMegabytes();
  std::fprintf(stderr, "starting %zu runs that wait ...\n", arguments.waiting);
  const SteadyClock::time_point start = SteadyClock::now();
  std::vector<TermQuad> jobs;
  for (size_t n = 0; n < arguments.waiting; ++n)
    jobs.push_back(
        {Term::Iri(Job("job", n)), Term::Iri(std::string(kRdfType)), Term::Iri("urn:mix:Job"), Term()});
  constexpr size_t kOfATurn = 1000;
  for (size_t from = 0; from < jobs.size(); from += kOfATurn) {
    const std::vector<TermQuad> part(jobs.begin() + from,
                                     jobs.begin() + std::min(jobs.size(), from + kOfATurn));
    if (grpc::Status status = LoadQuads(channel, part); !status.ok()) {
      std::fprintf(stderr, "docent-bench: %s\n", status.error_message().c_str());
      return false;
    }
  }
  const double seconds = MillisSince(start) / 1000;
  const size_t live = LiveRuns(channel);
  const double resident = server.ResidentMegabytes();
  const std::string name = absl::StrCat(arguments.waiting, " runs that wait");
  figures->push_back(Figure(name, "live", "runs", {static_cast<double>(live)}));
  figures->push_back(Figure(name, "started", "runs/s", {static_cast<double>(live) / seconds}));
  figures->push_back(Figure(name, "memory of the server", "MB", {resident}));
  figures->push_back(Figure(name, "of a run", "KB",
                            {(resident - before) * 1024 / std::max<double>(1, static_cast<double>(live))}));

  commands->Begin(1);
  AssertClient client(channel);
  const SteadyClock::time_point freeing = SteadyClock::now();
  const size_t freed = std::min(kFreed, arguments.waiting);
  for (size_t n = 0; n < freed; ++n) {
    // spread over all of them, on a fixed schedule
    const std::string job = Job("job", n * (arguments.waiting / freed));
    const auto due = freeing + std::chrono::duration_cast<SteadyClock::duration>(
                                   std::chrono::duration<double>(static_cast<double>(n) / kFreedRate));
    std::this_thread::sleep_until(due);
    commands->Caused(job, due);
    client.Send(Fact(job, "urn:mix:may", "urn:mix:Go"));
  }
  const bool all = commands->WaitForRoom(1, absl::Seconds(20));
  client.Finish();
  const Commands::Result result = commands->Take();
  const std::string at = absl::StrCat(", ", kFreedRate, " a second");
  figures->push_back(Figure(name, "fact to command p50" + at, "ms", {Percentile(result.first_ms, 0.5)}));
  figures->push_back(Figure(name, "fact to command p99" + at, "ms", {Percentile(result.first_ms, 0.99)}));
  figures->push_back(
      Figure(name, "freed without a command", "runs", {static_cast<double>(freed - result.commands)}));
  return all && live == arguments.waiting;
}

// `count` flows, `rate` a second on a fixed schedule; 0: as fast as kInFlight allows.
Commands::Result Flows(const std::shared_ptr<grpc::Channel>& channel, Commands* commands, size_t first,
                       size_t count, double rate, double* seconds) {
  commands->Begin(kNodes);
  AssertClient client(channel);
  const SteadyClock::time_point start = SteadyClock::now();
  for (size_t n = 0; n < count; ++n) {
    if (rate > 0) {
      std::this_thread::sleep_until(start +
                                    std::chrono::duration_cast<SteadyClock::duration>(
                                        std::chrono::duration<double>(static_cast<double>(n) / rate)));
    } else {
      commands->WaitForRoom(kInFlight, absl::Seconds(20));
    }
    const std::string job = Job("task", first + n);
    commands->Caused(job, SteadyClock::now());
    client.Send(Fact(job, std::string(kRdfType), "urn:mix:Task"));
  }
  commands->WaitForRoom(1, absl::Seconds(20));
  client.Finish();
  Commands::Result result = commands->Take();
  *seconds = std::chrono::duration<double>(result.last - start).count();
  return result;
}

bool Nodes(const std::shared_ptr<grpc::Channel>& channel, const Arguments& arguments, Commands* commands,
           std::vector<Measurement>* figures) {
  size_t next = 0, lost = 0;
  std::vector<double> throughput, p50, p99, full_p99;
  for (int run = 0; run <= arguments.runs; ++run) {  // the first is a warm-up
    std::fprintf(stderr, "flows, run %d of %d ...\n", run, arguments.runs);
    const size_t count = run == 0 ? arguments.runs_of_flows / 4 : arguments.runs_of_flows;
    double seconds = 0;
    const Commands::Result full = Flows(channel, commands, next, count, 0, &seconds);
    next += count;
    lost += count * kNodes - full.commands;
    if (run == 0) continue;
    throughput.push_back(static_cast<double>(full.commands) / seconds);
    full_p99.push_back(Percentile(full.next_ms, 0.99));
    const Commands::Result half =
        Flows(channel, commands, next, count, throughput.back() / kNodes / 2, &seconds);
    next += count;
    lost += count * kNodes - half.commands;
    p50.push_back(Percentile(half.next_ms, 0.5));
    p99.push_back(Percentile(half.next_ms, 0.99));
  }
  const std::string name = absl::StrCat("flows of ", kNodes, " nodes, a command each");
  figures->push_back(
      Figure(name, absl::StrCat("completed, ", kInFlight, " flows in flight"), "nodes/s", throughput));
  figures->push_back(Figure(name, "hand-over p99, the same", "ms", full_p99));
  figures->push_back(Figure(name, "hand-over p50, at half of it", "ms", p50));
  figures->push_back(Figure(name, "hand-over p99, at half of it", "ms", p99));
  figures->push_back(Figure(name, "lost", "nodes", {static_cast<double>(lost)}));
  return lost == 0;
}

int Run(const Arguments& arguments, std::vector<Measurement>* figures) {
  const server::OneCallbackThread one_callback_thread;  // as in the server
  Commands commands;
  InstantAdapter adapter([&commands](const v1::InvokeRequest& request) { commands.Invoked(request); });
  auto server = ServerProcess::Start(arguments.folder);
  if (!server.ok()) {
    std::fprintf(stderr, "docent-bench: %s\n", std::string(server.status().message()).c_str());
    return 2;
  }
  auto channel = grpc::CreateChannel((*server)->grpc_address(), grpc::InsecureChannelCredentials());
  grpc::Status status = LoadQuads(channel, InstantRobots(kRobots, adapter.address(), {{"step", "job"}}));
  for (const auto& [name, text] : {std::pair("Chain", Chain()), std::pair("Waiting", WaitingFlow())}) {
    if (status.ok()) status = Deploy(channel, name, text);
  }
  if (!status.ok()) {
    std::fprintf(stderr, "docent-bench: %s\n", status.error_message().c_str());
    return 2;
  }
  const bool nodes = Nodes(channel, arguments, &commands, figures);
  const bool waiting = Waiting(channel, **server, arguments, &commands, figures);
  return nodes && waiting ? 0 : 1;
}

}  // namespace

int RunWorkflowBench(const std::vector<std::string>& args) {
  CLI::App app{"Runs that wait and nodes that are completed, over loopback, durable",
               "docent-bench workflow"};
  Arguments arguments;
  app.add_flag("--json", arguments.json, "One JSON object a line");
  app.add_option("--waiting", arguments.waiting, "Runs that wait")->capture_default_str();
  app.add_option("--flows", arguments.runs_of_flows, "Flows of each run")->capture_default_str();
  app.add_option("--runs", arguments.runs, "Runs of the flows; the median is reported")
      ->capture_default_str();
  app.add_option("--folder", arguments.folder, "Folder of the durable log (its disk is measured)")
      ->capture_default_str();
  if (std::optional<int> code = Parse(&app, args)) return *code;
  std::vector<Measurement> figures;
  const int code = Run(arguments, &figures);
  if (code == 2) return code;
  Print(figures, arguments.json);
  return code;
}

}  // namespace docent::bench
