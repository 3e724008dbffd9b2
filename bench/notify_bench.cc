#include "bench/notify_bench.h"

#include <grpcpp/grpcpp.h>

#include <algorithm>
#include <cstdio>
#include <thread>
#include <utility>

#include "absl/strings/str_cat.h"
#include "bench/assert_client.h"
#include "bench/client_cores.h"
#include "bench/command_line.h"
#include "bench/measurement.h"
#include "bench/server_process.h"
#include "bench/subscribers.h"
#include "bench/worlds/constraint_world.h"
#include "docent/v1/context.grpc.pb.h"
#include "docent/v1/ontologies.grpc.pb.h"
#include "graph/rdf/formats/serializer.h"
#include "kb_server/grpc/convert.h"
#include "kb_server/grpc/one_callback_thread.h"

namespace docent::bench {
namespace {

struct Arguments {
  bool json = false;
  size_t triples = 1000000;
  size_t constraints = 10000;
  size_t in_flight = 1000;
  double seconds = 5;  // of each measurement
  double rate = 0;     // updates a second of the open loop; 0: half of the saturation
  int runs = 5;
  std::string folder = ".";
  bool only_streams = false;
};

// Facts without constraints, up to `triples` in total.
std::vector<TermQuad> World(size_t triples, size_t constraints) {
  std::vector<TermQuad> quads = ConstraintBackground(constraints);
  for (size_t i = 0; quads.size() < triples; ++i) {
    quads.push_back({Term::Iri(absl::StrCat("urn:thing:", i / 2)),
                     Term::Iri(i % 2 == 0 ? "urn:bench:knows" : "urn:bench:number"),
                     i % 2 == 0 ? Term::Iri(absl::StrCat("urn:thing:", i * 7919 % triples))
                                : Term::Integer(static_cast<int64_t>(i)),
                     Term()});
  }
  return quads;
}

grpc::Status LoadWorld(const std::shared_ptr<grpc::Channel>& channel, const std::vector<TermQuad>& quads) {
  auto ontologies = v1::Ontologies::NewStub(channel);
  constexpr size_t kChunk = 50000;
  for (size_t from = 0; from < quads.size(); from += kChunk) {
    const std::vector<TermQuad> chunk(
        quads.begin() + static_cast<std::ptrdiff_t>(from),
        quads.begin() + static_cast<std::ptrdiff_t>(std::min(quads.size(), from + kChunk)));
    v1::LoadRequest request;
    request.set_kind(v1::LoadRequest::DATA);
    request.set_media_type("application/n-triples");
    request.set_text(*SerializeRdf(chunk, RdfFormat::kNTriples));
    v1::LoadReply reply;
    grpc::ClientContext context;
    grpc::Status status = ontologies->Load(&context, request, &reply);
    if (!status.ok()) return status;
  }
  return grpc::Status::OK;
}

struct Phase {
  double rate = 0;  // updates a second, until the last notification
  std::vector<double> latencies_us;
  size_t lost = 0;
  size_t wrong = 0;
};

// Sends updates over one stream, `batch` in each request.
class Teller {
 public:
  Teller(const std::shared_ptr<grpc::Channel>& channel, const Arguments& arguments)
      : channel_(channel), arguments_(arguments), updates_(arguments.constraints, 1) {}

  // `rate` updates a second on a fixed schedule (open loop); 0: as fast as in_flight allows.
  Phase Run(Subscribers& subscribers, double rate, size_t batch) {
    AssertClient client(channel_);
    const SteadyClock::time_point start = SteadyClock::now();
    size_t told = 0;
    while (true) {
      SteadyClock::time_point due = SteadyClock::now();
      if (rate > 0) {
        due = start + std::chrono::duration_cast<SteadyClock::duration>(
                          std::chrono::duration<double>(static_cast<double>(told) / rate));
        std::this_thread::sleep_until(due);
      } else if (subscribers.WaitForFewerThan(arguments_.in_flight, absl::Seconds(10))) {
        due = SteadyClock::now();
      }
      if (std::chrono::duration<double>(due - start).count() > arguments_.seconds) break;
      client.Send(NextRequest(subscribers, batch, due));
      told += batch;
    }
    subscribers.WaitForFewerThan(1, absl::Seconds(20));
    client.Finish();
    Subscribers::Result result = subscribers.Take();
    const double seconds = std::chrono::duration<double>(result.last - start).count();
    return {static_cast<double>(result.latencies_us.size()) / seconds, std::move(result.latencies_us),
            result.lost, result.wrong};
  }

 private:
  v1::AssertRequest NextRequest(Subscribers& subscribers, size_t batch, SteadyClock::time_point due) {
    v1::AssertRequest request;
    updates_.NewBatch();
    std::vector<Subscribers::Flip> flips;
    for (size_t i = 0; i < batch; ++i) {
      const ConditionUpdates::Update update = updates_.Next();
      v1::Quad* quad = update.add ? request.add_add() : request.add_remove();
      ToProto(update.fact.subject, quad->mutable_subject());
      ToProto(update.fact.predicate, quad->mutable_predicate());
      ToProto(update.fact.object, quad->mutable_object());
      flips.push_back(
          {update.constraint, update.shape == ConstraintShape::kNegated ? !update.add : update.add});
    }
    subscribers.Expect(flips, due);
    return request;
  }

  const std::shared_ptr<grpc::Channel> channel_;
  const Arguments& arguments_;
  ConditionUpdates updates_;
};

// False: some subscriptions have no answer. `met`: the targets, over SubscribeStream.
bool MeasureStreams(const Arguments& arguments, Streams streams, const ServerProcess& server, Teller& teller,
                    std::vector<Measurement>* figures, bool* met) {
  const bool many = streams == Streams::kOneAConnection;
  std::fprintf(stderr, "subscribing to %zu constraints, %s ...\n", arguments.constraints,
               many ? "on one stream a connection" : "each on a stream of its own");
  Subscribers subscribers(server.grpc_address(), arguments.constraints, streams);
  if (!subscribers.ready()) return false;
  std::vector<double> saturation, p50, p99, single, cpu_us;
  size_t lost = 0, wrong = 0;
  const auto count = [&](const Phase& phase) {
    lost += phase.lost;
    wrong += phase.wrong;
  };
  for (int run = 0; run < arguments.runs; ++run) {
    std::fprintf(stderr, "run %d of %d ...\n", run + 1, arguments.runs);
    const double cpu_before = server.CpuSeconds();
    const Phase full = teller.Run(subscribers, 0, 10);
    saturation.push_back(full.rate);
    cpu_us.push_back((server.CpuSeconds() - cpu_before) / static_cast<double>(full.latencies_us.size()) *
                     1e6);
    const Phase half = teller.Run(subscribers, arguments.rate > 0 ? arguments.rate : full.rate / 2, 10);
    p50.push_back(Percentile(half.latencies_us, 0.5) / 1000);
    p99.push_back(Percentile(half.latencies_us, 0.99) / 1000);
    const Phase alone = teller.Run(subscribers, 0, 1);
    single.push_back(alone.rate);
    for (const Phase* phase : {&full, &half, &alone}) count(*phase);
  }
  const std::string name = absl::StrCat("Assert to notification, ", arguments.triples, " triples, ",
                                        arguments.constraints, " subscriptions");
  const auto add = [&](const std::string& metric, const std::string& unit, std::vector<double> runs) {
    figures->push_back(
        {"notify", name, many ? "SubscribeStream" : "Subscribe", metric, unit, std::move(runs), ""});
  };
  add("saturation, batches of 10", "updates/s", saturation);
  add("CPU time of the server at saturation", "us an update", cpu_us);
  const std::string load =
      arguments.rate > 0 ? absl::StrCat(arguments.rate, " updates/s") : std::string("half saturation");
  add(absl::StrCat("latency p50, open loop at ", load), "ms", p50);
  add(absl::StrCat("latency p99, open loop at ", load), "ms", p99);
  add("batches of 1, one after the other without a pause", "updates/s", single);
  add("notifications lost", "", {static_cast<double>(lost)});
  add("notifications out of order or too many", "", {static_cast<double>(wrong)});
  if (many) *met = *met && Median(saturation) >= 20000 && Median(p99) < 5;
  *met = *met && lost == 0 && wrong == 0;
  return true;
}

int Measure(const Arguments& arguments, std::vector<Measurement>* figures) {
  auto server = ServerProcess::Start(arguments.folder);
  if (!server.ok()) {
    std::fprintf(stderr, "docent-bench: %s\n", std::string(server.status().message()).c_str());
    return 2;
  }
  KeepToUpperHalfOfCores();
  const server::OneCallbackThread one_callback_thread;  // as in the server
  auto channel = grpc::CreateChannel((*server)->grpc_address(), grpc::InsecureChannelCredentials());
  std::fprintf(stderr, "loading %zu triples ...\n", arguments.triples);
  const grpc::Status loaded = LoadWorld(channel, World(arguments.triples, arguments.constraints));
  if (!loaded.ok()) {
    std::fprintf(stderr, "docent-bench: %s\n", loaded.error_message().c_str());
    return 2;
  }
  Teller teller(channel, arguments);
  bool met = true;
  for (const Streams streams : {Streams::kOneAConnection, Streams::kOneAConstraint}) {
    if (arguments.only_streams && streams == Streams::kOneAConstraint) continue;
    if (!MeasureStreams(arguments, streams, **server, teller, figures, &met)) {
      std::fprintf(stderr, "docent-bench: not all subscriptions have an answer\n");
      return 2;
    }
  }
  return met ? 0 : 1;
}

}  // namespace

int RunNotifyBench(const std::vector<std::string>& args) {
  CLI::App app{"From Assert sent to the notification received, over loopback, durable",
               "docent-bench notify"};
  Arguments arguments;
  app.add_flag("--json", arguments.json, "One JSON object a line");
  app.add_option("--triples", arguments.triples, "Triples in the graph")->capture_default_str();
  app.add_option("--constraints", arguments.constraints, "Subscriptions")
      ->capture_default_str()
      ->check(CLI::Range(96, 20000));
  app.add_option("--in-flight", arguments.in_flight,
                 "Updates whose notification is outstanding, at saturation")
      ->capture_default_str();
  app.add_option("--seconds", arguments.seconds, "Of each measurement")->capture_default_str();
  app.add_option("--rate", arguments.rate, "Updates a second of the open loop; 0: half of the saturation")
      ->capture_default_str();
  app.add_option("--runs", arguments.runs, "Runs; the median is reported")->capture_default_str();
  app.add_option("--folder", arguments.folder, "Folder of the durable log (its disk is measured)")
      ->capture_default_str();
  app.add_flag("--only-streams", arguments.only_streams,
               "Without the part that has a stream for each subscription");
  if (std::optional<int> code = Parse(&app, args)) return *code;
  std::vector<Measurement> figures;
  const int code = Measure(arguments, &figures);
  Print(figures, arguments.json);
  return code;
}

}  // namespace docent::bench
