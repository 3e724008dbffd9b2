// Formatter of facts and conditions as one line of SPARQL for people, with values in place of variables. Any
// thread.
#ifndef DOCENT_REASONER_EXPLAIN_DISPLAY_H_
#define DOCENT_REASONER_EXPLAIN_DISPLAY_H_

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "graph/rdf/dictionary.h"
#include "graph/sparql/syntax/algebra.h"
#include "graph/sparql/syntax/algebra_printer.h"
#include "reasoner/explain/solver.h"

namespace docent::explain {

// Replacement of a variable, by its name: its value, or a display name.
using Values = std::map<std::string, sparql::PatternTerm>;

// The values of a solution, under the names of the clause and those in the query; open variables get the
// names in `names`.
Values ValuesOf(const Row& row, const Dictionary& dictionary,
                const absl::flat_hash_map<int, std::string>& names = {});

class Display {
 public:
  // `prefixes`: name without ':' and IRI; those of the question take precedence over the well-known ones.
  explicit Display(std::vector<std::pair<std::string, std::string>> prefixes);

  std::string Of(const Term& term) const;
  std::string Fact(const TermQuad& fact) const;
  std::string Fact(const sparql::TriplePattern& fact) const;
  // "0.12 > 0.2"
  std::string Filter(const sparql::Expression& expression, const Values& values) const;
  // "{ expo:R01 docent:task ?t }"
  std::string Pattern(const sparql::Algebra& pattern, const Values& values) const;

 private:
  sparql::PrintOptions options_;
};

}  // namespace docent::explain

#endif  // DOCENT_REASONER_EXPLAIN_DISPLAY_H_
