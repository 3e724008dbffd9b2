// The newest request ids with their answers, so that a batch that a client sends again is not applied again.
// Filled by replay too: it outlives a restart. Writer thread only.
#ifndef DOCENT_KB_SERVER_DOOR_REQUEST_MEMORY_H_
#define DOCENT_KB_SERVER_DOOR_REQUEST_MEMORY_H_

#include <algorithm>
#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "graph/base/fingerprint.h"
#include "graph/base/text_limits.h"
#include "graph/store/write_batch.h"
#include "kb_server/door/inbox.h"

namespace docent::server {

// A request_id as a client may choose it; INVALID_ARGUMENT names the limit.
inline absl::Status CheckRequestId(const std::string& request_id) {
  if (request_id.size() <= kTextLimits.request_id_bytes) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat("request_id has ", request_id.size(),
                                                 " bytes; the limit request_id_bytes is ",
                                                 kTextLimits.request_id_bytes));
}

// What a request of that kind asked for, in parts; never 0. The same in every process.
inline uint64_t RequestDigest(std::string_view kind, const std::vector<std::string_view>& parts) {
  uint64_t digest = Fingerprint(kind);
  for (const std::string_view part : parts) {
    digest = Fingerprint(absl::StrCat("/", part.size(), "/"), digest);
    digest = Fingerprint(part, digest);
  }
  return std::max<uint64_t>(digest, 1);
}

// Shared by the memory and by snapshots that are being written.
struct RememberedRequest {
  std::string id;
  BatchOutcome outcome;
  uint64_t digest = 0;  // WriteBatch::request_digest; 0: not known

  // Whether a batch of this id is that request again. Of one whose digest is not known, only the kind can be told.
  bool IsRepeatedBy(const WriteBatch& batch) const {
    if (digest != 0 && batch.request_digest != 0) return digest == batch.request_digest;
    return batch.run_requests.empty() == outcome.started.empty();
  }
};
using RememberedRequestPtr = std::shared_ptr<const RememberedRequest>;

class RequestMemory {
 public:
  explicit RequestMemory(size_t limit) : limit_(limit) {}

  // The first request of this id; null if it is not known (or empty). Valid until Remember.
  const RememberedRequest* Find(const std::string& request_id) const {
    auto it = by_id_.find(request_id);
    return request_id.empty() || it == by_id_.end() ? nullptr : it->second.get();
  }

  // Empty ids and those that are known are not remembered; beyond the limit the oldest is forgotten.
  void Remember(const std::string& request_id, BatchOutcome outcome, uint64_t digest = 0) {
    if (request_id.empty() || by_id_.contains(request_id)) return;
    auto remembered =
        std::make_shared<const RememberedRequest>(RememberedRequest{request_id, std::move(outcome), digest});
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
