#include "kb_server/door/fair_shares.h"

#include <algorithm>

namespace docent::server {

void FairShares::Enter(const Client* client) {
  const absl::Duration first = now_ - credit_;
  const auto [place, fresh] = shares_.try_emplace(client, Share{first, credit_, 0});
  Share& share = place->second;
  if (share.pieces++ > 0) return;
  if (share.time < first) {
    share.time = first;
    share.credit = credit_;
  }
  ++active_;
}

void FairShares::Leave(const Client* client) {
  const auto place = shares_.find(client);
  if (--place->second.pieces > 0) return;
  --active_;
  // No client has work: what each has had before does not count any more.
  if (active_ == 0) {
    shares_.clear();
  } else if (place->second.time <= now_ - credit_) {
    shares_.erase(place);
  } else if (shares_.size() - active_ > kIdleKept) {
    absl::erase_if(shares_, [](const auto& one) { return one.second.pieces == 0; });
  }
}

void FairShares::Charge(const Client* client, absl::Duration used) {
  Share& share = shares_.at(client);
  const absl::Duration paid = std::min(used, share.credit);
  share.credit -= paid;
  share.time += used + paid;
  now_ += used / static_cast<int64_t>(active_);
}

absl::Duration FairShares::TimeOf(const Client* client) const {
  return shares_.at(client).time;
}

}  // namespace docent::server
