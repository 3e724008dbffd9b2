#include "graph/base/cut_text.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "graph/base/text.h"

namespace docent {

std::string CutText(std::string_view text, size_t most) {
  if (text.size() <= most) return std::string(text);
  size_t fits = most;
  while (fits > 0 && (static_cast<unsigned char>(text[fits]) & 0xC0) == 0x80)
    --fits;  // UTF-8: goes on a character
  return absl::StrCat(ToAbsl(text.substr(0, fits)), "… (cut, of ", text.size(), " bytes)");
}

std::string OneLine(std::string_view text) {
  std::string line(text);
  std::replace_if(
      line.begin(), line.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; },
      ' ');
  return line;
}

}  // namespace docent
