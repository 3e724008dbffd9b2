// Hash table from terms to their numbers in a dictionary: one thread writes, any number read without locks.
// Private to this folder.
#ifndef DOCENT_GRAPH_RDF_TERM_TABLE_H_
#define DOCENT_GRAPH_RDF_TERM_TABLE_H_

#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <new>
#include <optional>
#include <type_traits>
#include <vector>

namespace docent {

// Zeroed memory that the system provides only when it is written, so that no caller waits for megabytes at
// once. To be freed with std::free.
template <typename T>
T* Zeroed(uint64_t count) {
  static_assert(std::is_trivially_copyable_v<T>);
  void* const memory = std::calloc(count, sizeof(T));
  if (memory == nullptr) throw std::bad_alloc();
  return static_cast<T*>(memory);
}

// Open addressing over atomic slots: 32 bits of hash above index + 1, all 0 for empty. The hash bits in a
// slot also give its place, so growing reads no entry. The writer publishes a slot after its entry.
//
// A full table is followed by one twice as large, and each insert then moves a few slots over: no caller
// waits for a copy of the whole table. Meanwhile readers look into both. Old tables are kept, since a reader
// may still use them (together they are no larger than the newest).
//
// A removal closes the gap, so that slots move back. A reader that found nothing while slots moved looks again.
class TermTable {
 public:
  TermTable() { current_.store(NewTable(kFirstSlots, nullptr), std::memory_order_release); }

  template <typename Matches>  // bool Matches(index)
  std::optional<uint64_t> Find(uint32_t hash, Matches matches) const {
    while (true) {
      const uint64_t moves = moves_.load(std::memory_order_acquire);
      const std::optional<uint64_t> found = FindOnce(hash, matches);
      if (found || (moves % 2 == 0 && moves_.load(std::memory_order_acquire) == moves)) return found;
    }
  }

  // Writer thread only. The index must be there under this hash.
  void Remove(uint32_t hash, uint64_t index) {
    Table* table = tables_.back().get();
    while (table->older.load(std::memory_order_relaxed) != nullptr) MoveSome(table);
    const uint64_t wanted = static_cast<uint64_t>(hash) << 32 | (index + 1);
    uint64_t gap = hash & table->mask;
    while (table->Slot(gap).load(std::memory_order_relaxed) != wanted) gap = (gap + 1) & table->mask;
    moves_.fetch_add(1, std::memory_order_acq_rel);  // odd: slots move
    for (uint64_t i = (gap + 1) & table->mask;; i = (i + 1) & table->mask) {
      const uint64_t slot = table->Slot(i).load(std::memory_order_relaxed);
      if (slot == 0) break;
      const uint64_t home = (slot >> 32) & table->mask;
      if (((i - home) & table->mask) < ((i - gap) & table->mask)) continue;  // the gap is before its home
      table->Slot(gap).store(slot, std::memory_order_release);
      gap = i;
    }
    table->Slot(gap).store(0, std::memory_order_release);
    --count_;
    moves_.fetch_add(1, std::memory_order_release);
  }

  // Writer thread only.
  void Insert(uint32_t hash, uint64_t index) {
    Table* table = tables_.back().get();
    if ((count_ + 1) * 3 > (table->mask + 1) * 2) {
      table = NewTable((table->mask + 1) * 2, table);
      current_.store(table, std::memory_order_release);
      moved_ = 0;
    }
    MoveSome(table);
    ++count_;
    Place(*table, static_cast<uint64_t>(hash) << 32 | (index + 1));
  }

  size_t bytes() const { return 2 * sizeof(uint64_t) * (current_.load(std::memory_order_acquire)->mask + 1); }

 private:
  template <typename Matches>
  std::optional<uint64_t> FindOnce(uint32_t hash, Matches matches) const {
    const Table* table = current_.load(std::memory_order_acquire);
    while (table != nullptr) {
      // Loaded before the search of this table: if the move is complete by then, the search sees all slots.
      const Table* older = table->older.load(std::memory_order_acquire);
      for (uint64_t i = hash & table->mask;; i = (i + 1) & table->mask) {
        const uint64_t slot = table->Slot(i).load(std::memory_order_acquire);
        if (slot == 0) break;
        if (slot >> 32 == hash && matches((slot & kIndexMask) - 1)) return (slot & kIndexMask) - 1;
      }
      table = older;
    }
    return std::nullopt;
  }

  static constexpr uint64_t kFirstSlots = 4096;
  static constexpr uint64_t kIndexMask = 0xFFFFFFFF;
  // Slots moved by one insert. Two would be enough to finish the move before the larger table is full.
  static constexpr uint64_t kStep = 16;

  struct Table {
    Table(uint64_t slot_count, const Table* before)
        : mask(slot_count - 1), slots(Zeroed<uint64_t>(slot_count), std::free), older(before) {}
    std::atomic_ref<uint64_t> Slot(uint64_t i) const { return std::atomic_ref(slots.get()[i]); }

    const uint64_t mask;
    const std::unique_ptr<uint64_t, decltype(&std::free)> slots;
    std::atomic<const Table*> older;  // table whose slots are still being moved; null: none
  };

  Table* NewTable(uint64_t slot_count, const Table* older) {
    tables_.push_back(std::make_unique<Table>(slot_count, older));
    return tables_.back().get();
  }

  void MoveSome(Table* to) {
    const Table* from = to->older.load(std::memory_order_relaxed);
    if (from == nullptr) return;
    for (const uint64_t end = moved_ + kStep; moved_ < end; ++moved_) {
      const uint64_t slot = from->Slot(moved_).load(std::memory_order_relaxed);
      if (slot != 0) Place(*to, slot);
    }
    if (moved_ > from->mask) to->older.store(nullptr, std::memory_order_release);
  }

  static void Place(const Table& table, uint64_t slot) {
    uint64_t i = (slot >> 32) & table.mask;
    while (table.Slot(i).load(std::memory_order_relaxed) != 0) i = (i + 1) & table.mask;
    table.Slot(i).store(slot, std::memory_order_release);
  }

  std::atomic<const Table*> current_{nullptr};
  std::vector<std::unique_ptr<Table>> tables_;  // writer; the last is the current one
  uint64_t count_ = 0;                          // writer
  uint64_t moved_ = 0;                          // writer: slots of the table before the current one
  std::atomic<uint64_t> moves_{0};              // removals begun and ended
};

}  // namespace docent

#endif  // DOCENT_GRAPH_RDF_TERM_TABLE_H_
