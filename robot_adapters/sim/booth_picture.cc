#include "robot_adapters/sim/booth_picture.h"

#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "graph/base/regular_file.h"
#include "graph/base/text.h"

namespace docent::robot {
namespace {

std::string_view MediaTypeOf(std::string_view name) {
  static constexpr std::pair<std::string_view, std::string_view> kTypes[] = {{".svg", "image/svg+xml"},
                                                                             {".png", "image/png"},
                                                                             {".jpg", "image/jpeg"},
                                                                             {".jpeg", "image/jpeg"},
                                                                             {".webp", "image/webp"}};
  const std::string small = absl::AsciiStrToLower(ToAbsl(name));
  for (const auto& [ending, type] : kTypes) {
    if (small.ends_with(ending) && small.size() > ending.size()) return type;
  }
  return "";
}

}  // namespace

absl::StatusOr<std::string> PictureUri(const std::string& folder, std::string_view image) {
  const size_t slash = image.rfind('/');
  const std::string_view name = slash == std::string_view::npos ? image : image.substr(slash + 1);
  const std::string_view type = MediaTypeOf(name);
  if (type.empty() || name.find('\0') != std::string_view::npos) {
    return absl::InvalidArgumentError(absl::StrCat("schema:image \"", ToAbsl(image),
                                                   "\" names no picture: .svg, .png, .jpg, .jpeg or .webp"));
  }
  const auto file = ReadRegularFile(Concat(folder, "/", name), kPictureBytes);
  if (!file.ok()) return file.status();
  if (file->text.size() > kPictureBytes) {
    return absl::ResourceExhaustedError(
        absl::StrCat("picture ", ToAbsl(name), " is larger than ", kPictureBytes, " bytes"));
  }
  return absl::StrCat("data:", ToAbsl(type), ";base64,", absl::Base64Escape(file->text));
}

}  // namespace docent::robot
