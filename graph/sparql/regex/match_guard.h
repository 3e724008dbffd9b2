// What a search for a regular expression asks of the evaluation that it is part of. One thread.
#ifndef DOCENT_GRAPH_SPARQL_REGEX_MATCH_GUARD_H_
#define DOCENT_GRAPH_SPARQL_REGEX_MATCH_GUARD_H_

#include <cstddef>

namespace docent::sparql {

class MatchGuard {
 public:
  virtual ~MatchGuard() = default;
  // Counts work, as much as looking at so many bytes. False: the search is to end.
  virtual bool Worked(size_t bytes) = 0;
  // Counts memory that the search keeps until Release. False: there is no more, and the search is to end.
  virtual bool Charge(size_t bytes) = 0;
  virtual void Release(size_t bytes) = 0;
};

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_REGEX_MATCH_GUARD_H_
