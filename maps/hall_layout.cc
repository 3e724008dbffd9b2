#include "maps/hall_layout.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <sstream>
#include <utility>

#include "absl/strings/numbers.h"
#include "absl/strings/str_join.h"
#include "graph/base/regular_file.h"
#include "graph/base/text.h"
#include "graph/rdf/document_name.h"
#include "graph/rdf/formats/parser.h"
#include "graph/rdf/vocabulary.h"
#include "maps/wkt.h"

namespace docent::maps {
namespace {

std::string NameOfResource(const Term& term) {
  return term.IsBlank() ? "_:" + term.lexical : term.lexical;
}

std::string LastPart(const std::string& iri) {
  const size_t cut = iri.find_last_of("#/:");
  return cut == std::string::npos || cut + 1 == iri.size() ? iri : iri.substr(cut + 1);
}

// Reader of a set of quads; it collects all mistakes and reports them together.
class LayoutReader {
 public:
  explicit LayoutReader(const std::vector<TermQuad>& quads) {
    for (const TermQuad& quad : quads) {
      facts_[quad.subject][quad.predicate.lexical].push_back(quad.object);
    }
  }

  absl::StatusOr<HallLayout> Read() {
    ReadHall();
    for (const auto& [subject, properties] : facts_) {
      ReadObstacle(subject);
      ReadRegion(subject);
    }
    for (const Obstacle& obstacle : layout_.obstacles) bounds_.push_back(BoundsOf(obstacle));
    for (const Region& region : layout_.regions) CheckServicePoint(region);
    if (!mistakes_.empty()) {
      return absl::InvalidArgumentError("hall layout:\n  " + absl::StrJoin(mistakes_, "\n  "));
    }
    return std::move(layout_);
  }

 private:
  void Mistake(const Term& resource, const std::string& what) {
    mistakes_.push_back(NameOfResource(resource) + ": " + what);
  }

  // The values in term order: the layout does not depend on the order of the quads.
  std::vector<Term> Values(const Term& subject, const std::string& predicate) const {
    const auto of_subject = facts_.find(subject);
    if (of_subject == facts_.end()) return {};
    const auto values = of_subject->second.find(predicate);
    if (values == of_subject->second.end()) return {};
    std::vector<Term> sorted = values->second;
    std::sort(sorted.begin(), sorted.end());
    sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
    return sorted;
  }

  std::optional<Term> First(const Term& subject, const std::string& predicate) const {
    const std::vector<Term> values = Values(subject, predicate);
    return values.empty() ? std::nullopt : std::optional<Term>(values.front());
  }

  bool Is(const Term& subject, std::string_view docent_class) const {
    for (const Term& type : Values(subject, std::string(kRdfType))) {
      if (type.lexical == DocentIri(docent_class)) return true;
    }
    return false;
  }

  std::string Text(const Term& subject, const std::string& predicate) const {
    const std::optional<Term> value = First(subject, predicate);
    return value ? value->lexical : std::string();
  }

  // A finite number of `subject`, or nullopt; a value that is no number is a mistake of `resource`.
  std::optional<double> Number(const Term& resource, const Term& subject, std::string_view local,
                               bool positive) {
    const std::vector<Term> values = Values(subject, DocentIri(local));
    if (values.empty()) return std::nullopt;
    const std::string property = "docent:" + std::string(local);
    if (values.size() > 1) {
      Mistake(resource, "more than one " + property + ": " + values[0].lexical + " and " + values[1].lexical);
      return std::nullopt;
    }
    double number = 0;
    if (!values[0].IsLiteral() || !absl::SimpleAtod(values[0].lexical, &number) || !std::isfinite(number) ||
        (positive && number <= 0)) {
      Mistake(resource,
              property + " is not a number" + (positive ? " above 0: " : ": ") + ToNTriples(values[0]));
      return std::nullopt;
    }
    return number;
  }

  // The well-known text of geo:hasGeometry/geo:asWKT; a mistake unless there is exactly one.
  std::optional<std::string> Geometry(const Term& resource) {
    std::vector<Term> texts;
    for (const Term& geometry : Values(resource, Concat(kGeoNs, "hasGeometry"))) {
      for (Term& text : Values(geometry, Concat(kGeoNs, "asWKT"))) texts.push_back(std::move(text));
    }
    if (texts.size() == 1) return texts[0].lexical;
    Mistake(resource, texts.empty()
                          ? "no geometry: expected geo:hasGeometry [ geo:asWKT \"…\"^^geo:wktLiteral ]"
                          : "more than one geometry");
    return std::nullopt;
  }

  Polygon Outline(const Term& resource) {
    const std::optional<std::string> text = Geometry(resource);
    if (!text) return {};
    absl::StatusOr<Polygon> polygon = ReadWktPolygon(*text);
    if (polygon.ok()) return *std::move(polygon);
    Mistake(resource, std::string(polygon.status().message()));
    return {};
  }

  std::string Label(const Term& resource) const {
    const std::string name = Text(resource, Concat(kSchemaNs, "name"));
    return name.empty() ? LastPart(resource.lexical) : name;
  }

  void ReadHall() {
    std::vector<Term> halls;
    for (const auto& [subject, properties] : facts_) {
      if (Is(subject, "Hall")) halls.push_back(subject);
    }
    if (halls.size() != 1) {
      mistakes_.push_back(halls.empty() ? "no docent:Hall"
                                        : "more than one docent:Hall: " + NameOfResource(halls[0]) + " and " +
                                              NameOfResource(halls[1]));
      return;
    }
    layout_.iri = NameOfResource(halls[0]);
    layout_.name = Label(halls[0]);
    layout_.outline = Outline(halls[0]);
    layout_.height_m = Number(halls[0], halls[0], "height", true).value_or(layout_.height_m);
  }

  void ReadObstacle(const Term& subject) {
    static constexpr std::pair<std::string_view, ObstacleKind> kKinds[] = {
        {"Pillar", ObstacleKind::kPillar},
        {"BoothWall", ObstacleKind::kBoothWall},
        {"Wall", ObstacleKind::kWall},
        {"Counter", ObstacleKind::kCounter},
        {"Obstacle", ObstacleKind::kOther}};
    const auto* kind = std::find_if(std::begin(kKinds), std::end(kKinds),
                                    [&](const auto& candidate) { return Is(subject, candidate.first); });
    if (kind == std::end(kKinds)) return;
    Obstacle obstacle;
    obstacle.iri = NameOfResource(subject);
    obstacle.kind = kind->second;
    obstacle.height_m = Number(subject, subject, "height", true).value_or(layout_.height_m);
    if (obstacle.kind == ObstacleKind::kPillar) {
      obstacle.disc = ReadDisc(subject);
      if (!obstacle.disc) return;
    } else {
      obstacle.outline = Outline(subject);
      if (obstacle.outline.empty()) return;
    }
    layout_.obstacles.push_back(std::move(obstacle));
  }

  std::optional<Disc> ReadDisc(const Term& subject) {
    const std::vector<Term> radius = Values(subject, DocentIri("radius"));
    if (radius.empty()) Mistake(subject, "a pillar without docent:radius");
    const std::optional<double> radius_m = Number(subject, subject, "radius", true);
    const std::optional<std::string> text = Geometry(subject);
    if (!text || !radius_m) return std::nullopt;
    const absl::StatusOr<Point2> center = ReadWktPoint(*text);
    if (!center.ok()) {
      Mistake(subject, std::string(center.status().message()));
      return std::nullopt;
    }
    return Disc{*center, *radius_m};
  }

  void ReadRegion(const Term& subject) {
    const bool is_booth = Is(subject, "Booth");
    if (!is_booth && !Is(subject, "Region")) return;
    Region region;
    region.iri = NameOfResource(subject);
    region.name = Label(subject);
    region.description = Text(subject, Concat(kSchemaNs, "description"));
    region.is_booth = is_booth;
    if (const std::optional<Term> exhibitor = First(subject, DocentIri("exhibitor"))) {
      region.exhibitor = exhibitor->IsLiteral() ? exhibitor->lexical : Label(*exhibitor);
    }
    region.outline = Outline(subject);
    region.service_point = ReadServicePoint(subject);
    if (!region.outline.empty()) layout_.regions.push_back(std::move(region));
  }

  std::optional<Pose2> ReadServicePoint(const Term& subject) {
    const std::vector<Term> points = Values(subject, DocentIri("servicePoint"));
    if (points.empty()) return std::nullopt;
    if (points.size() > 1) {
      Mistake(subject, "more than one docent:servicePoint");
      return std::nullopt;
    }
    const std::string text = Text(points[0], Concat(kGeoNs, "asWKT"));
    const absl::StatusOr<Point2> position = ReadWktPoint(text);
    if (!position.ok()) {
      Mistake(subject, "docent:servicePoint: " + std::string(position.status().message()));
      return std::nullopt;
    }
    if (Values(points[0], DocentIri("heading")).empty()) {
      Mistake(subject, "docent:servicePoint has no docent:heading");
      return std::nullopt;
    }
    const std::optional<double> heading_rad = Number(subject, points[0], "heading", false);
    if (!heading_rad) return std::nullopt;
    return Pose2{position->x_m, position->y_m, WrapAngle(*heading_rad)};
  }

  void CheckServicePoint(const Region& region) {
    if (!region.service_point) return;
    const Point2 p = region.service_point->position();
    const Term resource = Term::Iri(region.iri);
    if (!layout_.outline.empty() && !Contains(layout_.outline, p)) {
      Mistake(resource, "docent:servicePoint lies outside the hall");
    }
    for (size_t i = 0; i < bounds_.size(); ++i) {
      const Bounds& b = bounds_[i];
      if (p.x_m < b.min_x_m || p.x_m > b.max_x_m || p.y_m < b.min_y_m || p.y_m > b.max_y_m) continue;
      const Obstacle& obstacle = layout_.obstacles[i];
      const bool inside = obstacle.disc ? Distance(p, obstacle.disc->center) < obstacle.disc->radius_m
                                        : Contains(obstacle.outline, p);
      if (inside) Mistake(resource, "docent:servicePoint lies inside " + obstacle.iri);
    }
  }

  static Bounds BoundsOf(const Obstacle& obstacle) {
    if (!obstacle.disc) return maps::BoundsOf(obstacle.outline);
    const Point2& c = obstacle.disc->center;
    const double r = obstacle.disc->radius_m;
    return {c.x_m - r, c.y_m - r, c.x_m + r, c.y_m + r};
  }

  std::map<Term, std::map<std::string, std::vector<Term>>> facts_;
  std::vector<std::string> mistakes_;
  std::vector<Bounds> bounds_;  // of the obstacles
  HallLayout layout_;
};

}  // namespace

absl::StatusOr<HallLayout> HallLayout::FromQuads(const std::vector<TermQuad>& quads) {
  return LayoutReader(quads).Read();
}

absl::StatusOr<HallLayout> HallLayout::FromFile(const std::string& path) {
  const std::optional<RdfFormat> format = FormatOfFile(path);
  if (!format) {
    return absl::InvalidArgumentError(path + ": the name says no RDF format (.ttl .trig .nt .nq .rdf .owl)");
  }
  if (absl::Status status = CheckRegularFile(path); absl::IsInvalidArgument(status)) return status;
  std::ifstream file(path, std::ios::binary);
  if (!file) return absl::NotFoundError("cannot read the hall layout " + path);
  std::ostringstream content;
  content << file.rdbuf();
  const std::string text = std::move(content).str();
  ParsedRdf parsed = ParseRdf(text, *format, {path, FileIri(path), ""});
  if (!parsed.ok()) return ToStatus(parsed.diagnostics, text);
  absl::StatusOr<HallLayout> layout = FromQuads(parsed.quads);
  if (layout.ok()) return layout;
  return absl::Status(layout.status().code(), path + ": " + std::string(layout.status().message()));
}

const Region* HallLayout::FindRegion(std::string_view region_iri) const {
  for (const Region& region : regions) {
    if (region.iri == region_iri) return &region;
  }
  return nullptr;
}

}  // namespace docent::maps
