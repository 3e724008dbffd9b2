#include "kb_server/service/fleet_leases.h"

namespace docent {

bool FleetLeases::Renew(const std::string& robot, const std::string& description) {
  absl::MutexLock lock(&mutex_);
  Lease& lease = leases_[robot];
  lease.until_us = clock_.Now() + int64_t{kLeaseMs} * 1000;
  return lease.told != description;
}

void FleetLeases::Told(const std::string& robot, const std::string& description) {
  absl::MutexLock lock(&mutex_);
  Lease& lease = leases_[robot];  // if it ran out meanwhile, it is made anew to be found lost
  lease.in_graph = true;
  lease.told = description;
}

void FleetLeases::Expect(const std::string& robot) {
  absl::MutexLock lock(&mutex_);
  leases_.try_emplace(robot, Lease{clock_.Now() + int64_t{kLeaseMs} * 1000, true, ""});
}

std::vector<std::string> FleetLeases::TakeLost() {
  absl::MutexLock lock(&mutex_);
  std::vector<std::string> lost;
  for (auto it = leases_.begin(); it != leases_.end();) {
    if (it->second.until_us > clock_.Now()) {
      ++it;
      continue;
    }
    if (it->second.in_graph) lost.push_back(it->first);
    it = leases_.erase(it);
  }
  return lost;
}

}  // namespace docent
