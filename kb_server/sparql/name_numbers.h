// Numbers by name. Value; one thread.
#ifndef DOCENT_KB_SERVER_SPARQL_NAME_NUMBERS_H_
#define DOCENT_KB_SERVER_SPARQL_NAME_NUMBERS_H_

#include <string>
#include <string_view>
#include <utility>

#include "absl/container/flat_hash_map.h"
#include "absl/container/inlined_vector.h"

namespace docent::sparql {

class NameNumbers {
 public:
  // Gives `name` this number if it has none yet. Its number, and whether it is new.
  std::pair<int, bool> Add(std::string_view name, int number) {
    for (const auto& [known, its_number] : few_) {
      if (known == name) return {its_number, false};
    }
    if (few_.size() < kFew) {
      few_.emplace_back(name, number);
      return {number, true};
    }
    const auto [it, added] = rest_.emplace(name, number);
    return {it->second, added};
  }

 private:
  static constexpr size_t kFew = 16;  // so many are found soonest by looking at each
  absl::InlinedVector<std::pair<std::string, int>, kFew> few_;
  absl::flat_hash_map<std::string, int> rest_;
};

}  // namespace docent::sparql

#endif  // DOCENT_KB_SERVER_SPARQL_NAME_NUMBERS_H_
