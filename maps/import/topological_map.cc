#include "maps/import/topological_map.h"

#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "absl/strings/str_cat.h"
#include "graph/base/text.h"
#include "graph/rdf/docent_iris.h"
#include "maps/wkt.h"

namespace docent::maps {
namespace {

constexpr double kZoneRadiusM = 0.7;
constexpr double kLargestCoordinateM = 1e6;

class TopologyReader {
 public:
  TopologyReader(const std::string& file, ImportedFloor* floor, Diagnostics* diagnostics,
                 const MapLimits& limits)
      : fields_(file, diagnostics), floor_(floor), diagnostics_(diagnostics), limits_(limits) {}

  bool Read(const YamlValue& document) {
    const YamlValue* list = document.IsMap() ? document.Find("nodes") : &document;
    if (list == nullptr || !list->IsList()) {
      fields_.Error(document.span, "a topological map is a list of nodes, or has one as nodes");
      return false;
    }
    if (list->items.size() > limits_.map_places) {
      fields_.Error(list->span, absl::StrCat("there are ", list->items.size(),
                                             " nodes; the limit map_places is ", limits_.map_places));
      return false;
    }
    std::vector<const YamlValue*> nodes;
    for (const YamlValue& item : list->items) {
      const YamlValue* node = item.Find("node");
      if (node == nullptr || !node->IsMap()) {
        fields_.Error(item.span, "an entry of the map has no node");
      } else if (ReadNode(*node)) {
        nodes.push_back(node);
      }
    }
    for (size_t i = 0; i < nodes.size(); ++i) ReadEdges(*nodes[i], i);
    return !HasErrors(*diagnostics_);
  }

 private:
  bool ReadNode(const YamlValue& node) {
    const YamlValue* name = fields_.Need(node, "name");
    const YamlValue* pose = fields_.Need(node, "pose");
    if (name == nullptr || pose == nullptr) return false;
    const std::optional<std::string> text = fields_.Text(*name, "the name of a node");
    const std::optional<Pose2> read = ReadPose(*pose);
    if (!text || !read) return false;
    if (const std::optional<std::string> fault = NameFault(*text)) {
      fields_.Error(name->span, Concat("the name of a node ", *fault));
      return false;
    }
    const auto [first, is_new] = by_name_.emplace(*text, floor_->places.size());
    if (!is_new) {
      fields_.Error(name->span, absl::StrCat("a second node ", *text, "; the first one stands in line ",
                                             floor_->places[first->second].span.line));
      return false;
    }
    ImportedPlace place = {*text, ReadZone(node, read->position()), *read, name->span};
    floor_->places.push_back(std::move(place));
    return true;
  }

  // A number of `map`; one that is missing is `otherwise`, or a fault.
  std::optional<double> Coordinate(const YamlValue& map, const char* key,
                                   std::optional<double> otherwise = std::nullopt) {
    const YamlValue* value = otherwise ? map.Find(key) : fields_.Need(map, key);
    if (value == nullptr) return otherwise;
    const std::optional<double> number = fields_.Number(*value, key);
    if (!number || std::abs(*number) <= kLargestCoordinateM) return number;
    fields_.Error(value->span, absl::StrCat(key, " ", value->text, " is beyond ", kLargestCoordinateM));
    return std::nullopt;
  }

  std::optional<Pose2> ReadPose(const YamlValue& pose) {
    const YamlValue* position = fields_.Need(pose, "position");
    if (position == nullptr) return std::nullopt;
    const std::optional<double> x_m = Coordinate(*position, "x"), y_m = Coordinate(*position, "y");
    if (!x_m || !y_m) return std::nullopt;
    const YamlValue* orientation = pose.Find("orientation");
    if (orientation == nullptr) return Pose2{*x_m, *y_m, 0};
    const std::optional<double> w = Coordinate(*orientation, "w"), x = Coordinate(*orientation, "x", 0),
                                y = Coordinate(*orientation, "y", 0), z = Coordinate(*orientation, "z");
    if (!w || !x || !y || !z) return std::nullopt;
    // Yaw of a quaternion (Diebel, Representing Attitude, 2006, equation 290).
    const double yaw = std::atan2(2 * (*w * *z + *x * *y), 1 - 2 * (*y * *y + *z * *z));
    return Pose2{*x_m, *y_m, WrapAngle(yaw)};
  }

  Polygon ReadZone(const YamlValue& node, const Point2& center) {
    const YamlValue* verts = node.Find("verts");
    Polygon zone;
    if (verts != nullptr && verts->IsList()) {
      for (const YamlValue& vertex : verts->items) {
        const std::optional<double> x_m = Coordinate(vertex, "x"), y_m = Coordinate(vertex, "y");
        if (x_m && y_m) zone.push_back({center.x_m + *x_m, center.y_m + *y_m});
      }
    }
    if (zone.empty()) return ZoneAround(center);
    if (zone.size() >= 3 && Area(zone) > 0 && !CrossesItself(zone)) return zone;
    fields_.Warning(verts->span, "the zone of the node is no simple polygon; it has an octagon in its place");
    return ZoneAround(center);
  }

  void ReadEdges(const YamlValue& node, size_t from) {
    const YamlValue* edges = node.Find("edges");
    if (edges == nullptr || !edges->IsList()) return;
    for (const YamlValue& edge : edges->items) {
      const YamlValue* target = fields_.Need(edge, "node");
      if (target == nullptr) continue;
      const auto to = by_name_.find(target->text);
      if (to == by_name_.end()) {
        if (fields_.full()) return;
        std::vector<std::string> names;
        for (const auto& [name, index] : by_name_) names.push_back(name);
        const std::string nearest = Nearest(target->text, names);
        fields_.Error(target->span,
                      Concat("an edge of ", floor_->places[from].name, " leads to the node ", target->text,
                             ", which does not exist"),
                      nearest.empty() ? "" : Concat("did you mean ", nearest, "?"));
        continue;
      }
      if (to->second == from) continue;  // a node is at itself
      if (floor_->connections.size() >= limits_.map_connections) {
        fields_.Error(edge.span,
                      absl::StrCat("too many edges; the limit map_connections is ", limits_.map_connections));
        return;
      }
      const double length_m =
          Distance(floor_->places[from].pose.position(), floor_->places[to->second].pose.position());
      floor_->connections.push_back({from, to->second, length_m});
    }
  }

  YamlFields fields_;
  ImportedFloor* floor_;
  Diagnostics* diagnostics_;
  const MapLimits& limits_;
  std::map<std::string, size_t> by_name_;
};

}  // namespace

Polygon ZoneAround(const Point2& p) {
  Polygon zone;
  for (int i = 0; i < 8; ++i) {
    const double angle_rad = (i + 0.5) * std::numbers::pi / 4;
    zone.push_back({p.x_m + kZoneRadiusM * std::cos(angle_rad), p.y_m + kZoneRadiusM * std::sin(angle_rad)});
  }
  return zone;
}

bool ReadTopologicalMap(const YamlValue& document, const std::string& file, ImportedFloor* floor,
                        Diagnostics* diagnostics, const MapLimits& limits) {
  return TopologyReader(file, floor, diagnostics, limits).Read(document);
}

}  // namespace docent::maps
