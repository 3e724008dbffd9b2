// Rows of a subscribed answer that have not lasted long enough to be told. Not thread-safe.
#ifndef DOCENT_KB_SERVER_SUBSCRIPTIONS_YOUNG_ROWS_H_
#define DOCENT_KB_SERVER_SUBSCRIPTIONS_YOUNG_ROWS_H_

#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "absl/container/flat_hash_set.h"
#include "absl/container/inlined_vector.h"
#include "graph/base/clock.h"
#include "graph/rdf/term_id.h"

namespace docent::server {

class YoungRows {
 public:
  using Row = absl::InlinedVector<TermId, 4>;

  // The row, which is not there, is so since this time.
  void Add(const Row& row, TimeMicros since_us) {
    since_.emplace(row, since_us);
    by_time_[since_us].insert(row);
  }
  // Whether it was there.
  bool Remove(const Row& row) {
    const auto found = since_.find(row);
    if (found == since_.end()) return false;
    const auto same_time = by_time_.find(found->second);
    same_time->second.erase(row);
    if (same_time->second.empty()) by_time_.erase(same_time);
    since_.erase(found);
    return true;
  }
  bool Contains(const Row& row) const { return since_.contains(row); }

  std::optional<TimeMicros> oldest_us() const {
    return by_time_.empty() ? std::nullopt : std::optional<TimeMicros>(by_time_.begin()->first);
  }
  // Removes and returns those that are so since then or before.
  std::vector<Row> TakeUntil(TimeMicros since_us) {
    std::vector<Row> old;
    while (!by_time_.empty() && by_time_.begin()->first <= since_us) {
      for (const Row& row : by_time_.begin()->second) {
        since_.erase(row);
        old.push_back(row);
      }
      by_time_.erase(by_time_.begin());
    }
    return old;
  }
  // Gives every row another name; two that get the same are the older of them.
  template <typename NewName>
  void Rename(NewName new_name) {
    const auto before = std::exchange(by_time_, {});
    since_.clear();
    for (const auto& [since_us, rows] : before) {
      for (const Row& row : rows) {
        if (Row now = new_name(row); !Contains(now)) Add(now, since_us);
      }
    }
  }

 private:
  absl::flat_hash_map<Row, TimeMicros> since_;
  std::map<TimeMicros, absl::flat_hash_set<Row>> by_time_;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_SUBSCRIPTIONS_YOUNG_ROWS_H_
