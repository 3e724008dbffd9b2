// Budget of what is made for clients and not taken by them, of all streams and answers together (Limits::streams_bytes).
//
// Each stream is bounded by itself; many of them together are bounded here: where they hold too much, those that hold the
// most are cut, and of equal ones those that have taken nothing for the longest time. A thread of its own cuts, since a
// stream may be cut while another grows, with its own mutex held. Thread-safe.
#ifndef DOCENT_KB_SERVER_DOOR_SEND_BUDGET_H_
#define DOCENT_KB_SERVER_DOOR_SEND_BUDGET_H_

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/container/flat_hash_map.h"
#include "absl/status/status.h"
#include "absl/synchronization/mutex.h"

namespace docent::server {

class SendBudget {
 public:
  explicit SendBudget(size_t limit);
  // After all shares.
  ~SendBudget();
  SendBudget(const SendBudget&) = delete;
  SendBudget& operator=(const SendBudget&) = delete;

  // What one stream holds.
  class Share {
   public:
    // `cut` ends the stream with the status that it is given, RESOURCE_EXHAUSTED. It is called from the budget's thread, at
    // most once, and not after the destructor has begun, which waits for it. `budget` may be null: nothing is counted.
    Share(SendBudget* budget, std::function<void(const absl::Status&)> cut);
    ~Share();
    Share(const Share&) = delete;
    Share& operator=(const Share&) = delete;

    // May be called with the stream's mutex held.
    void Add(size_t bytes);
    void Release(size_t bytes);

   private:
    friend class SendBudget;
    SendBudget* const budget_;
    uint64_t id_ = 0;
    const std::function<void(const absl::Status&)> cut_;
    std::atomic<size_t> bytes_{0};
    std::atomic<int64_t> since_{0};  // when it last took something, or began to hold something
    bool is_cut_ = false;            // of the budget's thread
  };

  size_t taken() const { return taken_.load(std::memory_order_relaxed); }
  uint64_t cut() const { return cut_.load(std::memory_order_relaxed); }

 private:
  void Loop();
  // Ids of the shares to cut so that enough is free, as far as is known.
  std::vector<uint64_t> Choose() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  const size_t limit_;
  std::atomic<size_t> taken_{0};
  std::atomic<uint64_t> cut_{0};
  std::atomic<bool> beyond_{false};  // set by who goes beyond the limit
  absl::Mutex mutex_;
  absl::flat_hash_map<uint64_t, Share*> shares_ ABSL_GUARDED_BY(mutex_);  // by id
  uint64_t last_id_ ABSL_GUARDED_BY(mutex_) = 0;
  Share* cutting_ ABSL_GUARDED_BY(mutex_) = nullptr;
  bool ending_ ABSL_GUARDED_BY(mutex_) = false;
  std::thread thread_;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_DOOR_SEND_BUDGET_H_
