// Map from names to numbers. It keeps views of the names, which must outlive it. Value; one thread.
#ifndef DOCENT_GRAPH_SPARQL_SYNTAX_NAME_NUMBERS_H_
#define DOCENT_GRAPH_SPARQL_SYNTAX_NAME_NUMBERS_H_

#include <array>
#include <string_view>
#include <utility>

#include "absl/container/flat_hash_map.h"

namespace docent::sparql {

class NameNumbers {
 public:
  // Gives `name` this number unless it has one. Returns its number, and whether it is new.
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
  // Sets the number of `name`, whether it has one or not.
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

  static constexpr size_t kFew = 16;  // up to this many, linear search is fastest
  struct Entry {  // trivial members, left uninitialised: entries beyond count_ are never read
    const char* name;
    size_t size;
    int number;
    // Most names differ in size or in the first character.
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
