// UTF-8 (RFC 3629): checking, reading and writing code points. Any thread.
#ifndef DOCENT_GRAPH_RDF_UTF8_H_
#define DOCENT_GRAPH_RDF_UTF8_H_

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace docent {

// The offset of the first byte that is not part of well-formed UTF-8 (overlong forms, surrogates and numbers
// past U+10FFFF are not well-formed); nullopt if all is.
std::optional<size_t> FindInvalidUtf8(std::string_view text);

// The code point at `*at`; moves `*at` past it. Requires well-formed text and *at < text.size().
char32_t NextCodePoint(std::string_view text, size_t* at);

// Appends `c`, a Unicode scalar value.
void AppendUtf8(char32_t c, std::string* out);

}  // namespace docent

#endif  // DOCENT_GRAPH_RDF_UTF8_H_
