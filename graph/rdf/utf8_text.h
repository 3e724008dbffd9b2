// Goes through a text that may not be UTF-8. Any thread.
#ifndef DOCENT_GRAPH_RDF_UTF8_TEXT_H_
#define DOCENT_GRAPH_RDF_UTF8_TEXT_H_

#include <optional>
#include <string_view>

#include "graph/rdf/utf8.h"

namespace docent {

// Calls `character(code point, its bytes)` for each character, and `invalid(byte)` for each byte that belongs to none.
template <typename Character, typename Invalid>
void ForEachCharacter(std::string_view text, const Character& character, const Invalid& invalid) {
  while (!text.empty()) {
    const std::optional<size_t> bad = FindInvalidUtf8(text);
    const std::string_view good = text.substr(0, bad.value_or(text.size()));
    for (size_t at = 0; at < good.size();) {
      const size_t begin = at;
      const char32_t c = NextCodePoint(good, &at);
      character(c, good.substr(begin, at - begin));
    }
    if (!bad) return;
    invalid(static_cast<unsigned char>(text[*bad]));
    text.remove_prefix(*bad + 1);
  }
}

}  // namespace docent

#endif  // DOCENT_GRAPH_RDF_UTF8_TEXT_H_
