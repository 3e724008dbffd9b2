#include "kb_server/replay/recording.h"

#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "kb_server/door/workflow_removal.h"
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

void AddRequests(const TurnResult& result, const RunTree& tree, const std::string& workflow, CaseTurn* turn) {
  using Kind = RunRequest::Kind;
  for (const RunRequest& request : result.record.batch.run_requests) {
    if (request.kind == Kind::kStart || request.kind == Kind::kInvokeService) continue;
    CaseRequest kept{"", request};
    if (request.kind == Kind::kPauseWorkflow || request.kind == Kind::kResumeWorkflow) {
      if (request.target != workflow) continue;
      kept.request.target.clear();
    } else if (request.kind != Kind::kCancelCommands) {
      const std::optional<std::string> path = tree.PathOf(request.target);
      if (!path) continue;
      kept.run = *path;
      kept.request.target.clear();
    }
    turn->requests.push_back(std::move(kept));
  }
}

// A document of another kind, or of another workflow. Where the own one was taken away with its runs, that is as if the run
// had been cancelled.
void AddDocuments(const TurnResult& result, const std::string& workflow, CaseTurn* turn) {
  for (const Document& document : result.record.batch.documents) {
    if (document.kind == Document::Kind::kOntology) continue;
    if (document.kind == Document::Kind::kCawl) {
      const bool removes = document.action == Document::Action::kRemove;
      if (removes && document.name == workflow && document.text == kRemovesRuns) {
        RunRequest cancel;
        cancel.kind = RunRequest::Kind::kCancel;
        cancel.reason = "its workflow was undeployed";
        turn->requests.push_back({"", std::move(cancel)});
      }
      if (removes) continue;
    }
    Document kept = document;
    kept.parsed.reset();
    turn->documents.push_back(std::move(kept));
  }
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
    : known_(run),
      stages_(*stages),
      limits_(limits),
      tree_(run.run, &stages->dictionary),
      world_(stages, &tree_, replay_limits) {}

absl::Status Recording::Begin() {
  case_.run = known_.run;
  case_.number = NumberOf(known_.run);
  case_.workflow = known_.workflow;
  case_.flow = known_.flow;
  case_.ended = known_.ended_us != 0;
  case_.documents = DocumentsOf(stages_, known_.workflow);
  auto facts = world_.All();
  if (!facts.ok()) return facts.status();
  case_.facts = *std::move(facts);
  world_.ReadHolds();
  case_.held = world_.holds();
  return absl::OkStatus();
}

absl::Status Recording::Take(const TurnResult& result) {
  tree_.Observe(result.delta);
  CaseTurn turn;
  turn.offset = result.record.offset;
  turn.time_us = result.record.time_us;
  auto changes = world_.Changes(result.delta);
  if (!changes.ok()) return changes.status();
  turn.changes = *std::move(changes);
  if (world_.UpdateHolds(result.delta)) turn.held = world_.holds();
  for (const CommandReport& report : result.record.batch.reports) {
    if (tree_.PathOf(report.command.value())) turn.reports.push_back(report);
  }
  AddRequests(result, tree_, known_.workflow, &turn);
  AddDocuments(result, known_.workflow, &turn);
  const size_t before = case_.course.decisions.size();
  AddDecisions(result, turn.offset, tree_, &case_.course.decisions);
  const bool first = case_.turns.empty();
  if (first) {
    if (absl::Status known = TakeStart(result); !known.ok()) return known;
  }
  if (first || !turn.empty() || case_.course.decisions.size() > before)
    case_.turns.push_back(std::move(turn));
  return absl::OkStatus();
}

RunCase Recording::End(uint64_t last_turn) {
  case_.last_turn = last_turn;
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
