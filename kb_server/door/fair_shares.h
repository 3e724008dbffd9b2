// Order in which clients are served: who has had less of the processors goes first. Start-time fair queueing (Goyal, Vin and
// Cheng, "Start-time Fair Queuing", 1997): each client has a time that grows by what it uses; the server's own time grows by
// what all use, divided by how many of them have work. A client that begins to have work gets the server's time, less
// `credit`. So a client that has work now and then goes before one that always has. No client waits longer than its share and
// the credit of the others. What a client did not use while it had no work, it does not get later. Not thread-safe.
#ifndef DOCENT_KB_SERVER_DOOR_FAIR_SHARES_H_
#define DOCENT_KB_SERVER_DOOR_FAIR_SHARES_H_

#include <cstddef>

#include "absl/container/flat_hash_map.h"
#include "absl/time/time.h"

namespace docent::server {

class Client;

class FairShares {
 public:
  explicit FairShares(absl::Duration credit) : credit_(credit) {}

  // The client has one piece of work more, or one less. Null: the server itself, a client like the others.
  void Enter(const Client* client);
  void Leave(const Client* client);
  // It has used so much of a processor, for a piece of work that it has.
  void Charge(const Client* client, absl::Duration used);
  // The lower goes first.
  absl::Duration TimeOf(const Client* client) const;
  // Clients that have work.
  size_t active() const { return active_; }

 private:
  struct Share {
    absl::Duration time;
    absl::Duration credit;  // what is left of it: it is paid back by what is used
    size_t pieces = 0;
  };
  static constexpr size_t kIdleKept = 4096;  // of clients without work, those that have had more than others

  const absl::Duration credit_;
  absl::Duration now_ = absl::ZeroDuration();
  size_t active_ = 0;
  absl::flat_hash_map<const Client*, Share> shares_;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_DOOR_FAIR_SHARES_H_
