#include "maps/import/occupancy_map.h"

#include <array>
#include <cmath>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "graph/base/text.h"

namespace docent::maps {
namespace {

constexpr double kLargestResolutionM = 10;
constexpr double kLargestOriginM = 1e6;

class DescriptionReader {
 public:
  DescriptionReader(const YamlValue& document, const std::string& file, Diagnostics* diagnostics)
      : document_(document), fields_(file, diagnostics), diagnostics_(diagnostics) {}

  std::optional<MapDescription> Read() {
    const size_t before = diagnostics_->size();
    if (!document_.IsMap()) {
      fields_.Error(document_.span, "the description of a map is a mapping with image, resolution, origin");
      return std::nullopt;
    }
    ReadImage();
    ReadResolution();
    ReadOrigin();
    ReadNegate();
    ReadThresholds();
    ReadMode();
    return diagnostics_->size() == before ? std::optional(out_) : std::nullopt;
  }

 private:
  void ReadImage() {
    const YamlValue* value = fields_.Need(document_, "image");
    if (value == nullptr) return;
    out_.image = fields_.Text(*value, "image").value_or("");
    out_.image_place = value->span;
  }

  void ReadResolution() {
    const YamlValue* value = fields_.Need(document_, "resolution");
    const std::optional<double> number =
        value != nullptr ? fields_.Number(*value, "resolution") : std::nullopt;
    if (!number) return;
    out_.resolution_m = *number;
    if (*number <= 0 || *number > kLargestResolutionM) {
      fields_.Error(value->span, absl::StrCat("resolution ", value->text, " is not above 0 and at most ",
                                              kLargestResolutionM, " metres a pixel"));
    }
  }

  void ReadOrigin() {
    const YamlValue* value = fields_.Need(document_, "origin");
    if (value == nullptr) return;
    if (!value->IsList() || value->items.size() != 3) {
      fields_.Error(value->span, "origin is not a list of three numbers: x, y, yaw");
      return;
    }
    std::array<double, 3> numbers = {};
    for (size_t i = 0; i < 3; ++i) {
      const std::optional<double> number = fields_.Number(value->items[i], "a number of origin");
      if (!number) return;
      numbers[i] = *number;
      if (std::abs(*number) <= kLargestOriginM) continue;
      fields_.Error(value->items[i].span,
                    absl::StrCat("origin ", value->items[i].text, " is beyond ", kLargestOriginM));
    }
    out_.origin = {numbers[0], numbers[1], WrapAngle(numbers[2])};
  }

  void ReadNegate() {
    const YamlValue* value = document_.Find("negate");
    if (value == nullptr) return;
    out_.negate = value->text == "1" || absl::EqualsIgnoreCase(value->text, "true");
    if (!out_.negate && value->text != "0" && !absl::EqualsIgnoreCase(value->text, "false"))
      fields_.Error(value->span, Concat("negate is neither 0 nor 1: ", value->text));
  }

  // The value of a threshold's key, or its default.
  double Threshold(std::string_view key, double otherwise) {
    const YamlValue* value = document_.Find(key);
    if (value == nullptr) return otherwise;
    const std::optional<double> number = fields_.Number(*value, key);
    if (number && (*number < 0 || *number > 1))
      fields_.Error(value->span, Concat(key, " ", value->text, " is not within 0 and 1"));
    return number.value_or(otherwise);
  }

  void ReadThresholds() {
    const size_t before = diagnostics_->size();
    out_.occupied_threshold = Threshold("occupied_thresh", out_.occupied_threshold);
    out_.free_threshold = Threshold("free_thresh", out_.free_threshold);
    if (diagnostics_->size() > before || out_.free_threshold < out_.occupied_threshold) return;
    const YamlValue* value = document_.Find("free_thresh");
    fields_.Error(value != nullptr ? value->span : document_.span,
                  absl::StrCat("free_thresh ", out_.free_threshold, " is not below occupied_thresh ",
                               out_.occupied_threshold),
                  "a cell would be free and occupied; usual are 0.196 and 0.65");
  }

  void ReadMode() {
    const YamlValue* value = document_.Find("mode");
    if (value == nullptr || value->text == "trinary") return;
    if (value->text == "scale") {
      out_.mode = MapDescription::Mode::kScale;
    } else if (value->text == "raw") {
      out_.mode = MapDescription::Mode::kRaw;
    } else {
      fields_.Error(value->span, Concat("mode is unknown: ", value->text),
                    "there are trinary, scale and raw");
    }
  }

  const YamlValue& document_;
  YamlFields fields_;
  Diagnostics* diagnostics_;
  MapDescription out_;
};

MapCell CellOf(uint8_t value, const MapDescription& description) {
  double occupancy = 0;
  if (description.mode == MapDescription::Mode::kRaw) {
    if (value > 100) return MapCell::kUnknown;
    occupancy = value / 100.0;
  } else {
    occupancy = (description.negate ? value : 255 - value) / 255.0;
  }
  if (occupancy > description.occupied_threshold) return MapCell::kOccupied;
  return occupancy < description.free_threshold ? MapCell::kFree : MapCell::kUnknown;
}

}  // namespace

std::optional<MapDescription> ReadMapDescription(const YamlValue& document, const std::string& file,
                                                 Diagnostics* diagnostics) {
  return DescriptionReader(document, file, diagnostics).Read();
}

OccupancyGrid GridOf(const MapDescription& description, const GreyImage& image) {
  std::array<MapCell, 256> cell_of;
  for (int value = 0; value < 256; ++value)
    cell_of[static_cast<size_t>(value)] = CellOf(static_cast<uint8_t>(value), description);
  OccupancyGrid grid = {image.width, image.height, description.resolution_m, description.origin, {}};
  grid.cells.resize(image.pixels.size());
  const size_t width = static_cast<size_t>(image.width), height = static_cast<size_t>(image.height);
  for (size_t row = 0; row < height; ++row) {
    for (size_t i = 0; i < width; ++i)
      grid.cells[(height - 1 - row) * width + i] = cell_of[image.pixels[row * width + i]];
  }
  return grid;
}

}  // namespace docent::maps
