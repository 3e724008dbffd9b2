#include "kb_server/replay/play_stages.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "graph/base/overload.h"
#include "graph/rdf/date_time.h"
#include "graph/rdf/vocabulary.h"
#include "graph/store/server_graphs.h"
#include "kb_server/door/parsed_document.h"
#include "kb_server/replay/played_document.h"
#include "kb_server/writer/server_state.h"
#include "workflow/engine/engine_state.h"

namespace docent::server {
namespace {

constexpr size_t kFactsOfTurn = 20000;  // of those before the run

}  // namespace

absl::Status PlayStages::SetUp() {
  if (recorded_.turns.empty()) return absl::InvalidArgumentError("the recorded run has no turns");
  stages_.reset();
  dictionary_ = std::make_unique<Dictionary>();
  return recorded_.state.empty() ? SetUpWorld() : SetUpState();
}

absl::Status PlayStages::SetUpState() {
  absl::StatusOr<RestoredState> restored =
      DecodeState(recorded_.state, dictionary_.get(), options_.functions, options_.limits);
  if (!restored.ok())
    return WithMessage(restored.status(),
                       absl::StrCat("the state before the run: ", restored.status().message()));
  stages_ = std::move(restored->stages);
  stages_->freezes = false;
  stages_->cancellation = options_.cancellation;
  std::vector<const Document*> documents;
  for (const Document& document : recorded_.documents) documents.push_back(&document);
  return PutDocuments(std::move(documents));
}

absl::Status PlayStages::SetUpWorld() {
  stages_ = std::make_unique<Stages>(dictionary_.get(), options_.functions, options_.limits);
  stages_->freezes = false;
  stages_->cancellation = options_.cancellation;
  engine::EngineState state;
  state.next_run = recorded_.number;
  state.last_used = recorded_.last_used;
  stages_->engine.Restore(std::move(state));
  std::vector<Quad> used;  // as the engine tells it, which has it already: no batch may write it
  for (const auto& [robot, time_us] : recorded_.last_used)
    used.push_back({dictionary_->InternIri(robot.value()), dictionary_->InternIri(DocentIri("lastUsed")),
                    dictionary_->Intern(DateTimeTerm(time_us)), dictionary_->InternIri(kRunsGraph)});
  stages_->writer.AddAll(std::move(used));
  stages_->Commit();
  std::vector<const Document*> rules, others;
  for (const Document& document : recorded_.documents) {
    if (document.kind == Document::Kind::kCawl && document.name == document_.name.value) continue;
    (document.kind == Document::Kind::kRules ? rules : others).push_back(&document);
  }
  if (absl::Status put = PutDocuments(rules); !put.ok()) return put;
  for (const bool modules : {true, false}) {  // ontologies first: rules follow the schema
    if (absl::Status loaded = Load(modules); !loaded.ok()) return loaded;
  }
  RestoreLifetimes();
  if (absl::Status put = PutDocuments(others); !put.ok()) return put;
  WriteBatch own;
  own.documents.push_back({Document::Kind::kCawl, Document::Action::kPut, document_.name.value,
                           document_.source,
                           std::make_shared<const ParsedDocument>(WithoutFiring(document_))});
  if (absl::Status deployed = SetUpTurn(std::move(own)); !deployed.ok()) return deployed;
  stages_->engine.HoldForOthers(recorded_.held);
  return absl::OkStatus();
}

// Facts of modules of ontology, or the others, in turns of a bounded length.
absl::Status PlayStages::Load(bool modules) {
  WriteBatch batch;
  const auto load = [&] {
    batch.mode = WriteBatch::Mode::kLoad;
    return SetUpTurn(std::exchange(batch, {}));
  };
  for (const TermQuad& fact : recorded_.facts) {
    if (IsModuleGraph(fact.graph.lexical) != modules) continue;
    batch.operations.push_back({QuadOperation::Kind::kAdd, fact});
    if (batch.operations.size() < kFactsOfTurn) continue;
    if (absl::Status loaded = load(); !loaded.ok()) return loaded;
  }
  return batch.operations.empty() ? absl::OkStatus() : load();
}

void PlayStages::RestoreLifetimes() {
  std::vector<std::pair<TimeMicros, Quad>> lifetimes;
  for (const auto& [end_us, fact] : recorded_.lifetimes) {
    const Quad quad{dictionary_->Intern(fact.subject), dictionary_->Intern(fact.predicate),
                    dictionary_->Intern(fact.object), dictionary_->Intern(fact.graph)};
    if (stages_->writer.current().ContainsMatch({quad.subject, quad.predicate, quad.object, quad.graph}))
      lifetimes.emplace_back(end_us, quad);
  }
  stages_->applier.RestoreLifetimes(lifetimes);
}

// One after the other: a process may contain one of a document that comes later.
absl::Status PlayStages::PutDocuments(std::vector<const Document*> left) {
  absl::Status refused;
  for (size_t before = left.size() + 1; !left.empty() && left.size() < before;) {
    before = left.size();
    std::erase_if(left, [&](const Document* document) {
      WriteBatch batch;
      absl::StatusOr<Document> played = Played(*document);
      if (played.ok()) batch.documents.push_back(*std::move(played));
      refused = played.status();
      if (refused.ok()) refused = SetUpTurn(std::move(batch));
      return refused.ok();
    });
    if (absl::Status over = options_.cancellation->CheckNow(); !over.ok()) return over;
  }
  return left.empty() ? absl::OkStatus() : refused;
}

absl::StatusOr<Document> PlayStages::Played(const Document& document) const {
  Document played = document;
  if (document.kind != Document::Kind::kCawl || document.action != Document::Action::kPut) return played;
  auto parsed = ParseWorkflow(document.text, document.name, options_.limits);
  if (!parsed.ok()) return parsed.status();
  played.parsed = std::make_shared<const ParsedDocument>(WithoutFiring(**parsed));
  return played;
}

absl::Status PlayStages::SetUpTurn(WriteBatch batch) {
  const CaseTurn& first = recorded_.turns.front();
  return Turn(std::move(batch), first.offset - 1, first.time_us).status();
}

absl::StatusOr<TurnResult> PlayStages::Turn(WriteBatch batch, uint64_t offset, TimeMicros now_us) {
  if (absl::Status over = options_.cancellation->CheckNow(); !over.ok()) return over;
  batch.time_us = now_us;
  absl::StatusOr<TurnResult> result = RunTurn(stages_.get(), std::move(batch), offset);
  if (result.ok()) return result;
  const absl::Status& status = result.status();
  if (status.code() == absl::StatusCode::kCancelled || status.code() == absl::StatusCode::kDeadlineExceeded)
    return status;
  return WithMessage(status, absl::StrCat("turn ", offset, " of the replay: ", status.message()));
}

}  // namespace docent::server
