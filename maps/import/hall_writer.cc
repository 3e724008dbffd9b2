#include "maps/import/hall_writer.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "graph/base/text.h"
#include "graph/rdf/docent_iris.h"
#include "graph/rdf/term.h"
#include "graph/rdf/vocabulary.h"

namespace docent::maps {
namespace {

// The digits that the ontology asks for: millimetres and milliradians.
double Rounded(double value) {
  return std::round(value * 1000) / 1000 + 0.0;  // no -0
}

std::string Number(double value) {
  std::string text = absl::StrFormat("%.3f", Rounded(value));
  while (text.back() == '0') text.pop_back();
  if (text.back() == '.') text.pop_back();
  return text == "-0" ? "0" : text;
}

// An xsd:decimal as Turtle reads it.
std::string Decimal(double value) {
  const std::string text = Number(value);
  return text.find('.') == std::string::npos ? text + ".0" : text;
}

std::string Wkt(const Polygon& polygon) {
  std::vector<std::string> corners;
  for (const Point2& p : polygon) corners.push_back(Number(p.x_m) + " " + Number(p.y_m));
  corners.push_back(corners.front());
  return absl::StrCat("\"POLYGON((", absl::StrJoin(corners, ", "), "))\"^^geo:wktLiteral");
}

bool IsPlainName(const std::string& name) {
  return !name.empty() && absl::ascii_isalpha(static_cast<unsigned char>(name[0])) &&
         std::all_of(name.begin(), name.end(),
                     [](unsigned char c) { return absl::ascii_isalnum(c) || c == '_'; });
}

class HallWriter {
 public:
  HallWriter(const ImportedFloor& floor, const std::string& name_space, double height_m)
      : floor_(floor), name_space_(name_space), height_(Decimal(height_m)) {
    hall_ = Iri("floor/", floor.name);
  }

  HallText Write(const std::string& head) {
    std::string comment = head;
    std::replace_if(
        comment.begin(), comment.end(), [](char c) { return absl::ascii_iscntrl(c); }, ' ');
    Line("# ", comment);
    Line(
        "# Coordinates are metres in the frame of the map: x east, y north, headings counter-clockwise from "
        "x.");
    Line("@prefix docent: <", kDocentNs, "> .");
    Line("@prefix geo:    <", kGeoNs, "> .");
    Line("@prefix schema: <", kSchemaNs, "> .");
    Line("@prefix place:  <", name_space_, "> .\n");
    Line(hall_, " a docent:Hall ;");
    Line("    schema:name ", Text(floor_.name), " ; docent:height ", height_, " ;");
    Line("    geo:hasGeometry [ geo:asWKT ", Wkt(floor_.outline), " ] .");
    WriteObstacles();
    WritePlaces();
    WriteConnections();
    return std::move(out_);
  }

 private:
  template <typename... Pieces>
  void Line(const Pieces&... pieces) {
    out_.turtle += Concat(pieces..., "\n");
  }

  std::string Iri(std::string_view kind, const std::string& name) const {
    if (kind.empty() && IsPlainName(name)) return Concat("place:", name);
    return Concat("<", name_space_, kind, IriSegment(name), ">");
  }
  static std::string Text(const std::string& text) { return ToNTriples(Term::Literal(text)); }

  void WriteObstacles() {
    if (floor_.obstacles.empty()) return;
    Line("\n# ---- walls, and what hides what is behind it");
    for (size_t i = 0; i < floor_.obstacles.size(); ++i) {
      const ImportedObstacle& obstacle = floor_.obstacles[i];
      bounds_.push_back(BoundsOf(obstacle.outline));
      Line(Iri("wall/", absl::StrCat(i + 1)), " a docent:", obstacle.is_wall ? "Wall" : "Obstacle",
           " ; docent:partOf ", hall_, " ; docent:height ", height_, " ;");
      Line("    geo:hasGeometry [ geo:asWKT ", Wkt(obstacle.outline), " ] .");
    }
  }

  // Whether a robot can stand there at all.
  bool IsFree(const Point2& p) const {
    if (!Contains(floor_.outline, p)) return false;
    for (size_t i = 0; i < bounds_.size(); ++i) {
      const Bounds& b = bounds_[i];
      const bool apart = p.x_m < b.min_x_m || p.x_m > b.max_x_m || p.y_m < b.min_y_m || p.y_m > b.max_y_m;
      if (!apart && Contains(floor_.obstacles[i].outline, p)) return false;
    }
    return true;
  }

  void WritePlaces() {
    if (floor_.places.empty()) return;
    Line("\n# ---- places");
    for (size_t i = 0; i < floor_.places.size(); ++i) {
      const ImportedPlace& place = floor_.places[i];
      const Point2 p = {Rounded(place.pose.x_m), Rounded(place.pose.y_m)};
      if (place.outline.empty()) {
        Line(Iri("", place.name), " a docent:Waypoint ; docent:partOf ", hall_, " ; docent:x ",
             Decimal(p.x_m), " ; docent:y ", Decimal(p.y_m), " .");
        continue;
      }
      Line(Iri("", place.name), " a docent:Region ; docent:partOf ", hall_, " ; schema:name ",
           Text(place.name), " ;");
      const bool free = IsFree(p);
      Line("    geo:hasGeometry [ geo:asWKT ", Wkt(place.outline), " ]", free ? " ;" : " .");
      if (free) {
        Line("    docent:servicePoint [ geo:asWKT \"POINT(", Number(p.x_m), " ", Number(p.y_m),
             ")\"^^geo:wktLiteral ; docent:heading ", Decimal(place.pose.heading_rad), " ] .");
      } else {
        out_.unreachable.push_back(i);
      }
    }
  }

  void WriteConnections() {
    if (floor_.connections.empty()) return;
    Line("\n# ---- connections");
    for (size_t i = 0; i < floor_.connections.size(); ++i) {
      const ImportedConnection& connection = floor_.connections[i];
      Line(Iri("connection/", absl::StrCat(i + 1)), " a docent:Connection ; docent:fromPlace ",
           Iri("", floor_.places[connection.from].name), " ; docent:toPlace ",
           Iri("", floor_.places[connection.to].name), " ; docent:length ", Decimal(connection.length_m),
           " .");
    }
  }

  const ImportedFloor& floor_;
  const std::string name_space_;
  const std::string height_;
  std::string hall_;
  std::vector<Bounds> bounds_;  // of the obstacles
  HallText out_;
};

}  // namespace

HallText WriteHall(const ImportedFloor& floor, const std::string& name_space, double height_m,
                   const std::string& head) {
  return HallWriter(floor, name_space, height_m).Write(head);
}

}  // namespace docent::maps
