#include "kb_server/robots/fleet_leases.h"

#include <utility>

namespace docent::server {

std::string FleetLeases::Claim(const std::string& robot, const std::string& address,
                               const std::string& gone) {
  absl::MutexLock lock(&mutex_);
  Lease& lease = leases_[robot];
  const bool lives = lease.until_us > lease_clock_.Now() && !lease.address.empty() && lease.address != gone;
  if (!lives || lease.address == address) {
    lease.address = address;
    if (lease.rival == address) lease.rival.clear();
    return "";
  }
  lease.rival = address;
  lease.rival_us = lease_clock_.Now();
  return lease.address;
}

std::string FleetLeases::RivalOf(const std::string& robot) const {
  absl::MutexLock lock(&mutex_);
  const auto lease = leases_.find(robot);
  if (lease == leases_.end() || lease->second.rival.empty()) return "";
  return lease_clock_.Now() - lease->second.rival_us < int64_t{kLeaseMs} * 1000 ? lease->second.rival : "";
}

void FleetLeases::Renew(const std::string& robot, const std::string& incarnation,
                        const std::string& description, Decided decided) {
  News news{description, false, std::move(decided)};
  bool tell = false;
  {
    absl::MutexLock lock(&mutex_);
    Lease& lease = leases_[robot];
    lease.incarnation = incarnation;
    lease.seen_us = clock_.Now();
    lease.until_us = lease_clock_.Now() + int64_t{kLeaseMs} * 1000;
    if (lease.under_way) return lease.waiting.push_back(std::move(news));
    tell = lease.under_way = HasToBeTold(lease, news);
  }
  news.decided(tell);
}

void FleetLeases::Leave(const std::string& robot, const std::string& incarnation,
                        std::function<void(const Lost* lost)> decided) {
  const Lost lost{robot, clock_.Now()};
  News news{"", true, [lost, decided = std::move(decided)](bool tell) { decided(tell ? &lost : nullptr); }};
  bool tell = false;
  {
    absl::MutexLock lock(&mutex_);
    const auto found = leases_.find(robot);
    if (found != leases_.end() && found->second.incarnation == incarnation) {
      Lease& lease = found->second;
      lease.until_us = 0;
      if (lease.under_way) return lease.waiting.push_back(std::move(news));
      tell = lease.under_way = HasToBeTold(lease, news);
    }
  }
  news.decided(tell);
}

void FleetLeases::Untell(const std::string& robot) {
  absl::MutexLock lock(&mutex_);
  const auto lease = leases_.find(robot);
  if (lease != leases_.end() && !lease->second.under_way) lease->second.told.clear();
}

void FleetLeases::Told(const std::string& robot, const std::string& description, bool taken) {
  End(robot, [&](Lease* lease) {
    if (!taken) return;
    lease->online = true;
    lease->told = description;
  });
}

void FleetLeases::Expect(const std::string& robot, const std::string& address,
                         const std::string& incarnation) {
  absl::MutexLock lock(&mutex_);
  Lease& lease = leases_[robot];
  lease.address = address;
  lease.incarnation = incarnation;
  lease.until_us = lease_clock_.Now() + int64_t{kLeaseMs} * 1000;
  lease.online = true;
}

std::vector<FleetLeases::Lost> FleetLeases::TakeLost() {
  absl::MutexLock lock(&mutex_);
  std::vector<Lost> lost;
  for (auto it = leases_.begin(); it != leases_.end();) {
    Lease& lease = it->second;
    if (lease.under_way || lease.until_us > lease_clock_.Now()) {
      ++it;
    } else if (lease.online) {
      lease.under_way = true;
      lost.push_back({it->first, lease.seen_us});
      ++it;
    } else {
      it = leases_.erase(it);
    }
  }
  return lost;
}

void FleetLeases::ToldLost(const std::string& robot, bool taken) {
  End(robot, [&](Lease* lease) {
    if (taken) {
      lease->online = false;
    } else if (lease->until_us <= lease_clock_.Now()) {
      lease->until_us = lease_clock_.Now() + int64_t{kLeaseMs} * 1000;
    }
  });
}

// What was under way has ended. Those that waited for it are answered up to the first that has to tell the
// graph.
void FleetLeases::End(const std::string& robot, const std::function<void(Lease*)>& note) {
  std::vector<Decided> nothing_to_tell;
  Decided next;
  {
    absl::MutexLock lock(&mutex_);
    Lease& lease = leases_[robot];
    note(&lease);
    lease.under_way = false;
    auto it = lease.waiting.begin();
    for (; it != lease.waiting.end() && next == nullptr; ++it) {
      if (HasToBeTold(lease, *it)) {
        next = std::move(it->decided);
        lease.under_way = true;
      } else {
        nothing_to_tell.push_back(std::move(it->decided));
      }
    }
    lease.waiting.erase(lease.waiting.begin(), it);
  }
  for (const Decided& decided : nothing_to_tell) decided(false);
  if (next != nullptr) next(true);
}

}  // namespace docent::server
