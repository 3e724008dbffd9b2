// A grey image in PGM, the format of the images of ROS maps (Netpbm, "PGM Format Specification": P5 raw, P2 plain).
// Pure; any thread.
#ifndef DOCENT_MAPS_IMPORT_PGM_IMAGE_H_
#define DOCENT_MAPS_IMPORT_PGM_IMAGE_H_

#include <cstdint>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "graph/base/map_limits.h"

namespace docent::maps {

struct GreyImage {
  int width = 0;
  int height = 0;
  std::vector<uint8_t> pixels;  // row by row from the top; 0 black, 255 white
};

// INVALID_ARGUMENT: not a PGM, a header that cannot be, fewer pixels than it says; a larger image than map_image_pixels,
// before any memory is taken for it.
absl::StatusOr<GreyImage> ReadPgm(std::string_view bytes, const MapLimits& limits = kMapLimits);

}  // namespace docent::maps

#endif  // DOCENT_MAPS_IMPORT_PGM_IMAGE_H_
