// RobotServices: composite robot services (RSEL processes); register, list, invoke and follow.
#include <optional>

#include "absl/strings/str_cat.h"
#include "graph/store/graph_reader.h"
#include "kb_server/door/parsed_document.h"
#include "kb_server/grpc/convert.h"
#include "kb_server/grpc/grpc_services.h"
#include "kb_server/grpc/run_reader.h"
#include "kb_server/grpc/stream_reactor.h"
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
Diagnostics Feasibility(const ServicePorts& ports, const rsel::ParsedRsel& parsed) {
  rsel::ServiceRegistry registry = ports.catalog->Get()->services;
  if (HasErrors(registry.Put(parsed.document))) return {};
  return rsel::CheckFeasibility(*parsed.document, registry,
                                OfferedOperations(*ports.dictionary, *ports.queries->Newest()));
}

// Follows one run for one client. Events may come before the run's id is known; they are kept until then.
class InvokeFollower {
 public:
  explicit InvokeFollower(std::shared_ptr<StreamHandle<v1::InvokeServiceReply>> out) : out_(std::move(out)) {}

  bool OnEvent(const RunEvent& event) {
    absl::MutexLock lock(&mutex_);
    if (ended_) return false;
    if (!run_)
      early_.push_back(event);
    else if (event.run == *run_)
      Forward(event);
    return !ended_;
  }
  // `end`: the run has ended long ago, so no event will tell it.
  void Started(const std::string& run, std::optional<v1::InvokeServiceReply> end) {
    absl::MutexLock lock(&mutex_);
    run_ = run;
    if (end) {
      ended_ = true;
      out_->TryPush(*std::move(end));
      out_->End(grpc::Status::OK);
      return;
    }
    for (const RunEvent& event : early_) {
      if (event.run == run && !ended_) Forward(event);
    }
    early_.clear();
  }
  void Refused(const grpc::Status& status) {
    absl::MutexLock lock(&mutex_);
    ended_ = true;
    out_->End(status);
  }

 private:
  void Forward(const RunEvent& event) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    v1::InvokeServiceReply reply;
    reply.set_run(event.run);
    reply.set_step(event.node);
    reply.set_state(event.to);
    reply.set_message(event.detail);
    bool final = event.kind == "run" && event.to != "running";
    reply.set_final(final);
    const bool kept_up = out_->TryPush(std::move(reply));
    if (kept_up && !final) return;
    ended_ = true;
    out_->End(kept_up ? grpc::Status::OK
                      : grpc::Status(grpc::StatusCode::RESOURCE_EXHAUSTED,
                                     absl::StrCat("too slow: more events of run ", event.run,
                                                  " wait than the limits stream_messages and stream_bytes "
                                                  "allow; the run goes on")));
  }

  std::shared_ptr<StreamHandle<v1::InvokeServiceReply>> out_;
  absl::Mutex mutex_;
  std::optional<std::string> run_ ABSL_GUARDED_BY(mutex_);
  std::vector<RunEvent> early_ ABSL_GUARDED_BY(mutex_);
  bool ended_ ABSL_GUARDED_BY(mutex_) = false;
};

// What a request that started `run` before is answered with if that has ended; nullopt: it is running.
absl::StatusOr<std::optional<v1::InvokeServiceReply>> RecordedEnd(const ServicePorts& ports,
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
  auto* reactor = new StreamReactor<v1::InvokeServiceReply>(context, ports_.limits, ports_.send_budget);
  auto handle = reactor->handle();
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
  if (!arguments.ok()) {
    handle->End(ToGrpc(arguments.status()));
    return reactor;
  }
  invoke.arguments = *std::move(arguments);
  batch.run_requests.push_back(std::move(invoke));
  auto follower = std::make_shared<InvokeFollower>(handle);
  uint64_t id =
      ports_.feed->Subscribe([follower](const RunEvent& event) { return follower->OnEvent(event); });
  handle->OnGone([feed = ports_.feed, id] { feed->Unsubscribe(id); });
  // The answer comes on the committer thread, as the events do: what the graph says of the run and what the
  // feed will say fit together.
  ports_.inbox->Push(std::move(batch), [this, follower](const absl::StatusOr<BatchOutcome>& outcome) {
    if (!outcome.ok()) return follower->Refused(ToGrpc(outcome.status()));
    if (outcome->started.empty()) {
      return follower->Refused(grpc::Status(grpc::StatusCode::ALREADY_EXISTS,
                                            "this request_id was that of another request; take a new one"));
    }
    const std::string run = outcome->started.front().value();
    if (!outcome->repeated) return follower->Started(run, std::nullopt);
    auto end = RecordedEnd(ports_, run);
    if (!end.ok()) return follower->Refused(ToGrpc(end.status()));
    follower->Started(run, *std::move(end));
  });
  return reactor;
}

}  // namespace docent::server
