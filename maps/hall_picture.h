// Picture (PNG) of the hall from above: walls, booths and regions with their names, and paths, places and a
// robot. For people; cairo draws. Pure except for the file; any thread.
#ifndef DOCENT_MAPS_HALL_PICTURE_H_
#define DOCENT_MAPS_HALL_PICTURE_H_

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "maps/distance_grid.h"
#include "maps/hall_layout.h"

namespace docent::maps {

struct Color {
  double red = 0;  // 0..1
  double green = 0;
  double blue = 0;
};

inline constexpr Color kTruthColor = {0.16, 0.44, 0.72};     // true poses
inline constexpr Color kEstimateColor = {0.87, 0.35, 0.13};  // estimated poses
inline constexpr Color kReferenceColor = {0.35, 0.35, 0.40};

struct PicturePath {
  std::string label;  // for the legend
  Color color;
  std::vector<Point2> points;
  bool dashed = false;
};

struct PictureMark {
  enum class Kind { kStart, kGoal, kPerson, kRobot };
  Kind kind = Kind::kStart;
  Pose2 pose;         // the heading is drawn for kRobot
  std::string label;  // beside the mark; may be empty
};

struct HallPicture {
  std::string title;     // one line; may be empty
  std::string subtitle;  // one line, smaller; may be empty
  std::vector<PicturePath> paths;
  std::vector<PictureMark> marks;
  std::vector<std::string> highlighted;      // IRIs of regions to highlight
  const DistanceGrid* background = nullptr;  // occupied cells drawn beneath: the map of a real building
  int width_px = 1600;                       // 200..8000; the height follows from the hall's outline
};

// Writes the picture (through a temporary file in the same folder). INVALID_ARGUMENT: a width out of range or
// a layout without outline; otherwise the system's error.
absl::Status WritePng(const HallLayout& layout, const HallPicture& picture, const std::string& path);

}  // namespace docent::maps

#endif  // DOCENT_MAPS_HALL_PICTURE_H_
