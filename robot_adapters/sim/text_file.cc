#include "robot_adapters/sim/text_file.h"

#include <cerrno>
#include <cstdio>
#include <fstream>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"

namespace docent::robot {

absl::Status WriteTextFile(const std::string& path, const std::string& text) {
  const std::string aside = path + ".part";
  std::ofstream out(aside, std::ios::binary);
  out << text;
  out.close();
  if (!out || std::rename(aside.c_str(), path.c_str()) != 0) {
    return absl::ErrnoToStatus(errno, absl::StrCat("cannot write ", path));
  }
  return absl::OkStatus();
}

std::string FileNameOf(std::string_view iri) {
  const size_t cut = iri.find_last_of("#/:");
  std::string name(cut == std::string_view::npos ? iri : iri.substr(cut + 1));
  for (char& c : name) {
    if (!absl::ascii_isalnum(static_cast<unsigned char>(c)) && c != '-' && c != '_') c = '_';
  }
  return name.empty() ? "thing" : name;
}

}  // namespace docent::robot
