// What runs of workflows read of the graph and write into it: told facts by a pattern, and their tells and withdrawals. Writer
// thread only.
#ifndef DOCENT_KB_SERVER_TURN_FACT_PORT_H_
#define DOCENT_KB_SERVER_TURN_FACT_PORT_H_

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "graph/base/cancellation.h"
#include "graph/base/clock.h"
#include "graph/rdf/dictionary.h"
#include "graph/sparql/values/function_registry.h"
#include "graph/store/batch_applier.h"
#include "graph/store/graph_writer.h"
#include "workflow/engine/state/ports.h"

namespace docent::server {

class FactPort final : public engine::FactView {
 public:
  // All must outlive the port. `version`: as it is when it is asked.
  // One for each turn: `now_us` is its time, `seed` what makes RAND and UUID differ. `cancellation` may be null; when it ends
  // a Select, the turn is to be refused.
  FactPort(Dictionary* dictionary, const GraphVersion* version, const sparql::FunctionRegistry* functions,
           TimeMicros now_us, uint64_t seed, Cancellation* cancellation)
      : dictionary_(*dictionary),
        version_(*version),
        functions_(functions),
        now_us_(now_us),
        seed_(seed),
        cancellation_(cancellation) {}

  absl::StatusOr<engine::FactMatches> Match(const engine::FactPattern& pattern, size_t limit) const override;

  absl::StatusOr<std::vector<engine::TermBinding>> Select(
      const sparql::Query& query, const engine::TermBinding& given,
      const std::vector<std::string>& columns) const override;

  absl::StatusOr<bool> Holds(const sparql::Query& ask) const override;

 private:
  // The steps that a query may take now; the turn's end ends it.
  uint64_t AllowSteps(Cancellation* steps) const;
  // The query has ended. False: it was stopped.
  bool CountSteps(const Cancellation& steps, uint64_t allowed) const;
  Dictionary& dictionary_;
  const GraphVersion& version_;
  const sparql::FunctionRegistry* functions_;
  const TimeMicros now_us_;
  const uint64_t seed_;
  Cancellation* cancellation_;
  mutable uint64_t steps_ = 0;  // of all that was selected in this turn
};

// What a round of the engine wrote, as the same facts of a client would be: a new value of a state property replaces the old
// one of the same source, lifetimes begin now. Adds what changed to `delta`, and the types that make things events to `told_events`
// (BatchApplier::told_events).
absl::Status ApplyWrites(absl::Span<const engine::FactWrite> writes, TimeMicros now_us, BatchApplier* applier,
                         GraphWriter* writer, Delta* delta, std::vector<Quad>* told_events);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_TURN_FACT_PORT_H_
