// Events in the graph, and when they leave it.
//
// An event (docent:Event) is an occurrence: each telling counts, of a batch or of a run, also if the graph has it. It stays for the turn
// that tells it, and as long as a condition waits with it; the next turn withdraws it, with the facts that came with it or
// since: those about its node, those about the blank nodes below it, and, if it is a blank node, those that name it. What was
// told of the node before stays. Who tells an event again withdraws the earlier telling first.
//
// The withdrawal belongs to the input of its turn (a clock tick, if no other batch comes), so the log has it. Journaled:
// Commit or Rollback at the end of a turn. Writer thread only.
#ifndef DOCENT_KB_SERVER_TURN_EVENT_SHELF_H_
#define DOCENT_KB_SERVER_TURN_EVENT_SHELF_H_

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "absl/types/span.h"
#include "graph/rdf/dictionary.h"
#include "graph/store/batch_applier.h"
#include "graph/store/delta.h"
#include "graph/store/graph_version.h"
#include "graph/store/graph_writer.h"
#include "workflow/engine/state/ports.h"

namespace docent::server {

class EventShelf {
 public:
  struct Event {
    uint64_t told = 0;  // offset of the turn
    bool waits = false;
    std::set<Quad> facts;
  };
  using Events = std::map<TermId, Event>;

  explicit EventShelf(Dictionary* dictionary);

  // The batch with names of its own for the blank nodes of the events that it tells: those told by two batches are two, also
  // if both call them _:b1. nullopt: it tells none.
  std::optional<WriteBatch> WithOwnNames(const WriteBatch& batch, const BatchApplier& applier,
                                         uint64_t offset) const;

  // Begins a turn: withdraws what is over, and what `batch` tells again. The removals.
  Delta Withdraw(const WriteBatch& batch, BatchApplier* applier, GraphWriter* writer);
  // Begins another round of it: withdraws what runs tell again. The removals.
  Delta Withdraw(absl::Span<const engine::FactWrite> writes, BatchApplier* applier, GraphWriter* writer);
  // How many of these, from the first on, are of one round: whole tellings, of each event at most one, and withdrawals of nothing
  // that they have told with an event. What follows is of another round.
  static size_t OneTelling(absl::Span<const engine::FactWrite> writes, const BatchApplier& applier);
  // After the batch, or the writes of a round, were applied, and rules followed: keeps what they told. `told`: what they changed.
  void Take(const std::vector<Quad>& told_events, const Delta& told, const GraphVersion& version,
            uint64_t offset);
  // What the engine is to know of this round: the events that left with Withdraw, and those of Take.
  const engine::EventNews& news() const { return news_; }
  // At the end of a turn: which events stay. Beyond the limit events_waiting the oldest do not.
  void Settle(const std::set<Term>& awaited, const GraphVersion& version, TimeMicros now_us);

  // When the next turn is due, if ever: at once, if an event is over.
  std::optional<TimeMicros> NextDeadline() const { return due_us_; }

  const Events& events() const { return events_; }
  void Restore(Events events, TimeMicros now_us);
  // For a graph that an earlier version kept, whose events did not all leave: those that are not here are over.
  void Adopt(const GraphVersion& version, TimeMicros now_us);

  void Commit() { undo_.reset(); }
  void Rollback();

 private:
  bool IsKept(const Quad& quad) const;
  // `also_over`: those that wait no longer, too.
  Delta WithdrawThese(const std::set<TermId>& again, bool also_over, BatchApplier* applier,
                      GraphWriter* writer);
  Events& Mutable();
  void FindDue(TimeMicros now_us);

  Dictionary& dictionary_;
  const TermId type_, event_, operation_;
  Events events_;
  std::optional<TimeMicros> due_us_;
  engine::EventNews news_;
  struct Before {
    Events events;
    std::optional<TimeMicros> due_us;
  };
  std::optional<Before> undo_;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_TURN_EVENT_SHELF_H_
