// Set of rows with a fixed number of ids, found by hash; used by DISTINCT, GROUP BY and hash joins. One flat
// array, no allocation for each row. One thread.
#ifndef DOCENT_GRAPH_SPARQL_RUN_ROW_SET_H_
#define DOCENT_GRAPH_SPARQL_RUN_ROW_SET_H_

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "graph/rdf/term_id.h"

namespace docent::sparql {

// Clears the vector, and frees its memory unless it is small: operators that restart for each row reuse it.
template <typename T>
void Empty(std::vector<T>* values) {
  constexpr size_t kLittle = 4096;  // bytes
  if (values->capacity() * sizeof(T) > kLittle) {
    *values = std::vector<T>();
  } else {
    values->clear();
  }
}

class RowSet {
 public:
  explicit RowSet(size_t width) : width_(width) {}

  // The number of the row (in order of first insertion) and whether it is new. `row` holds `width` ids.
  std::pair<uint32_t, bool> Insert(const TermId* row) {
    if ((size_ + 1) * 2 > heads_.size()) Grow();
    const size_t mask = heads_.size() - 1;
    for (size_t i = Hash(row) & mask;; i = (i + 1) & mask) {
      const uint32_t at = heads_[i];
      if (at == 0) {
        heads_[i] = ++size_;
        for (size_t n = 0; n < width_; ++n) cells_.push_back(row[n]);
        return {size_ - 1, true};
      }
      if (Is(at - 1, row)) return {at - 1, false};
    }
  }
  // The number of the row, or npos.
  uint32_t Find(const TermId* row) const {
    if (size_ == 0) return npos;
    const size_t mask = heads_.size() - 1;
    for (size_t i = Hash(row) & mask;; i = (i + 1) & mask) {
      const uint32_t at = heads_[i];
      if (at == 0) return npos;
      if (Is(at - 1, row)) return at - 1;
    }
  }
  // Reserves space for `rows` rows.
  void Reserve(size_t rows) {
    cells_.reserve(rows * width_);
    if (rows * 2 > heads_.size()) Rehash(std::bit_ceil(rows * 2));
  }
  // True if row `number` equals `row`.
  bool Is(uint32_t number, const TermId* row) const {
    const TermId* const cells = Row(number);
    for (size_t i = 0; i < width_; ++i) {
      if (cells[i] != row[i]) return false;
    }
    return true;
  }
  const TermId* Row(uint32_t number) const { return cells_.data() + number * width_; }
  uint32_t size() const { return size_; }
  // Approximate memory of one more row.
  size_t bytes_a_row() const { return width_ * sizeof(TermId) + 3 * sizeof(uint32_t); }
  void Clear() {
    size_ = 0;
    Empty(&cells_);
    Empty(&heads_);
  }

  static constexpr uint32_t npos = ~uint32_t{0};

 private:
  // Mixes both halves of the product of two words, which depend on all bits (the mixing step of wyhash, Wang
  // Yi 2019).
  uint64_t Hash(const TermId* row) const {
    __extension__ using Product = unsigned __int128;
    uint64_t hash = 0x9E3779B97F4A7C15;
    for (size_t i = 0; i < width_; ++i) {
      const Product product = Product{hash ^ row[i].bits()} * 0xD1B54A32D192ED03;
      hash = static_cast<uint64_t>(product) ^ static_cast<uint64_t>(product >> 64);
    }
    return hash;
  }
  void Grow() { Rehash(std::max<size_t>(16, heads_.size() * 2)); }
  void Rehash(size_t heads) {
    heads_.assign(heads, 0);
    for (uint32_t n = 0; n < size_; ++n) {
      size_t i = Hash(Row(n)) & (heads_.size() - 1);
      while (heads_[i] != 0) i = (i + 1) & (heads_.size() - 1);
      heads_[i] = n + 1;
    }
  }

  size_t width_;
  uint32_t size_ = 0;
  std::vector<TermId> cells_;
  std::vector<uint32_t> heads_;  // open addressing: row number + 1; a power of two
};

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_RUN_ROW_SET_H_
