// The picture of a booth for the robot's page, from a folder of files. Free function; any thread.
#ifndef DOCENT_ROBOT_ADAPTERS_SIM_BOOTH_PICTURE_H_
#define DOCENT_ROBOT_ADAPTERS_SIM_BOOTH_PICTURE_H_

#include <cstddef>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"

namespace docent::robot {

inline constexpr size_t kPictureBytes = 4 << 20;

// A data: URI of the file. `image`: the value of schema:image; what follows its last '/' names the file in `folder`.
// INVALID_ARGUMENT: that does not name a picture (.svg .png .jpg .jpeg .webp); else the error of ReadRegularFile.
absl::StatusOr<std::string> PictureUri(const std::string& folder, std::string_view image);

}  // namespace docent::robot

#endif  // DOCENT_ROBOT_ADAPTERS_SIM_BOOTH_PICTURE_H_
