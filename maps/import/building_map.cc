#include "maps/import/building_map.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "graph/base/text.h"
#include "graph/rdf/docent_iris.h"
#include "maps/import/topological_map.h"

namespace docent::maps {
namespace {

constexpr double kWallThicknessM = 0.1;
constexpr double kLeastPixels = 1e-6;  // between two vertices that were measured
constexpr double kMarginM = 0.5;       // around everything
constexpr double kUsualScaleM =
    0.05;  // metres a pixel, where nothing was measured; the traffic editor's default
constexpr double kLargestCoordinate = 1e6;  // pixels or metres

class LevelReader {
 public:
  LevelReader(const std::string& file, ImportedFloor* floor, Diagnostics* diagnostics,
              const MapLimits& limits)
      : fields_(file, diagnostics), floor_(floor), limits_(limits) {}

  void Read(const YamlValue& document, const YamlValue& level) {
    const YamlValue* system = document.Find("coordinate_system");
    in_pixels_ = system == nullptr || system->text == "reference_image";
    if (!in_pixels_ && system->text != "cartesian_meters") {
      fields_.Error(system->span, Concat("coordinate_system ", system->text, " is not read"),
                    "there are reference_image and cartesian_meters");
      return;
    }
    const YamlValue* vertices = fields_.Need(level, "vertices");
    if (vertices == nullptr || !ReadVertices(*vertices)) return;
    if (in_pixels_) Scale(level);
    AddNamedPlaces();
    ReadPairs(level, "walls", [this](size_t a, size_t b, const YamlValue&) { AddWall(a, b); });
    ReadPairs(level, "lanes", [this](size_t a, size_t b, const YamlValue& lane) { AddLane(a, b, lane); });
    AddOutline();
  }

 private:
  struct Vertex {
    Point2 point;
    std::string name;
    SourceSpan span;
  };

  bool ReadVertices(const YamlValue& list) {
    if (!list.IsList() || list.items.empty()) {
      fields_.Error(list.span, "vertices is not a list of points");
      return false;
    }
    if (list.items.size() > limits_.map_places) {
      fields_.Error(list.span, absl::StrCat("there are ", list.items.size(),
                                            " vertices; the limit map_places is ", limits_.map_places));
      return false;
    }
    for (const YamlValue& item : list.items) {
      if (!item.IsList() || item.items.size() < 2) {
        fields_.Error(item.span, "a vertex is not a list of x, y, z and a name");
        return false;
      }
      const std::optional<double> x = fields_.Number(item.items[0], "x"),
                                  y = fields_.Number(item.items[1], "y");
      if (!x || !y) return false;
      if (std::abs(*x) > kLargestCoordinate || std::abs(*y) > kLargestCoordinate) {
        fields_.Error(item.span, absl::StrCat("a vertex is beyond ", kLargestCoordinate));
        return false;
      }
      vertices_.push_back({{*x, *y}, item.items.size() > 3 ? item.items[3].text : "", item.span});
    }
    return true;
  }

  // Calls use(a, b, item) for each item [a, b, …] of the list `key`, where both are vertices.
  template <typename Use>
  void ReadPairs(const YamlValue& level, std::string_view key, const Use& use) {
    const YamlValue* list = level.Find(key);
    if (list == nullptr || !list->IsList()) return;
    for (const YamlValue& item : list->items) {
      if (fields_.full()) return;
      if (!item.IsList() || item.items.size() < 2) {
        fields_.Error(item.span, Concat("an entry of ", key, " is not a list that begins with two vertices"));
        continue;
      }
      const auto a = fields_.Index(item.items[0], "vertex", vertices_.size());
      const auto b = fields_.Index(item.items[1], "vertex", vertices_.size());
      if (a && b) use(*a, *b, item);
    }
  }

  // The value of a parameter: {distance: [3, 9.3]}.
  static const YamlValue* Parameter(const YamlValue& item, std::string_view name) {
    const YamlValue* value = item.items.size() > 2 ? item.items[2].Find(name) : nullptr;
    return value != nullptr && value->IsList() && value->items.size() == 2 ? &value->items[1] : nullptr;
  }

  // Pixels become metres by the mean of what was measured, and y points up.
  void Scale(const YamlValue& level) {
    double sum = 0;
    int count = 0;
    ReadPairs(level, "measurements", [&](size_t a, size_t b, const YamlValue& item) {
      const YamlValue* value = Parameter(item, "distance");
      const double pixels = Distance(vertices_[a].point, vertices_[b].point);
      const auto metres = value != nullptr ? fields_.Number(*value, "distance") : std::nullopt;
      if (!metres) return;
      if (*metres <= 0 || *metres > kLargestCoordinate || pixels < kLeastPixels) {
        fields_.Error(item.span, "a measurement needs two vertices apart and a distance above 0");
        return;
      }
      sum += *metres / pixels;
      ++count;
    });
    if (count == 0)
      fields_.Warning(level.span,
                      absl::StrCat("nothing was measured; a pixel is taken as ", kUsualScaleM, " m"));
    const double scale = count == 0 ? kUsualScaleM : sum / count;
    for (Vertex& vertex : vertices_) vertex.point = {vertex.point.x_m * scale, -vertex.point.y_m * scale};
  }

  void AddNamedPlaces() {
    std::map<std::string, int> lines;
    for (size_t i = 0; i < vertices_.size(); ++i) {
      const Vertex& vertex = vertices_[i];
      if (vertex.name.empty()) continue;
      if (const std::optional<std::string> fault = NameFault(vertex.name)) {
        fields_.Error(vertex.span, Concat("the name of a vertex ", *fault));
        continue;
      }
      // Buildings are drawn with names that stand twice, for vertices of different lanes.
      const auto [first, is_new] = lines.emplace(vertex.name, vertex.span.line);
      const std::string name = is_new ? Unique(vertex.name) : Unique(absl::StrCat(vertex.name, "_", i));
      if (!is_new) {
        fields_.Warning(vertex.span,
                        absl::StrCat("a second vertex ", vertex.name, "; the first one stands in line ",
                                     first->second, ", this one becomes ", name));
      }
      place_of_[i] = floor_->places.size();
      floor_->places.push_back(
          {name, ZoneAround(vertex.point), {vertex.point.x_m, vertex.point.y_m, 0}, vertex.span});
    }
  }

  // The name, with something behind it if a place has it already.
  std::string Unique(std::string name) {
    while (!names_.insert(name).second) name += "_";
    return name;
  }

  void AddWall(size_t a, size_t b) {
    const Point2 from = vertices_[a].point, to = vertices_[b].point;
    const double length_m = Distance(from, to);
    if (length_m < kWallThicknessM / 10) return;
    const double x = (to.x_m - from.x_m) / length_m * kWallThicknessM / 2,
                 y = (to.y_m - from.y_m) / length_m * kWallThicknessM / 2;
    // Longer by half its thickness at each end, so that corners close.
    const Point2 begin = {from.x_m - x, from.y_m - y}, end = {to.x_m + x, to.y_m + y};
    floor_->obstacles.push_back({{{begin.x_m + y, begin.y_m - x},
                                  {end.x_m + y, end.y_m - x},
                                  {end.x_m - y, end.y_m + x},
                                  {begin.x_m - y, begin.y_m + x}},
                                 true});
  }

  // The place of a vertex; one without a name gets one.
  size_t PlaceOf(size_t vertex) {
    const auto [found, is_new] = place_of_.emplace(vertex, floor_->places.size());
    if (!is_new) return found->second;
    const Point2& p = vertices_[vertex].point;
    floor_->places.push_back(
        {Unique(absl::StrCat("waypoint", vertex)), {}, {p.x_m, p.y_m, 0}, vertices_[vertex].span});
    return found->second;
  }

  void AddLane(size_t a, size_t b, const YamlValue& lane) {
    if (a == b) return;
    if (floor_->connections.size() + 2 > limits_.map_connections) {
      fields_.Error(lane.span,
                    absl::StrCat("too many lanes; the limit map_connections is ", limits_.map_connections));
      return;
    }
    const double length_m = Distance(vertices_[a].point, vertices_[b].point);
    const size_t from = PlaceOf(a), to = PlaceOf(b);
    floor_->connections.push_back({from, to, length_m});
    const YamlValue* both = Parameter(lane, "bidirectional");
    if (both != nullptr && both->text == "true") floor_->connections.push_back({to, from, length_m});
  }

  void AddOutline() {
    Polygon all;
    for (const Vertex& vertex : vertices_) all.push_back(vertex.point);
    const Bounds b = BoundsOf(all);
    const double x0 = b.min_x_m - kMarginM, y0 = b.min_y_m - kMarginM, x1 = b.max_x_m + kMarginM,
                 y1 = b.max_y_m + kMarginM;
    floor_->outline = {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
  }

  YamlFields fields_;
  ImportedFloor* floor_;
  const MapLimits& limits_;
  bool in_pixels_ = true;
  std::vector<Vertex> vertices_;
  std::map<size_t, size_t> place_of_;  // by vertex
  std::set<std::string> names_;        // of places
};

}  // namespace

bool ReadBuilding(const YamlValue& document, const std::string& file, const std::string& level,
                  ImportedFloor* floor, Diagnostics* diagnostics, const MapLimits& limits) {
  YamlFields fields(file, diagnostics);
  const YamlValue* levels = document.Find("levels");
  if (levels == nullptr || !levels->IsMap() || levels->items.empty()) {
    fields.Error(document.span, "the building has no levels");
    return false;
  }
  const std::string there = Concat("there are: ", absl::StrJoin(levels->keys, ", "));
  if (level.empty() && levels->items.size() > 1) {
    fields.Error(levels->span, "the building has several levels; which one has to be said", there);
    return false;
  }
  const YamlValue* chosen = level.empty() ? &levels->items[0] : levels->Find(level);
  if (chosen == nullptr || !chosen->IsMap()) {
    fields.Error(levels->span, Concat("the building has no level ", level), there);
    return false;
  }
  if (const YamlValue* name = document.Find("name"); name != nullptr) {
    if (const std::optional<std::string> fault = NameFault(name->text)) {
      fields.Error(name->span, Concat("the name of the building ", *fault));
      return false;
    }
    floor->name = name->text;
  }
  if (!level.empty()) floor->name += Concat(floor->name.empty() ? "" : " ", level);
  LevelReader(file, floor, diagnostics, limits).Read(document, *chosen);
  return !HasErrors(*diagnostics);
}

}  // namespace docent::maps
