#include "kb_server/cli/display_width.h"

#include <unicode/uchar.h>

#include <cstdint>

#include "absl/strings/str_format.h"
#include "graph/base/text.h"
#include "graph/rdf/hidden_character.h"
#include "graph/rdf/utf8.h"
#include "graph/rdf/utf8_text.h"

namespace docent::server {
namespace {

constexpr std::string_view kReplacement = "\xEF\xBF\xBD";  // U+FFFD
constexpr std::string_view kEllipsis = "…";

size_t WidthOf(char32_t c) {
  if (c < 0x7F) return c < 0x20 ? 0 : 1;
  switch (u_charType(static_cast<UChar32>(c))) {
    case U_NON_SPACING_MARK:
    case U_ENCLOSING_MARK:
    case U_CONTROL_CHAR:
    case U_FORMAT_CHAR:
      return c == 0xAD ? 1 : 0;  // terminals show a soft hyphen
    default:
      break;
  }
  if (c >= 0x1160 && c <= 0x11FF) return 0;  // Hangul vowels and finals join the consonant before them
  const int width = u_getIntPropertyValue(static_cast<UChar32>(c), UCHAR_EAST_ASIAN_WIDTH);
  return width == U_EA_FULLWIDTH || width == U_EA_WIDE ? 2 : 1;
}

// The text with `instead` for each character that is hidden (but for joiners after letters or pictures beyond ASCII), and
// U+FFFD for a byte that is not UTF-8.
template <typename Instead>
std::string Rewritten(std::string_view text, const Instead& instead) {
  std::string out;
  char32_t before = 0;
  ForEachCharacter(
      text,
      [&](char32_t c, std::string_view bytes) {
        if (IsHiddenCharacter(c) && !(IsJoiner(c) && before >= 0x80))
          out += instead(c);
        else
          out += bytes;
        before = c;
      },
      [&out](unsigned char) { out += kReplacement; });
  return out;
}

}  // namespace

size_t DisplayWidth(std::string_view text) {
  if (FindInvalidUtf8(text)) return DisplayWidth(Printable(text));
  size_t width = 0;
  for (size_t at = 0; at < text.size();) width += WidthOf(NextCodePoint(text, &at));
  return width;
}

std::string CutToWidth(std::string_view text, size_t columns) {
  if (FindInvalidUtf8(text)) return CutToWidth(Printable(text), columns);
  size_t width = 0;
  size_t fits = 0;  // bytes that leave room for the ellipsis
  for (size_t at = 0; at < text.size();) {
    width += WidthOf(NextCodePoint(text, &at));
    if (width + 1 <= columns) fits = at;
    if (width > columns) return columns == 0 ? "" : Concat(text.substr(0, fits), kEllipsis);
  }
  return std::string(text);
}

std::string Printable(std::string_view text) {
  return Rewritten(text, [](char32_t c) -> std::string_view {
    return c == '\n' || c == '\r' || c == '\t' ? " " : kReplacement;
  });
}

std::string PrintableLines(std::string_view text) {
  return Rewritten(text, [](char32_t c) -> std::string_view {
    return c == '\n' ? "\n" : c == '\t' ? "\t" : kReplacement;
  });
}

std::string PrintableJson(std::string_view json) {
  return Rewritten(json, [](char32_t c) -> std::string {
    if (c == '\n') return "\n";
    if (c < 0x10000) return absl::StrFormat("\\u%04x", static_cast<unsigned>(c));
    const auto above = static_cast<unsigned>(c - 0x10000);  // RFC 8259, section 7: a surrogate pair
    return absl::StrFormat("\\u%04x\\u%04x", 0xD800 + (above >> 10), 0xDC00 + (above & 0x3FF));
  });
}

}  // namespace docent::server
