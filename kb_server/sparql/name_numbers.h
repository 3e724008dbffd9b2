// Numbers by name. It keeps views of the names, which must outlive it. Value; one thread.
#ifndef DOCENT_KB_SERVER_SPARQL_NAME_NUMBERS_H_
#define DOCENT_KB_SERVER_SPARQL_NAME_NUMBERS_H_

#include <string_view>
#include <utility>

#include "absl/container/flat_hash_map.h"
#include "absl/container/inlined_vector.h"

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
    for (auto& [known, number] : few_) {
      if (Same(known, name)) return &number;
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
  // Most differ in size or in the first character.
  static bool Same(std::string_view a, std::string_view b) {
    return a.size() == b.size() && (a.empty() || (a[0] == b[0] && a == b));
  }
  void Put(std::string_view name, int number) {
    if (few_.size() < kFew) {
      few_.emplace_back(name, number);
    } else {
      rest_.emplace(name, number);
    }
  }

  static constexpr size_t kFew = 16;  // so many are found soonest by looking at each
  absl::InlinedVector<std::pair<std::string_view, int>, kFew> few_;
  absl::flat_hash_map<std::string_view, int> rest_;
};

}  // namespace docent::sparql

#endif  // DOCENT_KB_SERVER_SPARQL_NAME_NUMBERS_H_
