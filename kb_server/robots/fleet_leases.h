// Leases of robots, renewed by heartbeats. Heartbeats stay here and are not logged; what is told to the
// graph is that a robot joined, changed its description, or was lost or left (docent:status docent:Offline).
//
// At most one batch about a robot's presence is under way at a time: what comes next is decided when the
// graph has it, or has refused it. So a robot that joins while its Offline is under way is told as being
// there again, and what was refused is told again.
//
// Thread-safe.
#ifndef DOCENT_KB_SERVER_ROBOTS_FLEET_LEASES_H_
#define DOCENT_KB_SERVER_ROBOTS_FLEET_LEASES_H_

#include <atomic>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "absl/synchronization/mutex.h"
#include "graph/base/clock.h"

namespace docent::server {

class FleetLeases {
 public:
  // `clock`: of the times that the graph is told. `lease_clock` (null: the same) counts how long leases last: adapters show
  // themselves in real time, also where a simulator tells the other.
  explicit FleetLeases(const Clock* clock, const Clock* lease_clock = nullptr)
      : clock_(*clock), lease_clock_(lease_clock != nullptr ? *lease_clock : *clock) {}

  // How long a lease lasts.
  static constexpr uint32_t kLeaseMs = 5000;

  // An adapter at `address` asks to speak for the robot. Empty: it does from now on. Else the address of the one that does while
  // its lease lives, which learns of the other (RivalOf). `gone`: an address at which no adapter is any more, so that its lease
  // counts for nothing.
  std::string Claim(const std::string& robot, const std::string& address, const std::string& gone = "");
  // The address of the adapter that was refused within the last lease; empty: none.
  std::string RivalOf(const std::string& robot) const;
  // Adapters that were refused because another one speaks for their robot.
  uint64_t refused() const { return refused_; }
  void CountRefused() { ++refused_; }

  // Called once; true: tell the graph that the robot is there, and then call `Told`.
  using Decided = std::function<void(bool tell)>;

  // A robot shows itself, by this incarnation of its adapter. `decided` is called at once or, while a batch about the robot is under way, after
  // that (from the thread that calls Told or ToldLost). The graph has to be told if the robot is new here,
  // was lost, or `description` (not empty) is not the one that the graph was told.
  void Renew(const std::string& robot, const std::string& incarnation, const std::string& description,
             Decided decided);
  // The graph has not, or not any more, what it was told of the robot: it is told again with the next Renew.
  void Untell(const std::string& robot);
  // Whether the graph took what Renew asked for.
  void Told(const std::string& robot, const std::string& description, bool taken);
  // A robot that the graph has as online after a restart of the server: it gets one lease to show itself.
  void Expect(const std::string& robot, const std::string& address, const std::string& incarnation);
  // Robots that the graph has as online and whose lease ran out. For each: tell the graph, then call
  // `ToldLost`.
  struct Lost {
    std::string robot;
    TimeMicros seen_us = 0;  // when it last showed itself; 0: not to this server
  };
  std::vector<Lost> TakeLost();
  // The adapter ends in order: its lease is over. `decided` is called once, as that of Renew; not null: tell the graph, then call
  // `ToldLost`. Null: there is nothing to tell, because another incarnation speaks for the robot, or none, or the graph has it as
  // offline.
  void Leave(const std::string& robot, const std::string& incarnation,
             std::function<void(const Lost* lost)> decided);
  // Whether the graph took it; if not, the robot is lost again one lease later.
  void ToldLost(const std::string& robot, bool taken);

 private:
  struct News {
    std::string description;  // of one that shows itself
    bool leaves = false;
    Decided decided;
  };
  struct Lease {
    TimeMicros until_us = 0;
    TimeMicros seen_us = 0;
    std::string address;        // of the adapter that speaks for the robot
    std::string incarnation;    // of the one that showed itself last
    std::string rival;          // address of another that was refused
    TimeMicros rival_us = 0;    // when
    bool online = false;        // so the graph says, as far as known here
    std::string told;           // the description that the graph has, as far as known here
    bool under_way = false;     // a batch about the robot
    std::vector<News> waiting;  // for that
  };

  static bool HasToBeTold(const Lease& lease, const News& news) {
    return news.leaves ? lease.online : !lease.online || lease.told != news.description;
  }
  void End(const std::string& robot, const std::function<void(Lease*)>& note);

  const Clock& clock_;
  const Clock& lease_clock_;
  std::atomic<uint64_t> refused_ = 0;
  mutable absl::Mutex mutex_;
  std::map<std::string, Lease> leases_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_ROBOTS_FLEET_LEASES_H_
