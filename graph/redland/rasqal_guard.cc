#include "graph/redland/rasqal_guard.h"

#include <string>

#include "absl/strings/str_cat.h"
#include "graph/sparql/syntax/algebra_walk.h"

namespace docent::redland {
namespace {

using sparql::Algebra;
using sparql::Expression;

absl::Status Refuse(const std::string& what, const SourceSpan& span) {
  return absl::UnimplementedError(
      absl::StrCat(span.line > 0 ? absl::StrCat(span.line, ":", span.column, ": ") : "", "Rasqal ", what,
                   "; ask without --engine rasqal"));
}

absl::Status CheckExpression(const Expression& e) {
  switch (e.kind) {
    case Expression::Kind::kExists:
    case Expression::Kind::kNotExists:
      return Refuse("does not know EXISTS", e.span);
    default:
      return absl::OkStatus();
  }
}

absl::Status CheckNode(const Algebra& node) {
  switch (node.kind) {
    case Algebra::Kind::kPath:
      return Refuse("does not know property paths", node.span);
    case Algebra::Kind::kMinus:
      return Refuse("does not execute MINUS", node.span);
    case Algebra::Kind::kService:
      return Refuse("does not execute SERVICE here", node.span);
    case Algebra::Kind::kGraph:
      return Refuse("forgets GRAPH beside other patterns", node.span);
    default:
      break;
  }
  absl::Status status;
  sparql::ForEachExpression(node, [&status](const Expression& e) {
    if (status.ok()) status = CheckExpression(e);
  });
  return status;
}

// `optionals`: number of OPTIONAL around this node.
absl::Status Check(const Algebra& node, int optionals, const Limits& limits) {
  if (absl::Status status = CheckNode(node); !status.ok()) return status;
  if (optionals > limits.rasqal_optional_nesting) {
    return absl::ResourceExhaustedError(absl::StrCat(
        "OPTIONAL is nested deeper than the limit rasqal_optional_nesting = ", limits.rasqal_optional_nesting,
        "; ask without --engine rasqal"));
  }
  for (size_t i = 0; i < node.children.size(); ++i) {
    const bool deeper = node.kind == Algebra::Kind::kLeftJoin && i == 1;
    absl::Status status = Check(*node.children[i], optionals + (deeper ? 1 : 0), limits);
    if (!status.ok()) return status;
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status CheckForRasqal(const sparql::Query& query, const Limits& limits) {
  if (query.form == sparql::Query::Form::kDescribe) return Refuse("does not execute DESCRIBE", {});
  if (!query.from.empty() || !query.from_named.empty()) return Refuse("is not given FROM here", {});
  return Check(*query.algebra, 0, limits);
}

}  // namespace docent::redland
