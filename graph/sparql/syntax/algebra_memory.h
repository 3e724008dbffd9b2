// Memory of an algebra and its parts, in bytes, for budgets. Pure functions.
#ifndef DOCENT_GRAPH_SPARQL_SYNTAX_ALGEBRA_MEMORY_H_
#define DOCENT_GRAPH_SPARQL_SYNTAX_ALGEBRA_MEMORY_H_

#include <cstddef>
#include <string>

#include "graph/sparql/syntax/algebra.h"

namespace docent::sparql {

inline constexpr size_t kBytesOfAllocation = 16;  // that the allocator adds, about
inline constexpr size_t kBytesInString = 15;      // a text of this length needs no allocation

// What a text, a term or a pattern keeps beyond its own size.
inline size_t TextMemory(const std::string& text) {
  return text.size() <= kBytesInString ? 0 : text.size() + kBytesOfAllocation;
}
inline size_t TextMemory(const Term& term) {
  return TextMemory(term.lexical) + TextMemory(term.datatype) + TextMemory(term.language);
}
inline size_t TextMemory(const PatternTerm& term) {
  return term.IsVariable() ? TextMemory(term.variable().name) : TextMemory(term.term());
}
inline size_t TextMemory(const TriplePattern& triple) {
  return TextMemory(triple.subject) + TextMemory(triple.predicate) + TextMemory(triple.object);
}

// Each with all that it holds: what a copy takes.
size_t MemoryBytes(const Path& path);
size_t MemoryBytes(const Expression& expression);
size_t MemoryBytes(const Algebra& algebra);

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_SYNTAX_ALGEBRA_MEMORY_H_
