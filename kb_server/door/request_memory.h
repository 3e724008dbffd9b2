// The newest request ids with their answers, so that a batch that a client sends again is not applied again.
// Filled by replay too: it outlives a restart. Writer thread only.
#ifndef DOCENT_KB_SERVER_DOOR_REQUEST_MEMORY_H_
#define DOCENT_KB_SERVER_DOOR_REQUEST_MEMORY_H_

#include <deque>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "kb_server/door/inbox.h"

namespace docent::server {

// Shared by the memory and by snapshots that are being written.
struct RememberedRequest {
  std::string id;
  BatchOutcome outcome;
};
using RememberedRequestPtr = std::shared_ptr<const RememberedRequest>;

class RequestMemory {
 public:
  explicit RequestMemory(size_t limit) : limit_(limit) {}

  // The first answer to this id; null if it is not known (or empty). Valid until Remember.
  const BatchOutcome* Find(const std::string& request_id) const {
    auto it = by_id_.find(request_id);
    return request_id.empty() || it == by_id_.end() ? nullptr : &it->second->outcome;
  }

  // Empty ids and those that are known are not remembered; beyond the limit the oldest is forgotten.
  void Remember(const std::string& request_id, BatchOutcome outcome) {
    if (request_id.empty() || by_id_.contains(request_id)) return;
    auto remembered = std::make_shared<const RememberedRequest>(request_id, std::move(outcome));
    by_id_.emplace(remembered->id, remembered);
    order_.push_back(std::move(remembered));
    if (order_.size() <= limit_) return;
    by_id_.erase(order_.front()->id);
    order_.pop_front();
  }

  // All of them, the oldest first.
  std::vector<RememberedRequestPtr> All() const { return {order_.begin(), order_.end()}; }
  void Clear() {
    by_id_.clear();
    order_.clear();
  }

 private:
  const size_t limit_;
  absl::flat_hash_map<std::string_view, RememberedRequestPtr> by_id_;  // keys are views of the values
  std::deque<RememberedRequestPtr> order_;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_DOOR_REQUEST_MEMORY_H_
