#include "kb_server/replay/run_replays.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "absl/strings/str_cat.h"
#include "graph/rdf/docent_iris.h"
#include "graph/rdf/vocabulary.h"
#include "graph/store/graph_reader.h"
#include "kb_server/replay/played_document.h"

namespace docent::server {
namespace {

// The first thing that a replay of the document that ran does otherwise than it was recorded, for people; empty: nothing.
std::string Unfaithful(const std::vector<NodeComparison>& nodes) {
  if (IsSame(nodes)) return "";
  const Difference& first = nodes.front().differences.front();
  return absl::StrCat(
      "the document that ran does not do the same in a replay either: ",
      nodes.front().node.empty() ? "the run" : nodes.front().node, ", in turn ", first.turn,
      ", recorded: ", first.recorded, "; replayed: ", first.replayed,
      ". Another version of Docent has recorded it, which decided otherwise or kept less of what decides");
}

}  // namespace

absl::StatusOr<Replayed> ReplayCase(RunCase recorded, const std::string& text, const std::string& name,
                                    const PlayOptions& options, const std::vector<Document>& services) {
  Replayed replayed;
  replayed.recorded = std::move(recorded);
  std::optional<RunCase> with_services;
  if (!services.empty()) {
    absl::StatusOr<RunCase> changed = WithServices(replayed.recorded, services, options.limits);
    if (!changed.ok()) return changed.status();
    with_services = *std::move(changed);
  }
  const auto play = [&](const RunCase& world, const std::string& document_text,
                        const std::string& document_name, Play* out,
                        std::vector<NodeComparison>* nodes) -> absl::Status {
    const auto document = ParseWorkflow(document_text, document_name, options.limits);
    if (!document.ok()) return document.status();
    absl::StatusOr<Play> played = PlayCase(world, *document, options);
    if (!played.ok()) return played.status();
    *nodes = Compare(replayed.recorded, **document, *played);
    *out = *std::move(played);
    return absl::OkStatus();
  };
  const Document& own = replayed.recorded.document;
  const bool edited = !text.empty() && text != own.text;
  absl::Status status = play(with_services ? *with_services : replayed.recorded, edited ? text : own.text,
                             edited ? name : own.name, &replayed.play, &replayed.nodes);
  if (!status.ok()) return status;
  if (IsSame(replayed.nodes)) return replayed;
  std::vector<NodeComparison> of_own = replayed.nodes;
  if (edited || with_services) {
    Play again;
    if (status = play(replayed.recorded, own.text, own.name, &again, &of_own); !status.ok()) return status;
  }
  if (std::string note = Unfaithful(of_own); !note.empty()) replayed.play.notes.push_back(std::move(note));
  return replayed;
}

CaseRecorder RunReplays::Recorder(Cancellation* cancellation) const {
  return CaseRecorder({ports_.log, ports_.functions, ports_.limits, ports_.replay_limits, cancellation});
}

PlayOptions RunReplays::Options(bool assume_done, Cancellation* cancellation) const {
  return {ports_.functions, ports_.limits, ports_.replay_limits, cancellation, assume_done};
}

absl::StatusOr<KnownRun> RunReplays::Find(const RunId& run, uint64_t* newest) const {
  const GraphVersionPtr version = ports_.queries->Newest();
  *newest = version->revision().value();
  return FindRun(*ports_.dictionary, *version, run, ports_.limits);
}

absl::StatusOr<Replayed> RunReplays::Replay(const RunId& run, const std::string& text,
                                            const std::string& name, bool assume_done,
                                            Cancellation* cancellation) {
  uint64_t newest = 0;
  const absl::StatusOr<KnownRun> known = Find(run, &newest);
  if (!known.ok()) return known.status();
  if (!text.empty()) {  // before the long part
    if (auto document = ParseWorkflow(text, name, ports_.limits); !document.ok()) return document.status();
  }
  absl::StatusOr<RunCase> recorded = Recorder(cancellation).Record(*known, newest);
  if (!recorded.ok()) return recorded.status();
  return ReplayCase(*std::move(recorded), text, name, Options(assume_done, cancellation));
}

absl::StatusOr<Simulation> RunReplays::Simulate(const SimulationRequest& request,
                                                Cancellation* cancellation) {
  const auto document = ParseWorkflow(request.text, request.name, ports_.limits);
  if (!document.ok()) return document.status();
  std::string flow = request.flow;
  if (flow.empty() && (*document)->activator) flow = (*document)->activator->flow.value;
  if (flow.empty() && !(*document)->flows.empty()) flow = (*document)->flows.front().name.value;
  const uint64_t newest = ports_.queries->Newest()->revision().value();
  if (request.turn && *request.turn > newest) {
    return absl::OutOfRangeError(
        absl::StrCat("turn ", *request.turn, " has not come yet; the newest is ", newest));
  }
  absl::StatusOr<RunCase> world =
      Recorder(cancellation).World((*document)->name.value, request.turn.value_or(newest));
  if (!world.ok()) return world.status();
  world->flow = std::move(flow);
  world->values = request.arguments;
  const auto operations = OperationsOf(**document, world->documents, ports_.limits);
  if (!operations.ok()) return operations.status();
  std::vector<std::string> notes = ReadyRobots(*operations, &*world);
  CaseTurn& first = world->turns.front();
  if (!request.turn) first.time_us = std::max(first.time_us, request.now_us);
  const TimeMicros begin_us = first.time_us;
  std::vector<SimulatedTelling> told = request.told;
  std::stable_sort(told.begin(), told.end(), [](const SimulatedTelling& a, const SimulatedTelling& b) {
    return a.after_us < b.after_us;
  });
  for (SimulatedTelling& telling : told) {
    if (telling.after_us > request.lasting_us) break;
    if (telling.after_us == 0) {  // before the run starts
      std::move(telling.changes.begin(), telling.changes.end(),
                std::back_inserter(world->turns.front().batch.operations));
      continue;
    }
    CaseTurn turn;
    turn.offset = world->turns.back().offset + 1;
    turn.time_us = begin_us + telling.after_us;
    turn.batch.operations = std::move(telling.changes);
    world->turns.push_back(std::move(turn));
  }
  PlayOptions options = Options(false, cancellation);
  options.simulated_until_us = begin_us + request.lasting_us + 1;
  absl::StatusOr<Play> play = PlayCase(*world, *document, options);
  if (!play.ok()) return play.status();
  play->notes.insert(play->notes.begin(), notes.begin(), notes.end());
  return Simulation{*std::move(world), *std::move(play)};
}

absl::StatusOr<Replayed> RunReplays::Save(const RunId& run, Cancellation* cancellation) {
  return Replay(run, "", "", false, cancellation);
}

absl::StatusOr<Trial> RunReplays::TryNode(const RunId& run, const std::string& node,
                                          std::optional<uint64_t> turn, const std::string& text,
                                          const std::string& name, Cancellation* cancellation) {
  uint64_t newest = 0;
  const absl::StatusOr<KnownRun> known = Find(run, &newest);
  if (!known.ok()) return known.status();
  absl::StatusOr<RunCase> moment = Recorder(cancellation).Moment(*known, node, turn, newest);
  if (!moment.ok()) return moment.status();
  const auto document = ParseWorkflow(text.empty() ? moment->document.text : text,
                                      text.empty() ? moment->document.name : name, ports_.limits);
  if (!document.ok()) return document.status();
  if ((*document)->name.value != known->workflow) {
    return absl::InvalidArgumentError(absl::StrCat("the document is of workflow ", (*document)->name.value,
                                                   ", and run ", run.value(), " is of ", known->workflow,
                                                   "; give a document of that workflow"));
  }
  const auto only = OnlyNode(**document, known->flow, node);
  if (!only.ok()) return only.status();
  absl::StatusOr<Play> play = PlayCase(*moment, *only, Options(false, cancellation));
  if (!play.ok()) return play.status();
  return Trial{*std::move(moment), *std::move(play)};
}

}  // namespace docent::server
