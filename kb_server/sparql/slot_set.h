// A set of slots (numbers of variables in a plan). Value; one thread.
#ifndef DOCENT_KB_SERVER_SPARQL_SLOT_SET_H_
#define DOCENT_KB_SERVER_SPARQL_SLOT_SET_H_

#include <algorithm>
#include <cstdint>
#include <vector>

namespace docent::sparql {

class SlotSet {
 public:
  void Add(int slot) {
    const size_t word = static_cast<size_t>(slot) / 64;
    if (word >= words_.size()) words_.resize(word + 1);
    words_[word] |= uint64_t{1} << (slot % 64);
  }
  void Remove(int slot) {
    const size_t word = static_cast<size_t>(slot) / 64;
    if (word < words_.size()) words_[word] &= ~(uint64_t{1} << (slot % 64));
  }
  bool Contains(int slot) const {
    const size_t word = static_cast<size_t>(slot) / 64;
    return word < words_.size() && (words_[word] >> (slot % 64) & 1) != 0;
  }
  bool empty() const {
    return std::all_of(words_.begin(), words_.end(), [](uint64_t w) { return w == 0; });
  }
  bool Within(const SlotSet& other) const { return Minus(other).empty(); }
  bool Meets(const SlotSet& other) const { return !And(other).empty(); }

  SlotSet& operator|=(const SlotSet& other) {
    if (other.words_.size() > words_.size()) words_.resize(other.words_.size());
    for (size_t i = 0; i < other.words_.size(); ++i) words_[i] |= other.words_[i];
    return *this;
  }
  SlotSet Or(const SlotSet& other) const { return SlotSet(*this) |= other; }
  SlotSet And(const SlotSet& other) const {
    SlotSet out = *this;
    for (size_t i = 0; i < out.words_.size(); ++i)
      out.words_[i] &= i < other.words_.size() ? other.words_[i] : 0;
    return out;
  }
  SlotSet Minus(const SlotSet& other) const {
    SlotSet out = *this;
    for (size_t i = 0; i < std::min(out.words_.size(), other.words_.size()); ++i)
      out.words_[i] &= ~other.words_[i];
    return out;
  }
  // The members in ascending order.
  std::vector<int> List() const {
    std::vector<int> out;
    for (size_t i = 0; i < words_.size(); ++i) {
      for (uint64_t w = words_[i]; w != 0; w &= w - 1)
        out.push_back(static_cast<int>(i * 64) + __builtin_ctzll(w));
    }
    return out;
  }

 private:
  std::vector<uint64_t> words_;
};

}  // namespace docent::sparql

#endif  // DOCENT_KB_SERVER_SPARQL_SLOT_SET_H_
