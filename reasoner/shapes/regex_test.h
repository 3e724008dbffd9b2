// sh:pattern: SPARQL's REGEX(STR(?value), pattern, flags) (SHACL section 4.4.3), by SPARQL's own evaluator. Private to
// this folder. One thread.
#ifndef DOCENT_REASONER_SHAPES_REGEX_TEST_H_
#define DOCENT_REASONER_SHAPES_REGEX_TEST_H_

#include <memory>

#include "graph/rdf/dictionary.h"
#include "graph/rdf/term.h"
#include "graph/sparql/run/evaluator.h"

namespace docent::shapes {

class RegexTest {
 public:
  // `dictionary` must outlive it.
  RegexTest(const Term& pattern, const Term& flags, const Dictionary& dictionary);
  // False: it cannot be compiled.
  bool valid() const { return valid_; }
  bool Matches(TermId value);

 private:
  const GraphVersion empty_;
  std::unique_ptr<sparql::PreparedExpression> expression_;
  bool valid_ = false;
};

}  // namespace docent::shapes

#endif  // DOCENT_REASONER_SHAPES_REGEX_TEST_H_
