#include "workflow/cawl/robot_choice.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "graph/sparql/syntax/parser.h"

namespace docent::cawl {
namespace {

constexpr std::string_view kDefault = R"(PREFIX docent: <https://w3id.org/docent#>
SELECT ?robot WHERE {
  ?robot a docent:Robot .
  OPTIONAL { ?robot docent:x ?x ; docent:y ?y .
    { ?goal docent:servicePoint ?point . ?point docent:x ?goalX ; docent:y ?goalY }
    UNION { ?goal docent:x ?goalX ; docent:y ?goalY } }
  OPTIONAL { ?robot docent:battery ?charge }
  OPTIONAL { ?robot docent:lastUsed ?used }
  BIND (docent:distance(?x, ?y, ?goalX, ?goalY) AS ?metres)
}
ORDER BY (!BOUND(?metres)) ?metres DESC(?charge) ?used ?robot)";

void OrderByRobot(sparql::AlgebraPtr* algebra) {
  using Kind = sparql::Algebra::Kind;
  sparql::AlgebraPtr* at = algebra;
  while ((*at)->kind == Kind::kSlice || (*at)->kind == Kind::kDistinct || (*at)->kind == Kind::kReduced ||
         (*at)->kind == Kind::kProject)
    at = &(*at)->children[0];
  if ((*at)->kind != Kind::kOrderBy) {
    auto order = std::make_unique<sparql::Algebra>(Kind::kOrderBy, (*at)->span);
    order->children.push_back(std::move(*at));
    *at = std::move(order);
  }
  sparql::OrderCondition last;
  last.expression = std::make_unique<sparql::Expression>();
  last.expression->kind = sparql::Expression::Kind::kVariable;
  last.expression->variable = {"robot"};
  (*at)->order.push_back(std::move(last));
}

}  // namespace

std::string_view DefaultRobotChoice() {
  return kDefault;
}

ParsedChoice ParseRobotChoice(const std::string& text, const Limits& limits) {
  sparql::ParseOptions options;
  options.limits = limits;
  options.prefixes = sparql::WellKnownPrefixes();
  sparql::ParsedQuery parsed = sparql::ParseQuery(text, options);
  ParsedChoice out;
  out.diagnostics = std::move(parsed.diagnostics);
  if (HasErrors(out.diagnostics)) return out;
  const std::vector<sparql::Variable>& columns = parsed.query.projection;
  const bool names_robot = std::any_of(columns.begin(), columns.end(),
                                       [](const sparql::Variable& column) { return column.name == "robot"; });
  if (parsed.query.form != sparql::Query::Form::kSelect || !names_robot) {
    out.diagnostics.push_back({"", SourceSpan{}, "the choice of a robot is no SELECT of ?robot",
                               "write SELECT ?robot { … } ORDER BY …, the robot to be preferred first"});
    return out;
  }
  OrderByRobot(&parsed.query.algebra);
  out.query = std::move(parsed.query);
  return out;
}

}  // namespace docent::cawl
