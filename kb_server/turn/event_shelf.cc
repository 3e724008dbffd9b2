#include "kb_server/turn/event_shelf.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <utility>

#include "absl/strings/str_cat.h"
#include "graph/base/workflow_limits.h"
#include "graph/rdf/docent_iris.h"
#include "graph/rdf/vocabulary.h"
#include "graph/store/reading_mapper.h"
#include "graph/store/server_graphs.h"
#include "kb_server/door/catalog.h"

namespace docent::server {
namespace {

bool TellsEvent(const TermQuad& quad, const BatchApplier& applier) {
  return quad.predicate.lexical == kRdfType && applier.IsEventClass(quad.object);
}
bool Tells(const QuadOperation& operation, const BatchApplier& applier) {
  return operation.kind == QuadOperation::Kind::kAdd && TellsEvent(operation.quad, applier);
}

// The blank nodes of the events that the batch tells, and those below them.
std::set<std::string> EventLabels(const WriteBatch& batch, const BatchApplier& applier) {
  std::set<std::string> labels;
  std::set<Term> open;
  const Term* plain = nullptr;  // a type of things that are no events: of many facts of a load
  for (const QuadOperation& operation : batch.operations) {
    if (operation.kind != QuadOperation::Kind::kAdd || operation.quad.predicate.lexical != kRdfType) continue;
    if (plain != nullptr && *plain == operation.quad.object) continue;
    if (!Tells(operation, applier)) {
      plain = &operation.quad.object;
      continue;
    }
    open.insert(operation.quad.subject);
    if (operation.quad.subject.IsBlank()) labels.insert(operation.quad.subject.lexical);
  }
  if (open.empty()) return labels;
  std::multimap<Term, std::string> below;
  for (const QuadOperation& operation : batch.operations) {
    if (operation.kind == QuadOperation::Kind::kAdd && operation.quad.object.IsBlank())
      below.emplace(operation.quad.subject, operation.quad.object.lexical);
  }
  while (!open.empty()) {
    const Term above = *open.begin();
    open.erase(open.begin());
    const auto [first, last] = below.equal_range(above);
    for (auto it = first; it != last; ++it) {
      if (labels.insert(it->second).second) open.insert(Term::Blank(it->second));
    }
  }
  return labels;
}

std::array<Term, 4> TermsOf(const TermQuad& quad) {
  return {quad.subject, quad.predicate, quad.object, quad.graph};
}

}  // namespace

EventShelf::EventShelf(Dictionary* dictionary)
    : dictionary_(*dictionary),
      type_(dictionary->InternIri(kRdfType)),
      event_(dictionary->InternIri(DocentIri("Event"))),
      operation_(dictionary->InternIri(DocentIri("operation"))) {}

std::optional<WriteBatch> EventShelf::WithOwnNames(const WriteBatch& batch, const BatchApplier& applier,
                                                   uint64_t offset) const {
  const std::set<std::string> labels = EventLabels(batch, applier);
  if (labels.empty()) return std::nullopt;
  WriteBatch named = batch;
  for (QuadOperation& operation : named.operations) {
    if (operation.kind != QuadOperation::Kind::kAdd) continue;
    for (Term* term : {&operation.quad.subject, &operation.quad.object}) {
      if (term->IsBlank() && labels.contains(term->lexical))
        term->lexical = absl::StrCat("event", offset, "_", term->lexical);
    }
  }
  return named;
}

// Neither what the server says itself nor what documents say.
bool EventShelf::IsKept(const Quad& quad) const {
  const std::string_view graph = dictionary_.Lexical(quad.graph);
  static const std::string* ontologies = new std::string(OntologyGraph(""));
  return !IsDerivedGraph(graph) && !graph.starts_with(*ontologies);
}

EventShelf::Events& EventShelf::Mutable() {
  if (!undo_) undo_ = Before{events_, due_us_};
  return events_;
}

Delta EventShelf::Withdraw(const WriteBatch& batch, BatchApplier* applier, GraphWriter* writer) {
  std::set<TermId> again;
  const Term* plain = nullptr;  // a type of things that are no events: of many facts of a load
  const auto look_at = [&](const QuadOperation& operation) {
    const bool types =
        operation.kind == QuadOperation::Kind::kAdd && operation.quad.predicate.lexical == kRdfType;
    if (!types || (plain != nullptr && *plain == operation.quad.object)) return;
    if (!Tells(operation, *applier)) {
      plain = &operation.quad.object;
    } else if (const std::optional<TermId> id = dictionary_.Find(operation.quad.subject)) {
      again.insert(*id);
    }
  };
  for (const QuadOperation& operation : batch.operations) look_at(operation);
  if (!batch.readings.empty() && !events_.empty()) {
    const auto read = MapReadings(batch.readings, dictionary_, writer->current());
    plain = nullptr;
    for (size_t i = 0; read.ok() && i < read->size(); ++i) look_at((*read)[i]);
  }
  return WithdrawThese(again, true, applier, writer);
}

Delta EventShelf::Withdraw(absl::Span<const engine::FactWrite> writes, BatchApplier* applier,
                           GraphWriter* writer) {
  std::set<TermId> again;
  for (const engine::FactWrite& write : writes) {
    if (!write.tells || !TellsEvent(write.quad, *applier)) continue;
    if (const std::optional<TermId> id = dictionary_.Find(write.quad.subject)) again.insert(*id);
  }
  return WithdrawThese(again, false, applier, writer);
}

Delta EventShelf::WithdrawThese(const std::set<TermId>& again, bool also_over, BatchApplier* applier,
                                GraphWriter* writer) {
  news_ = {};
  std::vector<Quad> facts;
  const auto gone = [&](TermId event, const std::set<Quad>& own) {
    facts.insert(facts.end(), own.begin(), own.end());
    news_.gone.push_back(dictionary_.Decode(event));
  };
  // What the graph has without being here: its class was none of events when it was told.
  for (const TermId event : again) {
    if (events_.contains(event)) continue;
    std::set<Quad> types;
    writer->current().ForEach({event, type_, {}, {}}, [&](const Quad& quad) {
      if (IsKept(quad) && applier->IsEventClass(dictionary_.Decode(quad.object))) types.insert(quad);
      return true;
    });
    if (!types.empty()) gone(event, types);
  }
  if (!events_.empty() && (also_over || !again.empty())) {
    Events& events = Mutable();
    for (auto it = events.begin(); it != events.end();) {
      const bool leaves = again.contains(it->first) || (also_over && !it->second.waits);
      if (leaves) gone(it->first, it->second.facts);
      it = leaves ? events.erase(it) : std::next(it);
    }
  }
  if (facts.empty()) return {};
  return applier->Withdraw(facts, *writer);
}

size_t EventShelf::OneTelling(absl::Span<const engine::FactWrite> writes, const BatchApplier& applier) {
  std::map<Term, size_t> events;  // and where the telling of it begins, which may give it several classes
  std::set<std::array<Term, 4>> told;
  size_t known = 0;    // of them
  size_t telling = 0;  // where the present one begins
  for (size_t i = 0; i < writes.size(); ++i) {
    const TermQuad& quad = writes[i].quad;
    if (!writes[i].continues) telling = i;
    if (writes[i].tells) {
      if (TellsEvent(quad, applier) && events.emplace(quad.subject, telling).first->second != telling)
        return telling;
    } else if (!events.empty()) {
      for (; known < i; ++known) {
        if (writes[known].tells) told.insert(TermsOf(writes[known].quad));
      }
      if (told.contains(TermsOf(quad))) return telling;
    }
  }
  return writes.size();
}

void EventShelf::Take(const std::vector<Quad>& told_events, const Delta& told, const GraphVersion& version,
                      uint64_t offset) {
  if (told_events.empty() && events_.empty()) return;
  Events& events = Mutable();
  for (const Quad& quad : told_events) {
    if (!IsKept(quad) || !version.ContainsMatch({quad.subject, quad.predicate, quad.object, quad.graph}) ||
        !version.ContainsMatch({quad.subject, type_, event_, {}}))
      continue;
    const auto [place, first] = events.try_emplace(quad.subject);
    place->second.facts.insert(quad);
    if (!first) continue;
    place->second.told = offset;
    engine::ToldEvent& news = news_.told.emplace_back();
    news.event = dictionary_.Decode(quad.subject);
    version.ForEach({quad.subject, operation_, {}, {}}, [&](const Quad& of) {
      news.operations.insert(std::string(dictionary_.Lexical(of.object)));
      return true;
    });
  }
  if (events.empty()) return;
  // What came with an event hangs at its node, or at a blank node below it.
  std::vector<std::pair<TermId, TermId>> open;  // a node, and the event that it belongs to
  const auto keep = [&](const Quad& quad, TermId event) {
    if (!events.at(event).facts.insert(quad).second && quad.subject != event) return;
    if (quad.object.tag() == TermId::Tag::kBlank) open.emplace_back(quad.object, event);
  };
  for (const Quad& quad : told.added) {
    if (!IsKept(quad)) continue;
    if (events.contains(quad.subject)) keep(quad, quad.subject);
    if (quad.object.tag() == TermId::Tag::kBlank && events.contains(quad.object))
      events.at(quad.object).facts.insert(quad);
  }
  std::multimap<TermId, const Quad*> of_blank;
  if (!open.empty()) {
    for (const Quad& quad : told.added) {
      if (quad.subject.tag() == TermId::Tag::kBlank) of_blank.emplace(quad.subject, &quad);
    }
  }
  while (!open.empty()) {
    const auto [node, event] = open.back();
    open.pop_back();
    if (events.contains(node)) continue;
    const auto [first, last] = of_blank.equal_range(node);
    for (auto it = first; it != last; ++it) {
      if (IsKept(*it->second)) keep(*it->second, event);
    }
  }
}

void EventShelf::Settle(const std::set<Term>& awaited, const GraphVersion& version, TimeMicros now_us) {
  if (events_.empty()) {
    if (due_us_) Mutable();
    due_us_.reset();
    return;
  }
  std::vector<std::pair<uint64_t, TermId>> waiting;
  Events& events = Mutable();
  for (auto& [id, event] : events) {
    event.waits = awaited.contains(dictionary_.Decode(id)) && version.ContainsMatch({id, type_, event_, {}});
    if (event.waits) waiting.emplace_back(event.told, id);
  }
  if (waiting.size() > kWorkflowLimits.events_waiting) {
    std::sort(waiting.begin(), waiting.end());
    for (size_t i = 0; i + kWorkflowLimits.events_waiting < waiting.size(); ++i)
      events.at(waiting[i].second).waits = false;
  }
  FindDue(now_us);
}

void EventShelf::FindDue(TimeMicros now_us) {
  const bool over =
      std::any_of(events_.begin(), events_.end(), [](const auto& event) { return !event.second.waits; });
  due_us_ = over ? std::optional(now_us) : std::nullopt;
}

void EventShelf::Restore(Events events, TimeMicros now_us) {
  events_ = std::move(events);
  FindDue(now_us);
}

void EventShelf::Adopt(const GraphVersion& version, TimeMicros now_us) {
  std::vector<TermId> adopted;
  version.ForEach({{}, type_, event_, {}}, [&](const Quad& quad) {
    if (IsKept(quad) && events_.try_emplace(quad.subject).second) adopted.push_back(quad.subject);
    return true;
  });
  for (const TermId id : adopted) {
    version.ForEach({id, {}, {}, {}}, [this, &event = events_.at(id)](const Quad& quad) {
      if (IsKept(quad)) event.facts.insert(quad);
      return true;
    });
  }
  FindDue(now_us);
}

void EventShelf::Rollback() {
  if (undo_) {
    events_ = std::move(undo_->events);
    due_us_ = undo_->due_us;
  }
  undo_.reset();
  news_ = {};
}

}  // namespace docent::server
