// Conversions between std::string_view and Abseil. Debian's Abseil has its own absl::string_view, to which
// std::string_view does not convert implicitly, so absl::StrCat cannot take one. Values; any thread.
#ifndef DOCENT_GRAPH_BASE_TEXT_H_
#define DOCENT_GRAPH_BASE_TEXT_H_

#include <algorithm>
#include <string>
#include <string_view>

#include "absl/strings/string_view.h"

namespace docent {

// The same bytes for an Abseil function; lives as long as `text`'s bytes.
inline absl::string_view ToAbsl(std::string_view text) {
  return absl::string_view(text.data(), text.size());
}
// The reverse conversion.
inline std::string_view FromAbsl(absl::string_view text) {
  return std::string_view(text.data(), text.size());
}

// *out = text, which is no part of *out. Faster if the old text is as long, as names of one kind often are.
inline void Overwrite(std::string* out, std::string_view text) {
  if (out->size() != text.size()) out->resize(text.size());
  std::copy(text.begin(), text.end(), out->begin());
}

// Concatenates the pieces: absl::StrCat for std::string_view, std::string and literals (not for numbers).
template <typename... Pieces>
std::string Concat(const Pieces&... pieces) {
  std::string out;
  out.reserve((std::string_view(pieces).size() + ... + 0));
  (out.append(std::string_view(pieces)), ...);
  return out;
}

}  // namespace docent

#endif  // DOCENT_GRAPH_BASE_TEXT_H_
