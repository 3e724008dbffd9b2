#include "workflow/cawl/robot_choice.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "graph/sparql/syntax/parser.h"

namespace docent::cawl {
namespace {

constexpr std::string_view kDefault = R"(PREFIX docent: <https://w3id.org/docent#>
PREFIX geo: <http://www.opengis.net/ont/geosparql#>
SELECT ?robot WHERE {
  ?robot a docent:Robot .
  { SELECT (GROUP_CONCAT(?way; SEPARATOR=";") AS ?roadmap) WHERE {
      ?connection docent:fromPlace ?from ; docent:toPlace ?to .
      FILTER NOT EXISTS { ?connection docent:closed true }
      OPTIONAL { ?from docent:x ?fromX ; docent:y ?fromY }
      OPTIONAL { ?from docent:servicePoint ?fromPoint . ?fromPoint geo:asWKT ?fromWkt }
      OPTIONAL { ?to docent:x ?toX ; docent:y ?toY }
      OPTIONAL { ?to docent:servicePoint ?toPoint . ?toPoint geo:asWKT ?toWkt }
      OPTIONAL { ?connection docent:length ?length }
      BIND (CONCAT(COALESCE(CONCAT(STR(?fromX), " ", STR(?fromY)), STR(?fromWkt)), " ",
                   COALESCE(CONCAT(STR(?toX), " ", STR(?toY)), STR(?toWkt)), " ", COALESCE(STR(?length), "")) AS ?way)
      FILTER (BOUND(?way))
  } }
  OPTIONAL { ?robot docent:x ?x ; docent:y ?y }
  OPTIONAL { ?goal docent:x ?goalX ; docent:y ?goalY }
  OPTIONAL { ?goal docent:servicePoint ?point .
    OPTIONAL { ?point docent:x ?pointX ; docent:y ?pointY }
    OPTIONAL { ?point geo:asWKT ?pointWkt } }
  OPTIONAL { ?robot docent:battery ?charge }
  OPTIONAL { ?robot docent:load ?tasks }
  OPTIONAL { ?robot docent:lastUsed ?used }
  BIND (COALESCE(CONCAT(STR(?pointX), " ", STR(?pointY)), STR(?pointWkt), CONCAT(STR(?goalX), " ", STR(?goalY))) AS ?place)
  BIND (docent:routeLength(CONCAT(STR(?x), " ", STR(?y)), ?place, ?roadmap) AS ?metres)
  BIND (COALESCE(?tasks, 0) AS ?load)
}
ORDER BY (!BOUND(?metres)) ?metres DESC(?charge) ?load ?used ?robot)";

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
