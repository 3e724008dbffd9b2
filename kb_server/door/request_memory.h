// The newest request ids with their answers, so that a batch that a client sends again is not applied again.
// Filled by replay too: it outlives a restart. Writer thread only.
#ifndef DOCENT_KB_SERVER_DOOR_REQUEST_MEMORY_H_
#define DOCENT_KB_SERVER_DOOR_REQUEST_MEMORY_H_

#include <deque>
#include <string>

#include "absl/container/flat_hash_map.h"
#include "kb_server/door/inbox.h"

namespace docent {

class RequestMemory {
 public:
  explicit RequestMemory(size_t limit) : limit_(limit) {}

  // The first answer to this id; null if it is not known (or empty). Valid until Remember.
  const BatchOutcome* Find(const std::string& request_id) const {
    auto it = outcomes_.find(request_id);
    return request_id.empty() || it == outcomes_.end() ? nullptr : &it->second;
  }

  // Empty ids are not remembered; beyond the limit the oldest is forgotten.
  void Remember(const std::string& request_id, BatchOutcome outcome) {
    if (request_id.empty()) return;
    if (!outcomes_.insert_or_assign(request_id, std::move(outcome)).second) return;
    order_.push_back(request_id);
    if (order_.size() <= limit_) return;
    outcomes_.erase(order_.front());
    order_.pop_front();
  }

 private:
  const size_t limit_;
  absl::flat_hash_map<std::string, BatchOutcome> outcomes_;
  std::deque<std::string> order_;
};

}  // namespace docent

#endif  // DOCENT_KB_SERVER_DOOR_REQUEST_MEMORY_H_
