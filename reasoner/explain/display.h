// Facts and conditions as one line of SPARQL for people, values put in the place of variables. Any thread.
#ifndef DOCENT_REASONER_EXPLAIN_DISPLAY_H_
#define DOCENT_REASONER_EXPLAIN_DISPLAY_H_

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "absl/types/span.h"
#include "kb_server/rdf/dictionary.h"
#include "kb_server/sparql/algebra.h"
#include "kb_server/sparql/algebra_printer.h"
#include "reasoner/explain/condition_form.h"

namespace docent::explain {

// By a variable's name.
using Values = std::map<std::string, Term>;

// The values of a solution, under the names of the clause and those that the query has.
Values ValuesOf(const Clause& clause, absl::Span<const TermId> row, const Dictionary& dictionary);

class Display {
 public:
  // `prefixes`: name without ':' and IRI, those of the question in front of the well-known ones.
  explicit Display(std::vector<std::pair<std::string, std::string>> prefixes);

  std::string Of(const Term& term) const;
  std::string Fact(const TermQuad& fact) const;
  std::string Fact(const sparql::TriplePattern& fact) const;
  // "0.12 > 0.2"
  // Variables without a value are called as `names` says.
  std::string Filter(const sparql::Expression& expression, const Values& values,
                     const std::map<std::string, std::string>& names = {}) const;
  // "{ expo:R01 docent:task ?t }"
  std::string Pattern(const sparql::Algebra& pattern, const Values& values) const;

 private:
  sparql::PrintOptions options_;
};

}  // namespace docent::explain

#endif  // DOCENT_REASONER_EXPLAIN_DISPLAY_H_
