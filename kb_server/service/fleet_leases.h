// Which robots have shown themselves lately. Heartbeats stay here and are not logged; what is told to the
// graph is that a robot joined, changed its description, or was lost (docent:status docent:Offline).
//
// Thread-safe.
#ifndef DOCENT_KB_SERVER_SERVICE_FLEET_LEASES_H_
#define DOCENT_KB_SERVER_SERVICE_FLEET_LEASES_H_

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "absl/synchronization/mutex.h"
#include "kb_server/base/clock.h"

namespace docent {

class FleetLeases {
 public:
  explicit FleetLeases(const Clock* clock) : clock_(*clock) {}

  // How long a lease lasts.
  static constexpr uint32_t kLeaseMs = 5000;

  // True if the graph has to be told: the robot is new here, was lost, or `description` (not empty) is not
  // the one that the graph was told.
  bool Renew(const std::string& robot, const std::string& description);
  // The graph has it.
  void Told(const std::string& robot, const std::string& description);
  // A robot that the graph has as online after a restart of the server: it gets one lease to show itself.
  void Expect(const std::string& robot);
  // Robots that the graph has and whose lease ran out since the last call.
  std::vector<std::string> TakeLost();

 private:
  struct Lease {
    TimeMicros until_us = 0;
    bool in_graph = false;
    std::string told;  // the description that the graph has, as far as known here
  };
  const Clock& clock_;
  absl::Mutex mutex_;
  std::map<std::string, Lease> leases_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace docent

#endif  // DOCENT_KB_SERVER_SERVICE_FLEET_LEASES_H_
