#include "kb_server/replay/recording.h"

#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "graph/rdf/docent_iris.h"
#include "graph/rdf/vocabulary.h"
#include "kb_server/replay/run_course.h"
#include "workflow/cawl/ask_compiler.h"

namespace docent::server {
namespace {

// What the activator bound its key variables to, as the run has it.
NamedTerms KeyValues(const cawl::Document& document, const std::map<std::string, Term>& variables,
                     const Limits& limits) {
  NamedTerms values;
  if (!document.activator) return values;
  const auto asks = cawl::CompileCondition(
      document, document.activator->condition, [](const std::string&) { return std::nullopt; }, limits);
  if (!asks.ok()) return values;
  std::set<std::string> keys;
  for (const cawl::CompiledAsk& ask : *asks) {
    for (const std::string& name : cawl::KeyVariables(*document.activator, ask)) keys.insert(name);
  }
  for (const std::string& name : keys) {
    if (const auto value = variables.find(name); value != variables.end()) values.emplace_back(*value);
  }
  return values;
}

// The request of a turn that started the run; null: its activator did.
const RunRequest* StarterOf(const TurnResult& result, const RunId& run) {
  size_t started = 0;
  for (const RunRequest& request : result.record.batch.run_requests) {
    if (request.kind != RunRequest::Kind::kStart && request.kind != RunRequest::Kind::kInvokeService)
      continue;
    if (started == result.started.size()) break;
    if (result.started[started++] == run) return &request;
  }
  return nullptr;
}

}  // namespace

// The number at the end of a run's id.
uint64_t NumberOf(const RunId& run) {
  uint64_t number = 0;
  const std::string& id = run.value();
  const size_t dash = id.rfind('-');
  return dash != std::string::npos && absl::SimpleAtoi(id.substr(dash + 1), &number) ? number : 1;
}

Recording::Recording(const KnownRun& run, const Stages* stages, const Limits& limits,
                     const ReplayLimits& replay_limits)
    : known_(run), stages_(*stages), limits_(limits), replay_limits_(replay_limits), tree_(run.run) {}

absl::Status Recording::Count(size_t facts) {
  counted_ += facts;
  if (counted_ <= replay_limits_.replay_facts) return absl::OkStatus();
  return absl::ResourceExhaustedError(
      absl::StrCat("the graph before the run and the changes in its life have more than ",
                   replay_limits_.replay_facts, " facts; the limit is replay_facts"));
}

absl::Status Recording::Begin(std::string state) {
  case_.run = known_.run;
  case_.number = NumberOf(known_.run);
  case_.workflow = known_.workflow;
  case_.flow = known_.flow;
  case_.ended = known_.ended_us != 0;
  case_.state = std::move(state);
  return Count(stages_.writer.current().size());
}

// What the turn changed in which times are asked for.
void Recording::TakeTimes(const Delta& delta, CaseTurn* turn) {
  const std::optional<TermId> type = stages_.dictionary.FindIri(kRdfType),
                              trigger = stages_.dictionary.FindIri(DocentIri("TimeTrigger"));
  if (!type || !trigger) return;
  std::set<TermId> changed;
  for (const std::vector<Quad>* quads : {&delta.added, &delta.removed}) {
    for (const Quad& quad : *quads) {
      if (quad.predicate == *type && quad.object == *trigger) changed.insert(quad.subject);
    }
  }
  for (const TermId time : changed) {
    const bool asked = stages_.writer.current().ContainsMatch({time, *type, *trigger, {}});
    (asked ? turn->asked : turn->asked_no_more).emplace_back(stages_.dictionary.Lexical(time));
  }
}

absl::Status Recording::Take(const TurnResult& result) {
  tree_.Observe(result);
  CaseTurn turn;
  turn.offset = result.record.offset;
  turn.time_us = result.record.time_us;
  turn.batch = result.record.batch;
  turn.batch.request_id.clear();
  turn.batch.request_digest = 0;
  for (Document& document : turn.batch.documents) document.parsed.reset();
  turn.due_us = stages_.NextDeadline();
  TakeTimes(result.delta, &turn);
  if (absl::Status counted = Count(turn.batch.operations.size() + turn.batch.readings.size()); !counted.ok())
    return counted;
  AddDecisions(result, turn.offset, tree_, &case_.course.decisions);
  if (case_.turns.empty()) {
    if (absl::Status known = TakeStart(result); !known.ok()) return known;
  }
  case_.turns.push_back(std::move(turn));
  return absl::OkStatus();
}

RunCase Recording::End(uint64_t last_turn) {
  case_.last_turn = last_turn;
  for (const auto& [run, path] : tree_.nested()) case_.nested.emplace(run, path);
  ReadEnd(stages_.dictionary, stages_.writer.current(), known_.run, &case_.course);
  return std::move(case_);
}

// The document that the run began with, and what began it.
absl::Status Recording::TakeStart(const TurnResult& result) {
  const cawl::DocumentPtr document = stages_.engine.FindWorkflow(known_.workflow);
  if (document == nullptr) {
    return absl::FailedPreconditionError(
        absl::StrCat("run ", known_.run.value(), " is of no workflow that was deployed: it ran ",
                     known_.workflow, "; only runs of workflows are replayed"));
  }
  case_.document = {Document::Kind::kCawl, Document::Action::kPut, document->file, document->source, nullptr};
  if (const RunRequest* request = StarterOf(result, known_.run)) {
    case_.asked = true;
    case_.values = request->arguments;
  } else {
    case_.values = KeyValues(
        *document, ReadVariables(stages_.dictionary, stages_.writer.current(), known_.run), limits_);
  }
  return absl::OkStatus();
}

}  // namespace docent::server
