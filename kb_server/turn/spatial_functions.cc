#include "kb_server/turn/spatial_functions.h"

#include <optional>
#include <string>

#include "absl/container/flat_hash_map.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "graph/rdf/number_literal.h"
#include "graph/rdf/vocabulary.h"
#include "maps/geometry.h"
#include "maps/roadmap.h"
#include "maps/wkt.h"

namespace docent::server {
namespace {

// Outlines are read once a thread; one that has seen so many begins anew.
constexpr size_t kOutlinesRemembered = 1024;
// Likewise roadmaps, of which a place has one, and another one when a passage is closed.
constexpr size_t kRoadmapsRemembered = 16;

absl::StatusOr<double> Number(const Term& term) {
  if (const std::optional<double> value = FiniteNumber(term)) return *value;
  return absl::InvalidArgumentError(absl::StrCat(ToDisplay(term), " is not a number"));
}

absl::StatusOr<maps::Point2> Position(absl::Span<const Term> arguments) {
  const auto x = Number(arguments[0]), y = Number(arguments[1]);
  if (!x.ok()) return x.status();
  if (!y.ok()) return y.status();
  return maps::Point2{*x, *y};
}

Term Metres(double metres) {
  return Term::Literal(absl::StrFormat("%.3f", metres), std::string(kXsdDecimal));
}

absl::StatusOr<Term> Distance(absl::Span<const Term> arguments) {
  const auto a = Position(arguments), b = Position(arguments.subspan(2));
  if (!a.ok()) return a.status();
  if (!b.ok()) return b.status();
  return Metres(maps::Distance(*a, *b));
}

absl::StatusOr<Term> RouteLength(absl::Span<const Term> arguments) {
  thread_local absl::flat_hash_map<std::string, absl::StatusOr<maps::Roadmap>> roadmaps;
  for (const Term& argument : arguments) {
    if (!argument.IsLiteral())
      return absl::InvalidArgumentError(
          "points and a roadmap are literals, as docent:routeLength takes them");
  }
  const auto from = maps::ReadPoint(arguments[0].lexical), to = maps::ReadPoint(arguments[1].lexical);
  if (!from.ok()) return from.status();
  if (!to.ok()) return to.status();
  if (roadmaps.size() > kRoadmapsRemembered) roadmaps.clear();
  auto roadmap = roadmaps.find(arguments[2].lexical);
  if (roadmap == roadmaps.end()) {
    roadmap = roadmaps.emplace(arguments[2].lexical, maps::Roadmap::Read(arguments[2].lexical)).first;
  }
  if (!roadmap->second.ok()) return roadmap->second.status();
  const absl::StatusOr<double> metres = roadmap->second->RouteLength(*from, *to);
  if (!metres.ok()) return metres.status();
  return Metres(*metres);
}

absl::StatusOr<Term> InRegion(absl::Span<const Term> arguments) {
  thread_local absl::flat_hash_map<std::string, absl::StatusOr<maps::Polygon>> outlines;
  const auto position = Position(arguments);
  if (!position.ok()) return position.status();
  if (!arguments[2].IsLiteral()) return absl::InvalidArgumentError("an outline is a literal");
  if (outlines.size() > kOutlinesRemembered) outlines.clear();
  auto outline = outlines.find(arguments[2].lexical);
  if (outline == outlines.end()) {
    outline = outlines.emplace(arguments[2].lexical, maps::ReadWktPolygon(arguments[2].lexical)).first;
  }
  if (!outline->second.ok()) return outline->second.status();
  const bool inside = maps::Contains(*outline->second, *position);
  return Term::Literal(inside ? "true" : "false", std::string(kXsdBoolean));
}

}  // namespace

void RegisterSpatialFunctions(sparql::FunctionRegistry* functions) {
  functions->Register(DocentIri("distance"), 4, 4, Distance).IgnoreError();
  functions->Register(DocentIri("routeLength"), 3, 3, RouteLength).IgnoreError();
  functions->Register(DocentIri("inRegion"), 3, 3, InRegion).IgnoreError();
}

}  // namespace docent::server
