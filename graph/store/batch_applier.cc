#include "graph/store/batch_applier.h"

#include <algorithm>
#include <map>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "graph/base/overload.h"
#include "graph/base/text.h"
#include "graph/rdf/term_check.h"
#include "graph/rdf/vocabulary.h"
#include "graph/store/own_states.h"
#include "graph/store/reading_mapper.h"
#include "graph/store/server_graphs.h"

namespace docent {
namespace {

constexpr std::string_view kSubClassOf = "http://www.w3.org/2000/01/rdf-schema#subClassOf";

absl::Status Reserved(const std::string& graph) {
  return absl::InvalidArgumentError(
      absl::StrCat("graph: <", graph, "> is one of those that only the server writes"));
}

// A lifetime that ends later than this (the year 2554) never ends.
constexpr TimeMicros kNever = TimeMicros{1} << 54;

absl::Status At(absl::string_view place, const absl::Status& status) {
  return WithMessage(status, absl::StrCat(place, ": ", status.message()));
}

// True for many plain additions, which are sorted before they go into the indexes.
bool IsBulk(const WriteBatch& batch) {
  constexpr size_t kBulk = 256;
  return batch.mode == WriteBatch::Mode::kLoad && batch.operations.size() >= kBulk &&
         std::all_of(batch.operations.begin(), batch.operations.end(),
                     [](const QuadOperation& o) { return o.kind == QuadOperation::Kind::kAdd; });
}

// The place of an operation as clients number them: "add[2]", "remove[0]". Facts of a text come after these.
std::string PlaceOf(const WriteBatch& batch, size_t at) {
  const QuadOperation::Kind kind = batch.operations[at].kind;
  const auto number =
      std::count_if(batch.operations.begin(), batch.operations.begin() + static_cast<ptrdiff_t>(at),
                    [kind](const QuadOperation& o) { return o.kind == kind; });
  return absl::StrCat(kind == QuadOperation::Kind::kAdd ? "add[" : "remove[", number, "]");
}

std::optional<TimeMicros> EndOfLifetime(TimeMicros from_us, uint64_t lifetime_ms) {
  if (lifetime_ms == 0 || lifetime_ms >= static_cast<uint64_t>(kNever / 1000)) return std::nullopt;
  TimeMicros end_us = from_us + static_cast<TimeMicros>(lifetime_ms) * 1000;
  return end_us < kNever ? std::optional(end_us) : std::nullopt;
}

}  // namespace

BatchApplier::BatchApplier(Dictionary& dictionary, const Limits& limits)
    : dictionary_(dictionary),
      limits_(limits),
      type_(dictionary.InternIri(kRdfType)),
      state_property_(dictionary.InternIri(DocentIri("StateProperty"))),
      default_graph_(dictionary.InternIri(kDefaultGraph)),
      subclass_(dictionary.InternIri(kSubClassOf)),
      event_(dictionary.InternIri(DocentIri("Event"))),
      event_classes_{event_} {
  for (const std::string_view name : kOwnStates) own_states_.insert(dictionary.InternIri(DocentIri(name)));
}

absl::Status BatchApplier::Check(const WriteBatch& batch) const {
  if (!batch.source.empty()) {
    const Term source = Term::Iri(batch.source);
    if (absl::Status s = CheckTerm(source, limits_.term_bytes); !s.ok()) return At("source", s);
    if (IsDerivedGraph(source.lexical)) return At("source", Reserved(source.lexical));
  }
  for (size_t i = 0; i < batch.operations.size(); ++i) {
    const TermQuad& quad = batch.operations[i].quad;
    absl::Status status = CheckQuad(quad, limits_.term_bytes);
    if (status.ok() && !quad.graph.IsIri())
      status = absl::InvalidArgumentError("graph: " + RefuseGraph(quad.graph));
    if (status.ok() && IsDerivedGraph(quad.graph.lexical)) status = Reserved(quad.graph.lexical);
    if (!status.ok()) return At(PlaceOf(batch, i), status);
  }
  for (size_t i = 0; i < batch.readings.size(); ++i) {
    absl::Status status = CheckTerm(batch.readings[i].value, limits_.term_bytes);
    if (!status.ok()) return At(absl::StrCat("readings[", i, "]: value"), status);
  }
  return absl::OkStatus();
}

Quad BatchApplier::Intern(const TermQuad& quad, TermId default_graph) {
  return {dictionary_.Intern(quad.subject), dictionary_.Intern(quad.predicate),
          dictionary_.Intern(quad.object),
          quad.graph.lexical.empty() ? default_graph : dictionary_.Intern(quad.graph)};
}

// Neighbouring statements in a file mostly share subject, predicate and graph.
std::vector<Quad> BatchApplier::InternAll(const std::vector<QuadOperation>& operations,
                                          TermId default_graph) {
  std::vector<Quad> quads;
  quads.reserve(operations.size());
  const TermQuad* last = nullptr;
  for (const QuadOperation& operation : operations) {
    const TermQuad& quad = operation.quad;
    const auto id = [&](const Term TermQuad::*term, TermId Quad::*known) {
      return last != nullptr && last->*term == quad.*term ? quads.back().*known
                                                          : dictionary_.Intern(quad.*term);
    };
    quads.push_back({id(&TermQuad::subject, &Quad::subject), id(&TermQuad::predicate, &Quad::predicate),
                     dictionary_.Intern(quad.object),
                     quad.graph.lexical.empty() ? default_graph : id(&TermQuad::graph, &Quad::graph)});
    last = &quad;
  }
  return quads;
}

std::optional<Quad> BatchApplier::Find(const TermQuad& quad, TermId default_graph) const {
  std::optional<TermId> subject = dictionary_.Find(quad.subject),
                        predicate = dictionary_.Find(quad.predicate);
  std::optional<TermId> object = dictionary_.Find(quad.object);
  std::optional<TermId> graph = quad.graph.lexical.empty() ? default_graph : dictionary_.Find(quad.graph);
  if (!subject || !predicate || !object || !graph) return std::nullopt;
  return Quad{*subject, *predicate, *object, *graph};
}

void BatchApplier::RefreshStateProperties(const GraphVersion& version) {
  if (knows_state_properties_) return;
  state_properties_ = own_states_;
  version.ForEach({{}, type_, state_property_, {}}, [this](const Quad& quad) {
    state_properties_.insert(quad.subject);
    return true;
  });
  knows_state_properties_ = true;
}

void BatchApplier::RefreshEventClasses(const GraphVersion& version) {
  if (knows_event_classes_) return;
  event_classes_ = {event_};
  AddClassesBelow(event_, version);
  knows_event_classes_ = true;
}

std::vector<TermId> BatchApplier::AddClassesBelow(TermId above, const GraphVersion& version) {
  std::vector<TermId> added;
  for (std::vector<TermId> open = {above}; !open.empty();) {
    const TermId next = open.back();
    open.pop_back();
    version.ForEach({{}, subclass_, next, {}}, [&](const Quad& quad) {
      if (!event_classes_.insert(quad.subject).second) return true;
      added.push_back(quad.subject);
      open.push_back(quad.subject);
      return true;
    });
  }
  return added;
}

void BatchApplier::Announce(const WriteBatch& batch, const GraphVersion& version) {
  announced_classes_.clear();
  RefreshEventClasses(version);
  std::multimap<Term, Term> below;  // as the batch says
  for (const QuadOperation& operation : batch.operations) {
    const TermQuad& quad = operation.quad;
    if (operation.kind == QuadOperation::Kind::kAdd && quad.predicate.lexical == kSubClassOf)
      below.emplace(quad.object, quad.subject);
  }
  std::vector<Term> open;
  const auto open_below = [&](const Term& above) {
    const auto [first, last] = below.equal_range(above);
    for (auto it = first; it != last; ++it) open.push_back(it->second);
  };
  for (const auto& [above, subclass] : below) {
    if (IsEventClass(above)) open.push_back(subclass);
  }
  while (!open.empty()) {
    const Term subclass = std::move(open.back());
    open.pop_back();
    if (IsEventClass(subclass)) continue;
    announced_classes_.insert(subclass);
    open_below(subclass);
    const std::optional<TermId> known = dictionary_.Find(subclass);
    if (!known) continue;
    knows_event_classes_ = false;  // what is added here holds for this batch
    event_classes_.insert(*known);
    for (const TermId of_graph : AddClassesBelow(*known, version)) open_below(dictionary_.Decode(of_graph));
  }
}

bool BatchApplier::IsEventClass(const Term& type) const {
  const std::optional<TermId> id = dictionary_.Find(type);
  return (id && event_classes_.contains(*id)) || announced_classes_.contains(type);
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
  NoteEvent(quad);
  bool asserts = batch.mode == WriteBatch::Mode::kAssert;
  std::optional<TimeMicros> end = asserts ? EndOfLifetime(batch.time_us, batch.lifetime_ms) : std::nullopt;
  if (end || !deadlines_.empty()) SetDeadline(quad, end);
}

void BatchApplier::AddAll(const WriteBatch& batch, TermId default_graph, GraphWriter& writer, DeltaSum* sum) {
  std::vector<Quad> quads = InternAll(batch.operations, default_graph);
  for (const Quad& quad : quads) NoteEvent(quad);
  for (size_t i = 0; i < quads.size() && !deadlines_.empty(); ++i) SetDeadline(quads[i], std::nullopt);
  for (const Quad& quad : writer.AddAll(std::move(quads))) sum->Added(quad);
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

void BatchApplier::ApplyOne(const QuadOperation& operation, TermId default_graph, const WriteBatch& batch,
                            GraphWriter& writer, DeltaSum* sum) {
  if (operation.kind == QuadOperation::Kind::kAdd) {
    Add(Intern(operation.quad, default_graph), batch, writer, sum);
  } else if (const std::optional<Quad> known = Find(operation.quad, default_graph)) {
    Remove(*known, writer, sum);
  }
}

absl::StatusOr<Delta> BatchApplier::Apply(const WriteBatch& batch, GraphWriter& writer,
                                          absl::Span<const QuadOperation> first) {
  if (absl::Status status = Check(batch); !status.ok()) return status;
  RefreshStateProperties(writer.current());
  if (announced_classes_.empty()) RefreshEventClasses(writer.current());
  told_events_.clear();
  absl::StatusOr<std::vector<QuadOperation>> read =
      MapReadings(batch.readings, dictionary_, writer.current());
  if (!read.ok()) return read.status();

  for (const Term& announced : announced_classes_) event_classes_.insert(dictionary_.Intern(announced));

  DeltaSum sum;
  Expire(batch.time_us, writer, &sum);
  TermId graph = batch.source.empty() ? default_graph_ : dictionary_.InternIri(batch.source);
  for (const QuadOperation& operation : first) ApplyOne(operation, graph, batch, writer, &sum);
  if (IsBulk(batch)) {
    AddAll(batch, graph, writer, &sum);
  } else {
    for (const QuadOperation& operation : batch.operations) ApplyOne(operation, graph, batch, writer, &sum);
  }
  for (const QuadOperation& operation : *read) ApplyOne(operation, graph, batch, writer, &sum);
  Delta delta = sum.Net();
  Learn(delta);
  return delta;
}

void BatchApplier::Learn(const Delta& delta) {
  for (const std::vector<Quad>* quads : {&delta.added, &delta.removed}) {
    for (const Quad& quad : *quads) {
      if (quad.predicate == type_ && quad.object == state_property_) knows_state_properties_ = false;
      if (quad.predicate == subclass_) knows_event_classes_ = false;
    }
  }
}

Delta BatchApplier::Withdraw(absl::Span<const Quad> quads, GraphWriter& writer) {
  DeltaSum sum;
  for (const Quad& quad : quads) Remove(quad, writer, &sum);
  return sum.Net();
}

std::optional<TimeMicros> BatchApplier::NextDeadline() const {
  if (by_deadline_.empty()) return std::nullopt;
  return by_deadline_.begin()->first;
}

void BatchApplier::RestoreLifetimes(const std::vector<std::pair<TimeMicros, Quad>>& lifetimes) {
  for (const auto& [end_us, quad] : lifetimes) {
    deadlines_[quad] = end_us;
    by_deadline_.insert({end_us, quad});
  }
}

void BatchApplier::Commit() {
  undo_.clear();
  announced_classes_.clear();
}

void BatchApplier::Rollback() {
  std::vector<std::pair<Quad, std::optional<TimeMicros>>> undo = std::move(undo_);
  undo_.clear();
  for (auto it = undo.rbegin(); it != undo.rend(); ++it) SetDeadline(it->first, it->second);
  undo_.clear();
  knows_state_properties_ = false;
  knows_event_classes_ = false;
  announced_classes_.clear();
  told_events_.clear();
}

}  // namespace docent
