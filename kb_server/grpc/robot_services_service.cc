// RobotServices: composite robot services (RSEL processes); register, list, invoke and follow.
#include <optional>

#include "absl/strings/str_cat.h"
#include "graph/store/graph_reader.h"
#include "kb_server/door/parsed_document.h"
#include "kb_server/grpc/convert.h"
#include "kb_server/grpc/grpc_services.h"
#include "kb_server/grpc/run_feed_pump.h"
#include "kb_server/grpc/run_reader.h"
#include "kb_server/grpc/unary_reactors.h"
#include "kb_server/robots/robot_records.h"
#include "workflow/rsel/parser.h"

namespace docent::server {
namespace {

void Fill(const std::vector<rsel::OfferedOperation>& offered, const rsel::Plan& plan, v1::RobotService* out) {
  out->set_name(plan.process);
  out->set_document(plan.document);
  out->set_version(plan.version);
  for (const std::string& input : plan.inputs) out->add_inputs(input);
  for (const rsel::PlanStep& step : plan.steps) {
    v1::ServiceStep* service_step = out->add_steps();
    service_step->set_operation(step.operation);
    service_step->set_service(step.service);
  }
  for (const RobotId& robot : rsel::CapableRobots(plan, offered)) out->add_robots(robot.value());
}

// Warnings about what the robots that are here cannot do. What the registry refuses is left to the writer's turn to say.
Diagnostics Feasibility(const RunPorts& ports, const rsel::ParsedRsel& parsed) {
  rsel::ServiceRegistry registry = ports.catalog->Get()->services;
  if (HasErrors(registry.Put(parsed.document))) return {};
  return rsel::CheckFeasibility(*parsed.document, registry,
                                OfferedOperations(*ports.dictionary, *ports.queries->Newest()));
}

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
  reply.set_message(record.reason());
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
    if (!ended_) return RunFeedPump::FillNext(message, options);
    *message = *std::move(ended_);
    FillResults(ports_, service_, message);
    final_ = true;
    return true;
  }
  bool Tell(const RunEvent& event, v1::InvokeServiceReply* message) override {
    if (event.run != run_) return false;
    final_ = event.kind == "run" && event.to != "running" && event.to != "paused";
    message->set_run(event.run);
    message->set_step(event.node);
    message->set_state(event.to);
    message->set_message(event.detail);
    message->set_final(final_);
    FillResults(ports_, service_, message);
    return true;
  }
  void OnIdle() override {
    if (final_) End(grpc::Status::OK);
  }

  const RunPorts& ports_;
  const std::string service_;
  std::string run_;
  std::optional<v1::InvokeServiceReply> ended_;
  bool final_ = false;  // the last message has been made
};

}  // namespace

grpc::ServerUnaryReactor* RobotServicesService::Register(grpc::CallbackServerContext* context,
                                                         const v1::RegisterRequest* request,
                                                         v1::RegisterReply* reply) {
  return OnWorker(
      context->DefaultReactor(), ports_.workers, [this, request, reply](grpc::ServerUnaryReactor* reactor) {
        if (absl::Status size = CheckDocumentSize(request->name(), request->rsel(), ports_.limits);
            !size.ok()) {
          return reactor->Finish(ToGrpc(size));
        }
        rsel::ParsedRsel parsed = rsel::ParseRsel(request->rsel(), request->name(), ports_.limits);
        if (!parsed.ok()) return reactor->Finish(ToGrpc(ToStatus(parsed.diagnostics, request->rsel())));
        for (const Diagnostic& warning : Feasibility(ports_, parsed)) parsed.diagnostics.push_back(warning);
        for (const Diagnostic& diagnostic : parsed.diagnostics) ToProto(diagnostic, reply->add_diagnostics());
        for (const rsel::Process& process : parsed.document->processes)
          reply->add_processes(process.name.value);
        WriteBatch batch;
        batch.documents.push_back({Document::Kind::kRsel, Document::Action::kPut, request->name(),
                                   request->rsel(), std::make_shared<const ParsedDocument>(parsed.document)});
        ports_.inbox->Push(std::move(batch), [reactor, reply](const absl::StatusOr<BatchOutcome>& outcome) {
          if (outcome.ok()) reply->set_revision(outcome->offset);
          reactor->Finish(ToGrpc(outcome.status()));
        });
      });
}

grpc::ServerUnaryReactor* RobotServicesService::List(grpc::CallbackServerContext* context,
                                                     const v1::ListServicesRequest*,
                                                     v1::ListServicesReply* reply) {
  return OnWorker(context->DefaultReactor(), ports_.workers,
                  [this, reply](grpc::ServerUnaryReactor* reactor) {
                    const auto offered = OfferedOperations(*ports_.dictionary, *ports_.queries->Newest());
                    for (const rsel::PlanPtr& plan : ports_.catalog->Get()->services.Plans())
                      Fill(offered, *plan, reply->add_services());
                    reactor->Finish(grpc::Status::OK);
                  });
}

grpc::ServerUnaryReactor* RobotServicesService::Describe(grpc::CallbackServerContext* context,
                                                         const v1::DescribeServiceRequest* request,
                                                         v1::RobotService* reply) {
  rsel::PlanPtr plan = ports_.catalog->Get()->services.Find(request->name());
  if (plan == nullptr) {
    return FinishNow(context,
                     grpc::Status(grpc::StatusCode::NOT_FOUND,
                                  absl::StrCat("no robot service \"", request->name(), "\" is registered")));
  }
  Fill(OfferedOperations(*ports_.dictionary, *ports_.queries->Newest()), *plan, reply);
  return FinishNow(context, grpc::Status::OK);
}

grpc::ServerWriteReactor<v1::InvokeServiceReply>* RobotServicesService::Invoke(
    grpc::CallbackServerContext* context, const v1::InvokeServiceRequest* request) {
  auto* reactor = new InvokeReactor(context, ports_, request->name());
  WriteBatch batch;
  batch.request_id = request->request_id();
  RunRequest invoke;
  invoke.kind = RunRequest::Kind::kInvokeService;
  invoke.target = request->name();
  auto arguments = FromProto(request->arguments(), "arguments", ports_.limits);
  if (arguments.ok() && !request->robot().empty()) {
    v1::Term robot;
    robot.set_iri(request->robot());
    absl::StatusOr<Term> term = FromProto(robot, "robot");
    if (term.ok()) {
      arguments->emplace_back("robot", *std::move(term));
    } else {
      arguments = term.status();
    }
  }
  // Until gRPC is done with the call.
  const auto begin = [link = reactor->link()](absl::StatusOr<Invoked> invoked) {
    absl::MutexLock lock(&link->mutex);
    if (link->pump != nullptr) static_cast<InvokeReactor*>(link->pump)->Begin(std::move(invoked));
  };
  if (!arguments.ok()) {
    begin(arguments.status());
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
