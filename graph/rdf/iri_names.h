// Short names of IRIs for people: prefixed names as in Turtle and SPARQL, so that printed names can be pasted
// into a query. Value; any thread.
#ifndef DOCENT_GRAPH_RDF_IRI_NAMES_H_
#define DOCENT_GRAPH_RDF_IRI_NAMES_H_

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "absl/container/flat_hash_set.h"
#include "graph/rdf/term.h"

namespace docent {

// True if `prefix:local` is a prefixed name that parses back unchanged, without escapes.
bool IsPrefixedName(std::string_view prefix, std::string_view local);

class IriNames {
 public:
  // Without prefixes: every IRI whole, in <>.
  IriNames() = default;
  // With the well-known prefixes of vocabulary.h.
  static const IriNames& WellKnown();

  // `prefix` without ':'. Ignored if the prefix is taken or is not a valid prefix.
  void Add(std::string_view prefix, std::string_view name_space);
  const std::vector<std::pair<std::string, std::string>>& prefixes() const { return prefixes_; }

  // The IRI with the prefix of the longest matching namespace; in <> if no prefix gives a valid name.
  std::string Iri(std::string_view iri) const;
  // A term in Turtle syntax: numbers and booleans bare, other literals with quotes and escapes.
  std::string Show(const Term& term) const;
  // Replaces every <iri> outside quotes by its short name, if it has one. For texts for people.
  std::string InText(std::string_view text) const;

 private:
  std::vector<std::pair<std::string, std::string>> prefixes_;
  absl::flat_hash_set<std::string> taken_;  // names of them
};

}  // namespace docent

#endif  // DOCENT_GRAPH_RDF_IRI_NAMES_H_
