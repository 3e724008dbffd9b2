#include "maps/import/pgm_image.h"

#include <algorithm>
#include <optional>
#include <string>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"

namespace docent::maps {
namespace {

constexpr uint64_t kLargestNumber = 1000000000000;
constexpr uint64_t kLargestGrey = 65535;

class PgmReader {
 public:
  PgmReader(std::string_view bytes, const MapLimits& limits) : bytes_(bytes), limits_(limits) {}

  absl::StatusOr<GreyImage> Read() {
    if (bytes_.substr(0, 2) != "P5" && bytes_.substr(0, 2) != "P2") {
      return absl::InvalidArgumentError(
          "not a PGM image: it does not begin with P5 or P2; convert it, for example with pngtopnm");
    }
    const bool raw = bytes_[1] == '5';
    at_ = 2;
    const std::optional<uint64_t> width = Number(), height = Number(), white = Number();
    if (!width || !height || !white) {
      return absl::InvalidArgumentError(
          "the header of the PGM image is not width, height and the value of white");
    }
    if (*width == 0 || *height == 0 || *white == 0 || *white > kLargestGrey) {
      return absl::InvalidArgumentError(absl::StrCat("the header of the PGM image says ", *width, " x ",
                                                     *height, " pixels and white ", *white));
    }
    if (*width > limits_.map_image_pixels || *height > limits_.map_image_pixels / *width) {
      return absl::InvalidArgumentError(absl::StrCat("the image has ", *width, " x ", *height,
                                                     " pixels; the limit map_image_pixels is ",
                                                     limits_.map_image_pixels));
    }
    const uint64_t count = *width * *height;
    return raw ? Raw(static_cast<int>(*width), static_cast<int>(*height), count, *white)
               : Plain(static_cast<int>(*width), static_cast<int>(*height), count, *white);
  }

 private:
  static uint8_t Grey(uint64_t value, uint64_t white) {
    return static_cast<uint8_t>((std::min(value, white) * 255 + white / 2) / white);
  }

  absl::Status TooShort(uint64_t there, uint64_t wanted) const {
    return absl::InvalidArgumentError(
        absl::StrCat("the image ends after ", there, " of ", wanted, " pixels"));
  }

  absl::StatusOr<GreyImage> Raw(int width, int height, uint64_t count, uint64_t white) {
    ++at_;  // one white space after the header
    const uint64_t size = white > 255 ? 2 : 1;
    const uint64_t left = at_ < bytes_.size() ? bytes_.size() - at_ : 0;
    if (left / size < count) return TooShort(left / size, count);
    GreyImage image = {width, height, std::vector<uint8_t>(count)};
    for (uint64_t i = 0; i < count; ++i) {
      const size_t at = at_ + i * size;
      uint64_t value = static_cast<unsigned char>(bytes_[at]);
      if (size == 2) value = value << 8 | static_cast<unsigned char>(bytes_[at + 1]);
      image.pixels[i] = Grey(value, white);
    }
    return image;
  }

  absl::StatusOr<GreyImage> Plain(int width, int height, uint64_t count, uint64_t white) {
    if ((bytes_.size() - at_) / 2 < count) return TooShort((bytes_.size() - at_) / 2, count);
    GreyImage image = {width, height, std::vector<uint8_t>(count)};
    for (uint64_t i = 0; i < count; ++i) {
      const std::optional<uint64_t> value = Number();
      if (!value) return TooShort(i, count);
      image.pixels[i] = Grey(*value, white);
    }
    return image;
  }

  // The next decimal number, after white space and comments from # to the end of the line.
  std::optional<uint64_t> Number() {
    while (at_ < bytes_.size()) {
      if (bytes_[at_] == '#') {
        while (at_ < bytes_.size() && bytes_[at_] != '\n' && bytes_[at_] != '\r') ++at_;
      } else if (absl::ascii_isspace(static_cast<unsigned char>(bytes_[at_]))) {
        ++at_;
      } else {
        break;
      }
    }
    std::optional<uint64_t> value;
    for (; at_ < bytes_.size() && absl::ascii_isdigit(static_cast<unsigned char>(bytes_[at_])); ++at_) {
      value = std::min(value.value_or(0) * 10 + static_cast<uint64_t>(bytes_[at_] - '0'), kLargestNumber);
    }
    return value;
  }

  std::string_view bytes_;
  const MapLimits& limits_;
  size_t at_ = 0;
};

}  // namespace

absl::StatusOr<GreyImage> ReadPgm(std::string_view bytes, const MapLimits& limits) {
  return PgmReader(bytes, limits).Read();
}

}  // namespace docent::maps
