// Numbers by name. It keeps views of the names, which must outlive it. Value; one thread.
#ifndef DOCENT_GRAPH_SPARQL_SYNTAX_NAME_NUMBERS_H_
#define DOCENT_GRAPH_SPARQL_SYNTAX_NAME_NUMBERS_H_

#include <array>
#include <string_view>
#include <utility>

#include "absl/container/flat_hash_map.h"

namespace docent::sparql {

class NameNumbers {
 public:
  // Gives `name` this number if it has none yet. Its number, and whether it is new.
  std::pair<int, bool> Add(std::string_view name, int number) {
    if (const int* known = Find(name)) return {*known, false};
    Put(name, number);
    return {number, true};
  }
  // Null: `name` has no number.
  int* Find(std::string_view name) {
    for (size_t i = 0; i < count_; ++i) {
      if (few_[i].Is(name)) return &few_[i].number;
    }
    if (rest_.empty()) return nullptr;
    const auto it = rest_.find(name);
    return it == rest_.end() ? nullptr : &it->second;
  }
  // Gives `name` this number, whatever it has.
  void Set(std::string_view name, int number) {
    if (int* known = Find(name)) {
      *known = number;
    } else {
      Put(name, number);
    }
  }

 private:
  void Put(std::string_view name, int number) {
    if (count_ < kFew) {
      few_[count_++] = {name.data(), name.size(), number};
    } else {
      rest_.emplace(name, number);
    }
  }

  static constexpr size_t kFew = 16;  // so many are found soonest by looking at each
  struct Entry {  // of plain members, for nothing is to be set: what is beyond count_ is never read
    const char* name;
    size_t size;
    int number;
    // Most differ in size or in the first character.
    bool Is(std::string_view other) const {
      return size == other.size() &&
             (size == 0 || (*name == other[0] && std::string_view(name, size) == other));
    }
  };
  std::array<Entry, kFew> few_;
  size_t count_ = 0;
  absl::flat_hash_map<std::string_view, int> rest_;
};

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_SYNTAX_NAME_NUMBERS_H_
