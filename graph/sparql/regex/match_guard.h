// Interface through which a regular expression search reports work and memory to its evaluation. One thread.
#ifndef DOCENT_GRAPH_SPARQL_REGEX_MATCH_GUARD_H_
#define DOCENT_GRAPH_SPARQL_REGEX_MATCH_GUARD_H_

#include <cstddef>

namespace docent::sparql {

class MatchGuard {
 public:
  virtual ~MatchGuard() = default;
  // Counts work equal to reading this many bytes. False: the search must end.
  virtual bool Worked(size_t bytes) = 0;
  // Counts memory that the search keeps until Release. False: beyond the limit, and the search must end.
  virtual bool Charge(size_t bytes) = 0;
  virtual void Release(size_t bytes) = 0;
};

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_REGEX_MATCH_GUARD_H_
