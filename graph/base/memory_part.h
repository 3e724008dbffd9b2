// Part of a task's memory that is given back as one: a parsed text, a plan, the rows of a run.
#ifndef DOCENT_GRAPH_BASE_MEMORY_PART_H_
#define DOCENT_GRAPH_BASE_MEMORY_PART_H_

#include <cstddef>
#include <utility>

#include "graph/base/memory_budget.h"

namespace docent {

// One thread.
class MemoryPart {
 public:
  // `use` must outlive this object.
  explicit MemoryPart(MemoryUse* use) : use_(use) {}
  ~MemoryPart() { Reset(); }
  MemoryPart(MemoryPart&& other) noexcept : use_(other.use_), used_(std::exchange(other.used_, 0)) {}
  MemoryPart& operator=(MemoryPart&&) = delete;

  // As MemoryUse::Add and Release.
  bool Add(size_t bytes) {
    used_ += bytes;
    return use_->Add(bytes);
  }
  void Release(size_t bytes) {
    used_ -= bytes;
    use_->Release(bytes);
  }
  void Reset() {
    if (used_ == 0) return;
    use_->Release(std::exchange(used_, 0));
    use_->Settle();
  }
  // Leaves what is counted to the owner of the use. Returns how much that is.
  size_t Detach() { return std::exchange(used_, 0); }
  size_t used() const { return used_; }

 private:
  MemoryUse* use_;
  size_t used_ = 0;
};

}  // namespace docent

#endif  // DOCENT_GRAPH_BASE_MEMORY_PART_H_
