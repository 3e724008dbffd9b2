#include "kb_server/replay/case_recorder.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/time/time.h"
#include "graph/base/text.h"
#include "graph/log/record_codec.h"
#include "graph/rdf/date_time.h"
#include "graph/rdf/docent_iris.h"
#include "graph/rdf/vocabulary.h"
#include "graph/store/graph_reader.h"
#include "kb_server/door/request_memory.h"
#include "kb_server/replay/recording.h"
#include "kb_server/replay/run_course.h"
#include "kb_server/replay/run_tree.h"
#include "kb_server/replay/world_facts.h"
#include "kb_server/writer/recovery.h"
#include "kb_server/writer/server_state.h"
#include "workflow/engine/engine_state.h"

namespace docent::server {
namespace {

constexpr TimeMicros kMillisecond = 1000;  // what times of runs in the graph are rounded to
constexpr size_t kRecordsRead = 256;       // of the log at a time

std::string Show(TimeMicros time_us) {
  return absl::FormatTime("%Y-%m-%dT%H:%M:%E*SZ", absl::FromUnixMicros(time_us), absl::UTCTimeZone());
}

bool Begins(const log::TurnRecord& record, const RunId& run) {
  return std::any_of(record.transitions.begin(), record.transitions.end(),
                     [&run](const Transition& t) { return t.subject == run.value() && t.from.empty(); });
}

bool Ends(const log::TurnRecord& record, const RunId& run) {
  return std::any_of(record.transitions.begin(), record.transitions.end(), [&run](const Transition& t) {
    return t.subject == run.value() && (t.to == "done" || t.to == "failed" || t.to == "cancelled");
  });
}

// Without the requests of clients that are remembered: they decide nothing.
absl::StatusOr<std::string> EncodedState(Stages* stages, uint64_t offset, TimeMicros time_us) {
  const ServerState state =
      TakeState(*stages, RequestMemory(0), stages->writer.Freeze(Revision(offset)), time_us);
  return EncodeState(state, stages->dictionary);
}

}  // namespace

absl::StatusOr<KnownRun> FindRun(const Dictionary& dictionary, const GraphVersion& newest, const RunId& run,
                                 const Limits& limits) {
  const GraphReader graph(dictionary, newest);
  const std::string iri = RunIri(run);
  KnownRun known;
  known.run = run;
  known.workflow = graph.Object(iri, DocentIri("workflow"));
  known.flow = graph.Object(iri, DocentIri("flow"));
  known.started_us = MicrosOfDateTime(graph.Object(iri, Concat(kProvNs, "startedAtTime")));
  known.ended_us = MicrosOfDateTime(graph.Object(iri, Concat(kProvNs, "endedAtTime")));
  if (const auto parent = RunOfIri(graph.Object(iri, DocentIri("parentRun")))) known.parent = parent->value();
  if (known.started_us != 0 && !known.flow.empty()) return known;
  return absl::NotFoundError(absl::StrCat(
      "there is no run \"", run.value(), "\", or no longer: of the runs that have ended the newest ",
      limits.runs_kept, " are kept (runs_kept); `docent runs` lists them"));
}

absl::Status CaseRecorder::NoLongerKept(const std::string& what) {
  const absl::StatusOr<uint64_t> first = ports_.log->First();
  const absl::StatusOr<std::vector<uint64_t>> snapshots = ports_.log->SnapshotOffsets();
  if (!first.ok() || !snapshots.ok()) return first.ok() ? snapshots.status() : first.status();
  const auto base = std::lower_bound(snapshots->begin(), snapshots->end(), *first - 1);
  const uint64_t oldest = base == snapshots->end() ? *first : *base + 1;
  return absl::OutOfRangeError(
      absl::StrCat(what, ", of which the log is no longer kept; the oldest turn that can be replayed is ",
                   oldest, " (`docent serve --log-bytes-kept` sets how much is kept)"));
}

absl::StatusOr<uint64_t> CaseRecorder::FirstAtOrAfter(TimeMicros time_us, uint64_t newest) {
  const absl::StatusOr<uint64_t> first = ports_.log->First();
  if (!first.ok()) return first.status();
  uint64_t low = *first, high = newest + 1;  // times never decrease
  while (low < high) {
    if (absl::Status status = ports_.cancellation->CheckNow(); !status.ok()) return status;
    const uint64_t middle = low + (high - low) / 2;
    const auto entries = ports_.log->Read(middle, 1);
    if (!entries.ok()) return entries.status();
    if (entries->empty())
      return absl::DataLossError(absl::StrCat("the log has no record at offset ", middle));
    const auto record = log::DecodeTurnRecord(middle, entries->front().data);
    if (!record.ok()) return record.status();
    if (record->time_us < time_us)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

absl::StatusOr<std::optional<uint64_t>> CaseRecorder::FindTurn(const RunId& run, TimeMicros time_us,
                                                               bool begins, uint64_t newest) {
  const absl::StatusOr<uint64_t> from = FirstAtOrAfter(time_us - kMillisecond, newest);
  if (!from.ok()) return from.status();
  for (uint64_t next = *from; next <= newest;) {
    if (absl::Status status = ports_.cancellation->CheckNow(); !status.ok()) return status;
    const auto entries = ports_.log->Read(next, std::min<uint64_t>(kRecordsRead, newest - next + 1));
    if (!entries.ok()) return entries.status();
    if (entries->empty()) break;
    for (const log::LogEntry& entry : *entries) {
      const auto record = log::DecodeTurnRecord(entry.offset, entry.data);
      if (!record.ok()) return record.status();
      if (record->time_us > time_us + kMillisecond) return std::optional<uint64_t>();
      if (begins ? Begins(*record, run) : Ends(*record, run)) return std::optional<uint64_t>(entry.offset);
    }
    next += entries->size();
  }
  return std::optional<uint64_t>();
}

absl::StatusOr<CaseRecorder::Life> CaseRecorder::FindLife(const KnownRun& run, uint64_t newest) {
  Life life{0, newest};
  const auto first = FindTurn(run.run, run.started_us, true, newest);
  if (!first.ok()) return first.status();
  if (!*first) return NoLongerKept(absl::StrCat("run ", run.run.value(), " began at ", Show(run.started_us)));
  life.first = **first;
  if (run.ended_us == 0) return life;
  const auto last = FindTurn(run.run, run.ended_us, false, newest);
  if (!last.ok()) return last.status();
  if (*last) life.last = **last;
  return life;
}

absl::Status CaseRecorder::CheckLength(uint64_t from, uint64_t to) const {
  if (to - from < ports_.replay_limits.replay_turns) return absl::OkStatus();
  return absl::ResourceExhaustedError(absl::StrCat("the run lasted from turn ", from, " to turn ", to, ", ",
                                                   to - from + 1, " turns; the limit replay_turns is ",
                                                   ports_.replay_limits.replay_turns));
}

// The stages after the turn `offset`, made again.
absl::StatusOr<RestoredState> CaseRecorder::StagesAfter(uint64_t offset, const std::string& what,
                                                        Dictionary* dictionary) {
  const absl::StatusOr<std::vector<uint64_t>> snapshots = ports_.log->SnapshotOffsets();
  const absl::StatusOr<uint64_t> first = ports_.log->First();
  if (!first.ok() || !snapshots.ok()) return first.ok() ? snapshots.status() : first.status();
  const auto after = std::upper_bound(snapshots->begin(), snapshots->end(), offset);
  const uint64_t base = after == snapshots->begin() ? 0 : *std::prev(after);
  if (base + 1 < *first) return NoLongerKept(what);
  if (offset - base > ports_.limits.as_of_records) {
    return absl::ResourceExhaustedError(
        absl::StrCat(what, ", ", offset - base, " records after the snapshot at ", base,
                     "; the limit as_of_records is ", ports_.limits.as_of_records));
  }
  absl::StatusOr<RestoredState> state =
      FindStart(ports_.log, offset, dictionary, ports_.functions, ports_.limits);
  if (!state.ok()) return state.status();
  const absl::Status replayed = ReplayTurns(ports_.log, state->offset + 1, offset, state->stages.get(),
                                            [this, &state](const TurnResult& result, size_t) {
                                              state->time_us = result.record.time_us;
                                              return ports_.cancellation->CheckNow();
                                            });
  if (!replayed.ok()) return replayed;
  return state;
}

absl::StatusOr<RunCase> CaseRecorder::Record(const KnownRun& run, uint64_t newest) {
  if (!run.parent.empty()) {
    return absl::FailedPreconditionError(absl::StrCat("run ", run.run.value(), " is a sub-flow of run ",
                                                      run.parent,
                                                      "; replay that one, which has its nodes, too"));
  }
  const absl::StatusOr<Life> life = FindLife(run, newest);
  if (!life.ok()) return life.status();
  if (absl::Status fits = CheckLength(life->first, life->last); !fits.ok()) return fits;
  Dictionary dictionary;
  absl::StatusOr<RestoredState> start = StagesAfter(
      life->first - 1, absl::StrCat("run ", run.run.value(), " began in turn ", life->first), &dictionary);
  if (!start.ok()) return start.status();
  Recording recording(run, start->stages.get(), ports_.limits, ports_.replay_limits);
  absl::StatusOr<std::string> state = EncodedState(start->stages.get(), life->first - 1, start->time_us);
  if (!state.ok()) return state.status();
  if (absl::Status begun = recording.Begin(*std::move(state)); !begun.ok()) return begun;
  const absl::Status replayed = ReplayTurns(
      ports_.log, life->first, life->last, start->stages.get(), [&](const TurnResult& result, size_t) {
        if (absl::Status status = ports_.cancellation->CheckNow(); !status.ok()) return status;
        return recording.Take(result);
      });
  if (!replayed.ok()) return replayed;
  return recording.End(life->last);
}

absl::StatusOr<uint64_t> CaseRecorder::MomentOf(const KnownRun& run, const std::string& node,
                                                const Life& life) {
  const std::string subject = absl::StrCat(run.run.value(), "/", IriSegment(node));
  uint64_t opened = 0;
  for (uint64_t next = life.first; next <= life.last;) {
    if (absl::Status status = ports_.cancellation->CheckNow(); !status.ok()) return status;
    const auto entries = ports_.log->Read(next, std::min<uint64_t>(kRecordsRead, life.last - next + 1));
    if (!entries.ok()) return entries.status();
    if (entries->empty()) break;
    for (const log::LogEntry& entry : *entries) {
      const auto record = log::DecodeTurnRecord(entry.offset, entry.data);
      if (!record.ok()) return record.status();
      for (const Transition& t : record->transitions) {
        if (t.subject == subject && t.from != "running" && t.to == "running") opened = entry.offset;
      }
    }
    next += entries->size();
  }
  return opened;
}

absl::StatusOr<RunCase> CaseRecorder::Moment(const KnownRun& run, const std::string& node,
                                             std::optional<uint64_t> at, uint64_t newest) {
  const absl::StatusOr<Life> life = FindLife(run, newest);
  if (!life.ok()) return life.status();
  if (absl::Status fits = CheckLength(life->first, life->last); !fits.ok()) return fits;
  if (at && (*at < life->first || *at > newest)) {
    return absl::OutOfRangeError(absl::StrCat("run ", run.run.value(), " has no state as of turn ", *at,
                                              ": it began in turn ", life->first, ", and the newest turn is ",
                                              newest));
  }
  // Robots are chosen as they were used before the node opened; in its turn the run itself may have taken one.
  uint64_t used_of = at.value_or(life->last), variables_of = used_of, facts_of = used_of;
  if (!at) {
    const absl::StatusOr<uint64_t> opened = MomentOf(run, node, *life);
    if (!opened.ok()) return opened.status();
    if (*opened != 0)
      facts_of = *opened, used_of = *opened - 1, variables_of = std::max(used_of, life->first);
  }
  Dictionary dictionary;
  absl::StatusOr<RestoredState> start =
      StagesAfter(used_of, absl::StrCat("turn ", variables_of, " is asked for"), &dictionary);
  if (!start.ok()) return start.status();
  Stages* stages = start->stages.get();
  std::map<RobotId, TimeMicros> last_used = stages->engine.Save().last_used;
  TimeMicros time_us = start->time_us;
  const auto replay = [&](uint64_t from, uint64_t to) {
    return ReplayTurns(ports_.log, from, to, stages, [&](const TurnResult& result, size_t) {
      time_us = result.record.time_us;
      return absl::OkStatus();
    });
  };
  if (absl::Status replayed = replay(used_of + 1, variables_of); !replayed.ok()) return replayed;
  std::map<std::string, Term> variables = ReadVariables(dictionary, stages->writer.current(), run.run);
  if (absl::Status replayed = replay(variables_of + 1, facts_of); !replayed.ok()) return replayed;

  RunCase moment;
  moment.last_used = std::move(last_used);
  moment.run = run.run;
  moment.number = NumberOf(run.run);
  moment.workflow = run.workflow;
  moment.flow = run.flow;
  moment.asked = true;
  moment.values.assign(variables.begin(), variables.end());
  moment.documents = DocumentsOf(*stages, run.workflow);
  if (const auto versions = stages->documents.versions().Find({Document::Kind::kCawl, run.workflow})) {
    for (const DocumentVersionPtr& version : versions->kept) {
      if (version->revision.value() > life->first && !moment.document.text.empty()) break;
      moment.document = {Document::Kind::kCawl, Document::Action::kPut, run.workflow, version->text, nullptr};
    }
  }
  const RunTree own(run.run);
  WorldFacts world(stages, &own, ports_.replay_limits);
  WorldFacts all(stages, nullptr, ports_.replay_limits);
  const std::set<Quad> passing = all.Passing();
  auto facts = all.All(passing);
  if (!facts.ok()) return facts.status();
  moment.facts = *std::move(facts);
  moment.lifetimes = all.Lifetimes();
  world.ReadHolds();
  moment.held = world.holds();
  moment.last_turn = facts_of;
  CaseTurn turn;
  turn.offset = facts_of;
  turn.time_us = time_us;
  // An event counts where it is told while the node waits: after the node is entered.
  CaseTurn told = turn;
  told.batch.mode = WriteBatch::Mode::kLoad;
  told.batch.operations = all.Telling(passing);
  moment.turns.push_back(std::move(turn));
  if (!told.batch.operations.empty()) moment.turns.push_back(std::move(told));
  return moment;
}

absl::StatusOr<RunCase> CaseRecorder::World(const std::string& workflow, uint64_t at) {
  Dictionary dictionary;
  absl::StatusOr<RestoredState> start =
      StagesAfter(at, absl::StrCat("turn ", at, " is asked for"), &dictionary);
  if (!start.ok()) return start.status();
  RunCase world;
  world.number = 1;
  world.workflow = workflow;
  world.asked = true;
  world.documents = DocumentsOf(*start->stages, workflow);
  WorldFacts facts(start->stages.get(), nullptr, ports_.replay_limits);
  auto all = facts.All(facts.Passing());
  if (!all.ok()) return all.status();
  world.facts = *std::move(all);
  world.lifetimes = facts.Lifetimes();
  world.held_since = HeldSinceOf(*start->stages, workflow);
  facts.ReadHolds();
  world.held = facts.holds();
  world.last_used = start->stages->engine.Save().last_used;
  world.last_turn = at;
  CaseTurn first;
  first.offset = at;
  first.time_us = start->time_us;
  world.turns.push_back(std::move(first));
  return world;
}

}  // namespace docent::server
