// Short names of IRIs for people: prefixed names as Turtle and SPARQL write them, so that what is printed can be pasted into
// a query. Value; any thread.
#ifndef DOCENT_GRAPH_RDF_IRI_NAMES_H_
#define DOCENT_GRAPH_RDF_IRI_NAMES_H_

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "graph/rdf/term.h"

namespace docent {

// Whether `prefix:local` is a prefixed name that reads back as it stands here, without escapes.
bool IsPrefixedName(std::string_view prefix, std::string_view local);

class IriNames {
 public:
  // Without prefixes: every IRI whole, in <>.
  IriNames() = default;
  // With the well-known prefixes of vocabulary.h.
  static const IriNames& WellKnown();

  // `prefix` without ':'. Nothing happens if the name is taken, or if the prefix could not be declared.
  void Add(std::string_view prefix, std::string_view name_space);
  const std::vector<std::pair<std::string, std::string>>& prefixes() const { return prefixes_; }

  // The IRI by the prefix with the longest namespace; in <> where no prefix gives a valid name.
  std::string Iri(std::string_view iri) const;
  // A term in the way of Turtle: numbers and truth values bare, other literals with quotes and escapes.
  std::string Show(const Term& term) const;
  // A text for people in which every <iri> outside of quotes that has a name is replaced by it.
  std::string InText(std::string_view text) const;

 private:
  std::vector<std::pair<std::string, std::string>> prefixes_;
};

}  // namespace docent

#endif  // DOCENT_GRAPH_RDF_IRI_NAMES_H_
