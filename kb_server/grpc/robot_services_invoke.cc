// RobotServices.Invoke: runs a robot service and follows it for the client.
#include <cmath>
#include <optional>
#include <set>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "graph/base/cut_text.h"
#include "graph/base/text.h"
#include "graph/base/text_limits.h"
#include "graph/rdf/docent_iris.h"
#include "graph/rdf/vocabulary.h"
#include "graph/store/graph_reader.h"
#include "graph/wire/text_cut.h"
#include "kb_server/grpc/convert.h"
#include "kb_server/grpc/grpc_services.h"
#include "kb_server/grpc/run_feed_pump.h"
#include "kb_server/grpc/run_reader.h"
#include "kb_server/robots/robot_records.h"
#include "workflow/rsel/type_checks.h"

namespace docent::server {
namespace {

// What a request that started `run` before is answered with if that has ended; nullopt: it is running.
absl::StatusOr<std::optional<v1::InvokeServiceReply>> RecordedEnd(const RunPorts& ports,
                                                                  const std::string& run) {
  GraphVersionPtr version = ports.queries->Newest();
  v1::Run record;
  if (!ReadRun(GraphReader(*ports.dictionary, *version), run, &record)) {
    return absl::NotFoundError(
        absl::StrCat("this request_id was served before: run ", run, ", which the graph no longer has"));
  }
  if (record.state() == "running") return std::nullopt;
  v1::InvokeServiceReply reply;
  reply.set_run(run);
  reply.set_state(record.state());
  reply.set_message(CutText(record.reason(), kTextLimits.listed_text_bytes));
  reply.set_final(true);
  return reply;
}

// The service's outputs that the run has, where it is done: what its results became in the run.
void FillResults(const RunPorts& ports, const std::string& service, v1::InvokeServiceReply* reply) {
  if (!reply->final() || reply->state() != "done") return;
  const rsel::PlanPtr plan = ports.catalog->Get()->services.Find(service);
  const GraphVersionPtr version = ports.queries->Newest();
  v1::Run record;
  if (plan == nullptr || !ReadRun(GraphReader(*ports.dictionary, *version), reply->run(), &record)) return;
  for (const v1::NamedTerm& variable : record.variables()) {
    const bool output = std::any_of(plan->outputs.begin(), plan->outputs.end(),
                                    [&](const auto& part) { return part.first == variable.name(); });
    if (output) *reply->add_results() = variable;
  }
  CutToFit(reply, kTextLimits.shown_text_bytes, kTextLimits.listed_bytes);
}

// Classes that say nothing of what kind a thing is.
bool IsOfLanguage(const std::string& cls) {
  return cls.starts_with(kOwlNs) || cls.starts_with(kRdfsNs) || cls.starts_with(kRdfNs);
}

// Whether the graph has the thing in the class or one below it; also true where it knows no class of the thing.
bool MayBeIn(const GraphReader& graph, const std::string& thing, const std::string& cls) {
  constexpr size_t kMostClasses = 1000;
  std::vector<std::string> classes;
  const auto add = [&](const std::vector<Term>& terms) {
    for (const Term& term : terms) {
      const bool is_new = std::find(classes.begin(), classes.end(), term.lexical) == classes.end();
      if (term.IsIri() && is_new && !IsOfLanguage(term.lexical)) classes.push_back(term.lexical);
    }
  };
  add(graph.Objects(thing, kRdfType));
  for (size_t i = 0; i < classes.size() && classes.size() < kMostClasses; ++i) {
    if (classes[i] == cls) return true;
    add(graph.Objects(classes[i], Concat(kRdfsNs, "subClassOf")));
    add(graph.Objects(classes[i], Concat(kOwlNs, "equivalentClass")));
  }
  return classes.empty();
}

// What the graph knows of the arguments; their values alone are checked by CheckArguments.
absl::Status CheckClasses(const GraphReader& graph, const rsel::Plan& plan, const rsel::PartTypes& types,
                          const rsel::Arguments& arguments) {
  for (const auto& [part, value] : arguments) {
    const auto type = types.find(part);
    if (type == types.end() || rsel::IsDatatype(type->second) || IsOfLanguage(type->second)) continue;
    if (!value.IsIri() || MayBeIn(graph, value.lexical, type->second)) continue;
    std::vector<std::string> classes;
    for (const Term& cls : graph.Objects(value.lexical, kRdfType)) {
      if (!IsOfLanguage(cls.lexical)) classes.push_back(rsel::TypeName(cls.lexical));
    }
    return absl::InvalidArgumentError(
        absl::StrCat("service ", plan.process, " cannot take ", ToDisplay(value), " as ", part,
                     ", which is of ", absl::StrJoin(classes, " and "), ", not of ",
                     rsel::TypeName(type->second), "; it takes ", rsel::PartsText(plan.inputs, types)));
  }
  return absl::OkStatus();
}

absl::Status CheckRobot(const GraphReader& graph, const std::string& robot) {
  if (robot.empty()) return absl::OkStatus();
  const std::vector<std::string> robots = graph.Subjects(kRdfType, Term::Iri(DocentIri("Robot")));
  if (std::find(robots.begin(), robots.end(), robot) != robots.end()) return absl::OkStatus();
  std::vector<std::string> names;
  for (const std::string& known : robots) names.push_back(Concat("<", known, ">"));
  return absl::NotFoundError(
      Concat("there is no robot <", robot, ">; ",
             names.empty() ? "none has joined" : Concat("there are ", absl::StrJoin(names, ", "))));
}

// Whether the service can take these arguments and this robot. What is not registered is left to the writer's turn to say.
absl::Status CheckInvocation(const RunPorts& ports, const v1::InvokeServiceRequest& request,
                             const std::vector<std::pair<std::string, Term>>& arguments) {
  const rsel::PlanPtr plan = ports.catalog->Get()->services.Find(request.name());
  if (plan == nullptr) return absl::OkStatus();
  const GraphVersionPtr version = ports.queries->Newest();
  const GraphReader graph(*ports.dictionary, *version);
  rsel::Arguments given(arguments.begin(), arguments.end());
  // The robot may also be given as an argument, since it is a variable of the run.
  std::string robot = request.robot();
  const auto robot_argument = given.find("robot");
  const bool takes_robot = std::find(plan->inputs.begin(), plan->inputs.end(), "robot") != plan->inputs.end();
  if (takes_robot && !robot.empty()) given.insert_or_assign("robot", Term::Iri(robot));
  if (!takes_robot && robot_argument != given.end()) {
    if (robot.empty()) robot = robot_argument->second.lexical;
    given.erase(robot_argument);
  }
  const rsel::PartTypes types = rsel::TypesOf(*plan, OfferedOperations(*ports.dictionary, *version)).inputs;
  absl::Status status = rsel::CheckArguments(*plan, types, given);
  if (status.ok()) status = CheckClasses(graph, *plan, types, given);
  return status.ok() ? CheckRobot(graph, robot) : status;
}

// How far the one invocation of a service's run is.
struct Progress {
  double done = 0;   // 0..1, of all steps
  std::string step;  // "2/4 moveToBooth"
};

Progress ProgressOf(const GraphReader& graph, const std::string& run, const std::string& service) {
  const std::string invocation = absl::StrCat(RunIri(RunId(run)), "/", IriSegment(service), "/0");
  Progress progress;
  if (!absl::SimpleAtod(graph.Object(invocation, DocentIri("progress")), &progress.done)) progress.done = 0;
  progress.step = graph.Object(invocation, DocentIri("step"));
  return progress;
}

// What a request to invoke a service led to.
struct Invoked {
  std::string run;
  uint64_t first = 0;                           // number of the first event to be told
  std::optional<v1::InvokeServiceReply> ended;  // long ago, so no event will tell it
};

// On the committer's thread, which also fills the feed: what the graph says of the run and what the feed will say fit
// together.
absl::StatusOr<Invoked> ReadOutcome(const RunPorts& ports, const absl::StatusOr<BatchOutcome>& outcome) {
  if (!outcome.ok()) return outcome.status();
  if (outcome->started.empty()) {
    return absl::AlreadyExistsError("this request_id was that of another request; take a new one");
  }
  Invoked invoked{outcome->started.front().value(), ports.feed->Next(), std::nullopt};
  if (outcome->repeated) {
    absl::StatusOr<std::optional<v1::InvokeServiceReply>> end = RecordedEnd(ports, invoked.run);
    if (!end.ok()) return end.status();
    invoked.ended = *std::move(end);
    return invoked;
  }
  const absl::StatusOr<uint64_t> first = ports.feed->FirstAfter(Revision(outcome->offset - 1));
  if (!first.ok()) return first.status();
  invoked.first = *first;
  return invoked;
}

// Follows the run that one request started, for its client.
class InvokeReactor final : public RunFeedPump<v1::InvokeServiceReply> {
 public:
  InvokeReactor(grpc::CallbackServerContext* context, const RunPorts& ports, std::string service)
      : RunFeedPump(context, ports), ports_(ports), service_(std::move(service)) {}

  // Once. From then on events are told.
  void Begin(absl::StatusOr<Invoked> invoked) ABSL_EXCLUSIVE_LOCKS_REQUIRED(link()->mutex) {
    if (!invoked.ok()) return End(ToGrpc(invoked.status()));
    run_ = std::move(invoked->run);
    ended_ = std::move(invoked->ended);
    BeginAt(invoked->first);
  }

 private:
  bool FillNext(v1::InvokeServiceReply* message, grpc::WriteOptions* options) override {
    if (final_) return false;
    if (!ended_) return RunFeedPump::FillNext(message, options) || FillProgress(message);
    *message = *std::move(ended_);
    FillResults(ports_, service_, message);
    if (message->state() == "done") message->set_progress(1);
    final_ = true;
    return true;
  }
  bool Tell(const RunEvent& event, v1::InvokeServiceReply* message) override {
    if (event.run != run_) return false;
    final_ = event.kind == "run" && event.to != "running" && event.to != "paused";
    message->set_run(event.run);
    message->set_step(event.node);
    message->set_state(event.to);
    message->set_message(CutText(event.detail, kTextLimits.listed_text_bytes));
    message->set_final(final_);
    LookAtProgress();
    told_ = final_ && event.to == "done" ? 1 : seen_.done;
    message->set_progress(told_);
    FillResults(ports_, service_, message);
    return true;
  }
  void OnIdle() override {
    if (final_) End(grpc::Status::OK);
  }

  // Between events: how far the robot says that it is, at most one message for a hundredth of the way.
  bool FillProgress(v1::InvokeServiceReply* message) {
    if (run_.empty()) return false;
    LookAtProgress();
    if (seen_.done - told_ < kToldProgress) return false;
    told_ = seen_.done;
    message->set_run(run_);
    message->set_step(seen_.step);
    message->set_state("running");
    message->set_progress(told_);
    return true;
  }
  // What the newest version says; it never goes back.
  void LookAtProgress() {
    const GraphVersionPtr version = ports_.queries->Newest();
    if (version->revision() == looked_at_) return;
    looked_at_ = version->revision();
    Progress now = ProgressOf(GraphReader(*ports_.dictionary, *version).In(kRunsGraph), run_, service_);
    if (now.done > seen_.done) seen_ = std::move(now);
  }

  static constexpr double kToldProgress = 0.01;

  const RunPorts& ports_;
  const std::string service_;
  std::string run_;
  std::optional<v1::InvokeServiceReply> ended_;
  bool final_ = false;  // the last message has been made
  Progress seen_;
  double told_ = 0;
  Revision looked_at_;
};

}  // namespace

grpc::ServerWriteReactor<v1::InvokeServiceReply>* RobotServicesService::Invoke(
    grpc::CallbackServerContext* context, const v1::InvokeServiceRequest* request) {
  auto* reactor = new InvokeReactor(context, ports_, request->name());
  WriteBatch batch;
  batch.request_id = request->request_id();
  batch.request_digest = DigestOf(request->request_id(), *request);
  RunRequest invoke;
  invoke.kind = RunRequest::Kind::kInvokeService;
  invoke.target = request->name();
  auto arguments = FromProto(request->arguments(), "arguments", ports_.limits);
  std::vector<std::pair<std::string, Term>> given;
  if (arguments.ok()) given = *arguments;
  if (arguments.ok() && !request->robot().empty()) {
    const absl::Status robot = CheckRobotIri(request->robot(), "robot", ports_.limits);
    if (robot.ok()) {
      arguments->emplace_back("robot", Term::Iri(request->robot()));
    } else {
      arguments = robot;
    }
  }
  // Until gRPC is done with the call.
  const auto begin = [link = reactor->link()](absl::StatusOr<Invoked> invoked) {
    absl::MutexLock lock(&link->mutex);
    if (link->pump != nullptr) static_cast<InvokeReactor*>(link->pump)->Begin(std::move(invoked));
  };
  absl::Status status = CheckRequestId(request->request_id());
  if (status.ok()) status = arguments.status();
  if (status.ok()) status = CheckInvocation(ports_, *request, given);
  if (!status.ok()) {
    begin(status);
    return reactor;
  }
  invoke.arguments = *std::move(arguments);
  batch.run_requests.push_back(std::move(invoke));
  ports_.inbox->Push(std::move(batch), [this, begin](const absl::StatusOr<BatchOutcome>& outcome) {
    begin(ReadOutcome(ports_, outcome));
  });
  return reactor;
}

}  // namespace docent::server
