// Traversal of all nodes of an algebra, also those inside expressions (EXISTS). Pure functions.
#ifndef DOCENT_GRAPH_SPARQL_SYNTAX_ALGEBRA_WALK_H_
#define DOCENT_GRAPH_SPARQL_SYNTAX_ALGEBRA_WALK_H_

#include <algorithm>
#include <vector>

#include "graph/sparql/syntax/algebra.h"

namespace docent::sparql {

// Calls `visit(expression)` for each expression directly in `node`, and for the expressions inside it.
template <typename Node, typename Visit>
void ForEachExpression(Node& node, const Visit& visit) {
  const auto deep = [&visit](auto& e, const auto& self) -> void {
    visit(e);
    for (const ExpressionPtr& argument : e.arguments) self(*argument, self);
  };
  if (node.expression) deep(*node.expression, deep);
  for (auto& key : node.group_keys) deep(*key.expression, deep);
  for (auto& aggregate : node.aggregates) {
    if (aggregate.expression) deep(*aggregate.expression, deep);
  }
  for (auto& order : node.order) deep(*order.expression, deep);
}

// The conjuncts of `e`: the a, b, c of a && b && c.
inline void CollectConjuncts(const Expression& e, std::vector<const Expression*>& conjuncts) {
  if (e.kind != Expression::Kind::kAnd) return conjuncts.push_back(&e);
  for (const ExpressionPtr& argument : e.arguments) CollectConjuncts(*argument, conjuncts);
}

// True if `test(node)` holds for a node anywhere in `a`.
template <typename Test>
bool AnyNode(const Algebra& a, const Test& test) {
  if (test(a)) return true;
  for (const AlgebraPtr& child : a.children) {
    if (AnyNode(*child, test)) return true;
  }
  bool found = false;
  ForEachExpression(a,
                    [&](const Expression& e) { found = found || (e.pattern && AnyNode(*e.pattern, test)); });
  return found;
}

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_SYNTAX_ALGEBRA_WALK_H_
