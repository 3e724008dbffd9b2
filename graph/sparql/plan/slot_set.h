// A set of slots (numbers of variables in a plan). Value; one thread.
#ifndef DOCENT_GRAPH_SPARQL_PLAN_SLOT_SET_H_
#define DOCENT_GRAPH_SPARQL_PLAN_SLOT_SET_H_

#include <algorithm>
#include <bit>
#include <cstdint>
#include <vector>

namespace docent::sparql {

class SlotSet {
 public:
  SlotSet() = default;
  SlotSet(const SlotSet& other) : first_(other.first_) {
    if (!other.more_.empty()) more_ = other.more_;
  }
  SlotSet(SlotSet&&) = default;
  SlotSet& operator=(const SlotSet& other) {
    first_ = other.first_;
    if (!more_.empty() || !other.more_.empty()) more_ = other.more_;
    return *this;
  }
  SlotSet& operator=(SlotSet&&) = default;
  ~SlotSet() = default;

  void Add(int slot) { WordOf(slot) |= Bit(slot); }
  void Remove(int slot) {
    if (Contains(slot)) WordOf(slot) &= ~Bit(slot);
  }
  bool Contains(int slot) const {
    if (slot < 64) return (first_ & Bit(slot)) != 0;
    const size_t word = static_cast<size_t>(slot) / 64 - 1;
    return word < more_.size() && (more_[word] & Bit(slot)) != 0;
  }
  bool empty() const {
    return first_ == 0 && std::all_of(more_.begin(), more_.end(), [](uint64_t w) { return w == 0; });
  }
  bool Within(const SlotSet& other) const {
    if ((first_ & ~other.first_) != 0) return false;
    for (size_t i = 0; i < more_.size(); ++i) {
      if ((more_[i] & ~(i < other.more_.size() ? other.more_[i] : 0)) != 0) return false;
    }
    return true;
  }
  bool Meets(const SlotSet& other) const {
    if ((first_ & other.first_) != 0) return true;
    for (size_t i = 0; i < std::min(more_.size(), other.more_.size()); ++i) {
      if ((more_[i] & other.more_[i]) != 0) return true;
    }
    return false;
  }

  SlotSet& operator|=(const SlotSet& other) {
    first_ |= other.first_;
    if (other.more_.empty()) return *this;
    if (other.more_.size() > more_.size()) more_.resize(other.more_.size());
    for (size_t i = 0; i < other.more_.size(); ++i) more_[i] |= other.more_[i];
    return *this;
  }
  SlotSet Or(const SlotSet& other) const { return SlotSet(*this) |= other; }
  SlotSet And(const SlotSet& other) const {
    SlotSet out = *this;
    out.first_ &= other.first_;
    for (size_t i = 0; i < out.more_.size(); ++i) out.more_[i] &= i < other.more_.size() ? other.more_[i] : 0;
    return out;
  }
  SlotSet Minus(const SlotSet& other) const {
    SlotSet out = *this;
    out.first_ &= ~other.first_;
    for (size_t i = 0; i < std::min(out.more_.size(), other.more_.size()); ++i)
      out.more_[i] &= ~other.more_[i];
    return out;
  }
  // Memory beyond its own size.
  size_t bytes() const { return more_.capacity() * sizeof(uint64_t); }
  // The members in ascending order.
  std::vector<int> List() const {
    std::vector<int> out;
    out.reserve(static_cast<size_t>(std::popcount(first_)));
    AddMembers(first_, 0, &out);
    for (size_t i = 0; i < more_.size(); ++i) AddMembers(more_[i], static_cast<int>(i + 1) * 64, &out);
    return out;
  }

 private:
  static uint64_t Bit(int slot) { return uint64_t{1} << (slot % 64); }
  static void AddMembers(uint64_t word, int begin, std::vector<int>* out) {
    for (uint64_t w = word; w != 0; w &= w - 1) out->push_back(begin + __builtin_ctzll(w));
  }
  uint64_t& WordOf(int slot) {
    if (slot < 64) return first_;
    const size_t word = static_cast<size_t>(slot) / 64 - 1;
    if (word >= more_.size()) more_.resize(word + 1);
    return more_[word];
  }

  uint64_t first_ = 0;          // slots 0 to 63
  std::vector<uint64_t> more_;  // slots from 64 on; few queries have them
};

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_PLAN_SLOT_SET_H_
