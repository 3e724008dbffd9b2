// Small operations on std::string_view (Debian's Abseil has its own string_view, so its string functions do
// not accept std::string_view). Pure functions.
#ifndef DOCENT_GRAPH_SPARQL_VALUES_TEXT_H_
#define DOCENT_GRAPH_SPARQL_VALUES_TEXT_H_

#include <string>
#include <string_view>

namespace docent::sparql {

inline char AsciiLower(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c | 0x20) : c;
}
inline char AsciiUpper(char c) {
  return c >= 'a' && c <= 'z' ? static_cast<char>(c & ~0x20) : c;
}

// Equality that ignores the case of ASCII letters.
inline bool EqualsIgnoreCase(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  for (size_t i = 0; i < a.size(); ++i) {
    if (AsciiLower(a[i]) != AsciiLower(b[i])) return false;
  }
  return true;
}

inline std::string LowerAscii(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = AsciiLower(c);
  return out;
}

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_VALUES_TEXT_H_
