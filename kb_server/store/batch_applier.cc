#include "kb_server/store/batch_applier.h"

#include <string>

#include "absl/strings/str_cat.h"
#include "kb_server/rdf/vocabulary.h"
#include "kb_server/store/reading_mapper.h"

namespace docent {
namespace {

bool IsReserved(const Term& graph) { return graph.lexical == kInferredGraph || graph.lexical == kRunsGraph; }

}  // namespace

BatchApplier::BatchApplier(Dictionary& dictionary, const Limits& limits)
    : dictionary_(dictionary),
      limits_(limits),
      type_(dictionary.InternIri(kRdfType)),
      state_property_(dictionary.InternIri(DocentIri("StateProperty"))),
      default_graph_(dictionary.InternIri(kDefaultGraph)) {}

absl::Status BatchApplier::Check(const QuadOperation& operation, size_t index) const {
  const TermQuad& quad = operation.quad;
  auto bad = [&](std::string_view what, const Term& term) {
    return absl::InvalidArgumentError(
        absl::StrCat("operations[", index, "]: ", std::string(what), ", but it is ", ToNTriples(term)));
  };
  if (quad.subject.IsLiteral()) return bad("the subject must be an IRI or a blank node", quad.subject);
  if (!quad.predicate.IsIri()) return bad("the predicate must be an IRI", quad.predicate);
  if (!quad.graph.IsIri()) return bad("the graph must be an IRI", quad.graph);
  if (IsReserved(quad.graph)) return bad("that graph is written by the server alone", quad.graph);
  for (const Term* term : {&quad.subject, &quad.predicate, &quad.object}) {
    if (term->lexical.empty() && !term->IsLiteral()) {
      return absl::InvalidArgumentError(absl::StrCat("operations[", index, "]: an empty IRI or blank node label"));
    }
    if (term->lexical.size() > limits_.term_bytes) {
      return absl::ResourceExhaustedError(absl::StrCat("operations[", index, "]: a term of ", term->lexical.size(),
                                                       " bytes; the limit term_bytes is ", limits_.term_bytes));
    }
  }
  return absl::OkStatus();
}

Quad BatchApplier::Intern(const TermQuad& quad, TermId default_graph) {
  return {dictionary_.Intern(quad.subject), dictionary_.Intern(quad.predicate), dictionary_.Intern(quad.object),
          quad.graph.lexical.empty() ? default_graph : dictionary_.Intern(quad.graph)};
}

void BatchApplier::RefreshStateProperties(const GraphVersion& version) {
  if (state_properties_known_) return;
  state_properties_.clear();
  version.ForEach({{}, type_, state_property_, {}}, [this](const Quad& quad) {
    state_properties_.insert(quad.subject);
    return true;
  });
  state_properties_known_ = true;
}

void BatchApplier::SetDeadline(const Quad& quad, std::optional<TimeMicros> deadline) {
  auto it = deadlines_.find(quad);
  std::optional<TimeMicros> before;
  if (it != deadlines_.end()) before = it->second;
  if (before == deadline) return;
  undo_.emplace_back(quad, before);
  if (before) by_deadline_.erase({*before, quad});
  if (deadline) {
    deadlines_[quad] = *deadline;
    by_deadline_.insert({*deadline, quad});
  } else {
    deadlines_.erase(it);
  }
}

void BatchApplier::Add(const Quad& quad, const WriteBatch& batch, GraphWriter& writer, DeltaSum* sum) {
  if (batch.mode == WriteBatch::Mode::kAssert && state_properties_.contains(quad.predicate)) {
    std::vector<Quad> old;
    writer.current().ForEach({quad.subject, quad.predicate, {}, {}}, [&](const Quad& other) {
      if (other.graph == quad.graph && other.object != quad.object) old.push_back(other);
      return true;
    });
    for (const Quad& other : old) Remove(other, writer, sum);
  }
  if (writer.Add(quad)) sum->Added(quad);
  if (batch.mode != WriteBatch::Mode::kAssert) return;
  if (batch.lifetime_ms > 0) SetDeadline(quad, batch.time_us + static_cast<TimeMicros>(batch.lifetime_ms) * 1000);
  else if (!deadlines_.empty()) SetDeadline(quad, std::nullopt);
}

void BatchApplier::Remove(const Quad& quad, GraphWriter& writer, DeltaSum* sum) {
  if (writer.Remove(quad)) sum->Removed(quad);
  if (!deadlines_.empty()) SetDeadline(quad, std::nullopt);
}

void BatchApplier::Expire(TimeMicros now_us, GraphWriter& writer, DeltaSum* sum) {
  while (!by_deadline_.empty() && by_deadline_.begin()->first <= now_us) {
    Remove(Quad(by_deadline_.begin()->second), writer, sum);
  }
}

absl::StatusOr<Delta> BatchApplier::Apply(const WriteBatch& batch, GraphWriter& writer) {
  for (size_t i = 0; i < batch.operations.size(); ++i) {
    if (absl::Status status = Check(batch.operations[i], i); !status.ok()) return status;
  }
  RefreshStateProperties(writer.current());
  absl::StatusOr<std::vector<QuadOperation>> read = MapReadings(batch.readings, dictionary_, writer.current());
  if (!read.ok()) return read.status();

  DeltaSum sum;
  Expire(batch.time_us, writer, &sum);
  TermId graph = batch.source.empty() ? default_graph_ : dictionary_.InternIri(batch.source);
  const std::vector<QuadOperation>& readings = *read;
  for (const std::vector<QuadOperation>* operations : {&batch.operations, &readings}) {
    for (const QuadOperation& operation : *operations) {
      Quad quad = Intern(operation.quad, graph);
      if (operation.kind == QuadOperation::Kind::kAdd) Add(quad, batch, writer, &sum);
      else Remove(quad, writer, &sum);
    }
  }
  Delta delta = sum.Net();
  for (const std::vector<Quad>* quads : {&delta.added, &delta.removed}) {
    for (const Quad& quad : *quads) {
      if (quad.predicate == type_ && quad.object == state_property_) state_properties_known_ = false;
    }
  }
  return delta;
}

std::optional<TimeMicros> BatchApplier::NextDeadline() const {
  if (by_deadline_.empty()) return std::nullopt;
  return by_deadline_.begin()->first;
}

void BatchApplier::Commit() { undo_.clear(); }

void BatchApplier::Rollback() {
  std::vector<std::pair<Quad, std::optional<TimeMicros>>> undo = std::move(undo_);
  undo_.clear();
  for (auto it = undo.rbegin(); it != undo.rend(); ++it) SetDeadline(it->first, it->second);
  undo_.clear();
  state_properties_known_ = false;
}

}  // namespace docent
