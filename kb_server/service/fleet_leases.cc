#include "kb_server/service/fleet_leases.h"

namespace docent {

bool FleetLeases::Renew(const std::string& robot, const std::string& description) {
  absl::MutexLock lock(&mutex_);
  auto [it, inserted] = leases_.try_emplace(robot);
  bool news = inserted || it->second.description != description;
  it->second.description = description;
  it->second.until_us = clock_.Now() + int64_t{kLeaseMs} * 1000;
  return news;
}

void FleetLeases::Expect(const std::string& robot) {
  absl::MutexLock lock(&mutex_);
  leases_.try_emplace(robot, Lease{clock_.Now() + int64_t{kLeaseMs} * 1000, ""});
}

std::vector<std::string> FleetLeases::TakeLost() {
  absl::MutexLock lock(&mutex_);
  std::vector<std::string> lost;
  for (auto it = leases_.begin(); it != leases_.end();) {
    if (it->second.until_us > clock_.Now()) {
      ++it;
      continue;
    }
    lost.push_back(it->first);
    it = leases_.erase(it);
  }
  return lost;
}

}  // namespace docent
