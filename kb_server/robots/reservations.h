// Reservations of robots as facts: read, made by operators, released. Runs make theirs in workflow/engine/run_reservations.cc, which
// also says what they mean. Any thread.
#ifndef DOCENT_KB_SERVER_ROBOTS_RESERVATIONS_H_
#define DOCENT_KB_SERVER_ROBOTS_RESERVATIONS_H_

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "graph/base/clock.h"
#include "graph/rdf/dictionary.h"
#include "graph/store/graph_version.h"
#include "graph/store/write_batch.h"
#include "workflow/engine/state/ports.h"

namespace docent::server {

// All, the one that counts before the others in front: of the highest priority, of these the oldest.
std::vector<engine::Reservation> ReadReservations(const Dictionary& dictionary, const GraphVersion& version);

// For people: "run Tour-1", "workflow Tour", or empty: for none.
std::string KeptForText(const engine::Reservation& reservation);

inline constexpr int kMaxReservationPriority = 1000;  // and at least its negative, as ext:priority
inline constexpr uint64_t kLongestReservationMs = 720ull * 3600 * 1000;

struct ReservationRequest {
  std::vector<std::string> robots;  // IRIs
  std::string kept_for;             // a live run or a deployed workflow; empty: none
  int priority = 0;
  uint64_t lasting_ms = 0;  // 0: until it is released, or its run ends
  std::string reason;       // for people
};

// What of a request can be told without the graph. INVALID_ARGUMENT: no robot, one that is no IRI, a priority beyond ext:priority's,
// neither a time nor a run; RESOURCE_EXHAUSTED: more than reserved_robots.
absl::Status CheckReservation(const ReservationRequest& request);

// Adds to `batch` the facts of a reservation that is new, with the lifetime: nothing else may be in it. `*made` is its IRI and
// what it is. NOT_FOUND: the graph has no such robot, no live run and no deployed workflow of that name.
absl::Status MakeReservation(const ReservationRequest& request, const Dictionary& dictionary,
                             const GraphVersion& graph, TimeMicros now_us, WriteBatch* batch,
                             engine::Reservation* made);

// Adds to `batch` what withdraws a reservation, whoever told it. NOT_FOUND: there is none.
absl::Status ReleaseReservation(const std::string& reservation, const Dictionary& dictionary,
                                const GraphVersion& graph, WriteBatch* batch);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_ROBOTS_RESERVATIONS_H_
