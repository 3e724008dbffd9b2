// Texts that are longer than what is kept or shown of them. Any thread.
#ifndef DOCENT_GRAPH_BASE_CUT_TEXT_H_
#define DOCENT_GRAPH_BASE_CUT_TEXT_H_

#include <cstddef>
#include <string>
#include <string_view>

namespace docent {

// The text, where it has at most `most` bytes; else its beginning, so long, and "… (cut, of 70000 bytes)". Characters stay
// whole.
std::string CutText(std::string_view text, size_t most);

// The text with line breaks and other control characters of ASCII as spaces, for a line of a longer text.
std::string OneLine(std::string_view text);

}  // namespace docent

#endif  // DOCENT_GRAPH_BASE_CUT_TEXT_H_
