#include "graph/calendar/zones.h"

#include <algorithm>
#include <fstream>

#include "absl/strings/ascii.h"
#include "absl/strings/str_split.h"
#include "graph/base/diagnostic.h"
#include "graph/base/text.h"

namespace docent::calendar {
namespace {

constexpr char kNames[] = "/usr/share/zoneinfo/tzdata.zi";
constexpr size_t kMaxName = 64;

// Segments of letters, digits, "_", "+" and "-". The library would take files and its own words, too.
bool IsZoneName(std::string_view name) {
  if (name.empty() || name.size() > kMaxName || !absl::ascii_isupper(name[0])) return false;
  if (name.starts_with("Fixed/") || name.back() == '/' || name.find("//") != std::string_view::npos)
    return false;
  return std::all_of(name.begin(), name.end(), [](char c) {
    return absl::ascii_isalnum(c) || c == '_' || c == '+' || c == '-' || c == '/';
  });
}

// "Z NAME …" is a zone and "L TARGET NAME" a link: zic(8), "compact" source form.
std::vector<std::string> ReadNames() {
  std::vector<std::string> names;
  std::ifstream file(kNames);
  for (std::string line; std::getline(file, line);) {
    const std::vector<std::string> words = absl::StrSplit(line, ' ');
    if (words.size() >= 2 && words[0] == "Z") names.push_back(words[1]);
    if (words.size() >= 3 && words[0] == "L") names.push_back(words[2]);
  }
  return names;
}

}  // namespace

std::optional<absl::TimeZone> FindZone(std::string_view name) {
  absl::TimeZone zone;
  if (!IsZoneName(name) || !absl::LoadTimeZone(ToAbsl(name), &zone)) return std::nullopt;
  return zone;
}

std::string ZoneLike(std::string_view name) {
  static const std::vector<std::string>* const names = new std::vector<std::string>(ReadNames());
  const std::string lower = absl::AsciiStrToLower(ToAbsl(name));
  for (const std::string& known : *names) {
    const std::string other = absl::AsciiStrToLower(known);
    const size_t slash = other.rfind('/');
    if (other == lower || (slash != std::string::npos && other.substr(slash + 1) == lower)) return known;
  }
  return Nearest(name, *names);
}

TimeMicros InstantOf(const absl::CivilSecond& shown, const absl::TimeZone& zone) {
  const absl::TimeZone::TimeInfo info = zone.At(shown);
  return absl::ToUnixMicros(info.kind == absl::TimeZone::TimeInfo::SKIPPED ? info.trans : info.pre);
}

absl::CivilDay DayOf(TimeMicros instant_us, const absl::TimeZone& zone) {
  return absl::CivilDay(zone.At(absl::FromUnixMicros(instant_us)).cs);
}

}  // namespace docent::calendar
