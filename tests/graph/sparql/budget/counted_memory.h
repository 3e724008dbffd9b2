// Memory that this test program has from operator new, to compare with what a budget counts.
#ifndef DOCENT_TESTS_GRAPH_SPARQL_BUDGET_COUNTED_MEMORY_H_
#define DOCENT_TESTS_GRAPH_SPARQL_BUDGET_COUNTED_MEMORY_H_

#include <cstddef>

namespace docent {

// The most at one time since its construction, beyond what there was then.
class CountedMemory {
 public:
  CountedMemory();
  size_t peak() const;

 private:
  const size_t before_;
};

}  // namespace docent

#endif  // DOCENT_TESTS_GRAPH_SPARQL_BUDGET_COUNTED_MEMORY_H_
