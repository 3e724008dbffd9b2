#include "graph/sparql/syntax/algebra_memory.h"

namespace docent::sparql {
namespace {

size_t BytesOfRows(const Algebra& a) {
  size_t bytes = 0;
  for (const auto& row : a.rows) {
    bytes += sizeof(row) + kBytesOfAllocation + row.size() * sizeof(std::optional<Term>);
    for (const std::optional<Term>& term : row) bytes += term ? TextMemory(*term) : 0;
  }
  return bytes;
}

size_t BytesOf(const ExpressionPtr& expression) {
  return expression ? MemoryBytes(*expression) : 0;
}

}  // namespace

size_t MemoryBytes(const Path& path) {
  size_t bytes = sizeof(Path) + TextMemory(path.iri);
  if (!path.children.empty()) bytes += kBytesOfAllocation;
  for (const Path& child : path.children) bytes += MemoryBytes(child);
  return bytes;
}

size_t MemoryBytes(const Expression& e) {
  size_t bytes = sizeof(Expression) + kBytesOfAllocation + TextMemory(e.variable.name) + TextMemory(e.term);
  for (const ExpressionPtr& argument : e.arguments) bytes += sizeof(argument) + MemoryBytes(*argument);
  if (e.pattern) bytes += MemoryBytes(*e.pattern);
  return bytes;
}

size_t MemoryBytes(const Algebra& a) {
  size_t bytes = sizeof(Algebra) + kBytesOfAllocation + MemoryBytes(a.path) + TextMemory(a.subject) +
                 TextMemory(a.object) + TextMemory(a.name) + TextMemory(a.variable.name) + BytesOfRows(a) +
                 BytesOf(a.expression);
  for (const AlgebraPtr& child : a.children) bytes += sizeof(child) + MemoryBytes(*child);
  for (const TriplePattern& t : a.triples) bytes += sizeof(t) + TextMemory(t);
  for (const Variable& v : a.variables) bytes += sizeof(v) + TextMemory(v.name);
  for (const GroupKey& key : a.group_keys) bytes += sizeof(key) + BytesOf(key.expression);
  for (const Aggregate& aggregate : a.aggregates) {
    bytes += sizeof(aggregate) + TextMemory(aggregate.separator) + BytesOf(aggregate.expression);
  }
  for (const OrderCondition& order : a.order) bytes += sizeof(order) + BytesOf(order.expression);
  return bytes;
}

}  // namespace docent::sparql
