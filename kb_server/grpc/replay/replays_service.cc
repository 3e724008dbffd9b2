#include "kb_server/grpc/replay/replays_service.h"

#include <chrono>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "kb_server/grpc/convert.h"
#include "kb_server/grpc/replay/replay_proto.h"
#include "kb_server/grpc/unary_reactors.h"
#include "kb_server/replay/case_file.h"

namespace docent::server {

grpc::ServerUnaryReactor* ReplaysService::Work(grpc::CallbackServerContext* context,
                                               std::function<absl::Status(Cancellation*)> work) {
  const int timeout_ms = replays_.timeout_ms();
  auto cancellation = std::make_shared<Cancellation>(std::chrono::milliseconds(timeout_ms));
  auto* reactor = new CancellableReactor(cancellation);
  workers_.Submit({.run =
                       [reactor, cancellation, work = std::move(work), timeout_ms] {
                         absl::Status done = work(cancellation.get());
                         if (absl::IsDeadlineExceeded(done))
                           done = absl::DeadlineExceededError(absl::StrCat(
                               "the replay was stopped at its limit replay_timeout_ms = ", timeout_ms));
                         reactor->Finish(ToGrpc(done));
                       },
                   .refuse =
                       [reactor, timeout_ms](const absl::Status& why) {
                         reactor->Finish(ToGrpc(
                             absl::IsDeadlineExceeded(why)
                                 ? absl::DeadlineExceededError(absl::StrCat(
                                       "it waited for other replays until its limit replay_timeout_ms = ",
                                       timeout_ms, ", and was not begun; try again"))
                                 : why));
                       },
                   .client = ClientOf(*context, ports_.clients),
                   .until = absl::Now() + absl::Milliseconds(timeout_ms),
                   .cancellation = cancellation});
  return reactor;
}

grpc::ServerUnaryReactor* ReplaysService::Replay(grpc::CallbackServerContext* context,
                                                 const v1::ReplayRequest* request, v1::ReplayReply* reply) {
  return Work(context, [this, request, reply](Cancellation* cancellation) -> absl::Status {
    if (absl::Status size = CheckDocumentSize(request->name(), request->cawl(), ports_.limits); !size.ok())
      return size;
    absl::StatusOr<Replayed> replayed = replays_.Replay(
        RunId(request->run()), request->cawl(), request->name(), request->assume_done(), cancellation);
    if (!replayed.ok()) return replayed.status();
    ToProto(*replayed, reply);
    return absl::OkStatus();
  });
}

grpc::ServerUnaryReactor* ReplaysService::TryNode(grpc::CallbackServerContext* context,
                                                  const v1::TryNodeRequest* request,
                                                  v1::TryNodeReply* reply) {
  return Work(context, [this, request, reply](Cancellation* cancellation) -> absl::Status {
    if (absl::Status size = CheckDocumentSize(request->name(), request->cawl(), ports_.limits); !size.ok())
      return size;
    std::optional<uint64_t> turn;
    if (request->turn() != 0) turn = request->turn();
    absl::StatusOr<Trial> trial = replays_.TryNode(RunId(request->run()), request->node(), turn,
                                                   request->cawl(), request->name(), cancellation);
    if (!trial.ok()) return trial.status();
    ToProto(*trial, request->node(), reply);
    return absl::OkStatus();
  });
}

grpc::ServerUnaryReactor* ReplaysService::Simulate(grpc::CallbackServerContext* context,
                                                   const v1::SimulateRequest* request,
                                                   v1::SimulateReply* reply) {
  return Work(context, [this, request, reply](Cancellation* cancellation) -> absl::Status {
    if (absl::Status size = CheckDocumentSize(request->name(), request->cawl(), ports_.limits); !size.ok())
      return size;
    absl::StatusOr<SimulationRequest> wanted = FromProto(*request, ports_.limits);
    if (!wanted.ok()) return wanted.status();
    wanted->now_us = ports_.clock->Now();
    const absl::StatusOr<Simulation> simulation = replays_.Simulate(*wanted, cancellation);
    if (!simulation.ok()) return simulation.status();
    ToProto(*simulation, reply);
    return absl::OkStatus();
  });
}

grpc::ServerUnaryReactor* ReplaysService::Save(grpc::CallbackServerContext* context,
                                               const v1::SaveRunRequest* request, v1::SaveRunReply* reply) {
  return Work(context, [this, request, reply](Cancellation* cancellation) -> absl::Status {
    absl::StatusOr<Replayed> replayed = replays_.Save(RunId(request->run()), cancellation);
    if (!replayed.ok()) return replayed.status();
    for (const std::string& note : replayed->play.notes) reply->add_warnings(note);
    if (replayed->play.notes.empty() && !IsSame(replayed->nodes))
      reply->add_warnings("a replay of the document that ran does not do the same");
    std::string saved = EncodeCase(replayed->recorded);
    if (saved.size() > ports_.limits.grpc_message_bytes) {
      return absl::ResourceExhaustedError(absl::StrCat(
          "the saved run has ", saved.size(), " bytes; the limit of an answer grpc_message_bytes is ",
          ports_.limits.grpc_message_bytes, "; save a shorter run, or one on a smaller graph"));
    }
    reply->set_saved(std::move(saved));
    return absl::OkStatus();
  });
}

}  // namespace docent::server
