// Prefix declarations of one document, in order; a prefix that is declared again counts at its last place. Private to
// this folder. One thread.
#ifndef DOCENT_GRAPH_RDF_FORMATS_DECLARED_PREFIXES_H_
#define DOCENT_GRAPH_RDF_FORMATS_DECLARED_PREFIXES_H_

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "graph/base/text.h"

namespace docent {

class DeclaredPrefixes {
 public:
  void Declare(std::string_view prefix, std::string iri) {
    const auto [known, is_new] = newest_.try_emplace(std::string(prefix), entries_.size());
    if (!is_new) {
      entries_[known->second].replaced = true;
      known->second = entries_.size();
    }
    entries_.push_back({std::string(prefix), std::move(iri), false});
  }

  // Null: not declared. Valid until the next Declare.
  const std::string* Find(std::string_view prefix) const {
    const auto known = newest_.find(ToAbsl(prefix));
    return known == newest_.end() ? nullptr : &entries_[known->second].iri;
  }

  // The first `most` declared prefixes, for hints.
  std::vector<std::string> Names(size_t most) const {
    std::vector<std::string> names;
    for (const Entry& entry : entries_) {
      if (names.size() == most) break;
      if (!entry.replaced) names.push_back(entry.prefix);
    }
    return names;
  }

  // Moves the list out; it is empty afterwards.
  std::vector<std::pair<std::string, std::string>> Take() {
    std::vector<std::pair<std::string, std::string>> out;
    for (Entry& entry : entries_) {
      if (!entry.replaced) out.emplace_back(std::move(entry.prefix), std::move(entry.iri));
    }
    entries_.clear();
    newest_.clear();
    return out;
  }

 private:
  struct Entry {
    std::string prefix, iri;
    bool replaced;  // by a later declaration
  };
  std::vector<Entry> entries_;
  absl::flat_hash_map<std::string, size_t> newest_;  // prefix → its last entry
};

}  // namespace docent

#endif  // DOCENT_GRAPH_RDF_FORMATS_DECLARED_PREFIXES_H_
