// Classes of ASCII characters, and a search for the end of a run of one class. Pure functions.
#ifndef DOCENT_GRAPH_SPARQL_VALUES_ASCII_RUN_H_
#define DOCENT_GRAPH_SPARQL_VALUES_ASCII_RUN_H_

#include <array>
#include <cstdint>
#include <string_view>

namespace docent::sparql {

// The tokens that an ASCII character may be part of; all other characters occur in local names only.
enum CharacterClass : uint8_t {
  kInWord = 1,  // letters, digits, '_'
  kInName = 2,  // these and '-'
  kInIri = 4,   // [139] IRIREF
  kLetter = 8,
  kPunctuationMark = 16,
  kMarkAlone = 32,      // a complete token, whatever follows
  kBetweenTokens = 64,  // spaces, line ends, and the start of a comment
  kInLocalName = 128,   // [169] PN_LOCAL may continue with it, or with a character beyond ASCII
};
inline constexpr std::array<uint8_t, 256> kCharacterClasses = [] {
  std::array<uint8_t, 256> classes{};
  for (int c = 1; c < 128; ++c) {
    const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
    const auto is_one_of = [c](std::string_view set) {
      return set.find(static_cast<char>(c)) != std::string_view::npos;
    };
    if (letter) classes[c] |= kLetter;
    if (letter || (c >= '0' && c <= '9') || c == '_') classes[c] |= kInWord | kInName;
    if (c == '-') classes[c] |= kInName;
    if (c > 0x20 && !is_one_of("<>\"{}|^`\\")) classes[c] |= kInIri;
    if (is_one_of(".%\\:")) classes[c] |= kInLocalName;
    if (is_one_of(" \t\r\n#")) classes[c] |= kBetweenTokens;
    if (is_one_of("{}()[].,;=<>!*/+-|^?")) classes[c] |= kPunctuationMark;
    if (is_one_of("{}()[],;=*/+-")) classes[c] |= kMarkAlone;
  }
  for (int c = 128; c < 256; ++c) classes[c] = kInLocalName;
  return classes;
}();
inline bool Is(char c, CharacterClass part) {
  return (kCharacterClasses[static_cast<uint8_t>(c)] & part) != 0;
}

// The first place from `at` on whose character is not of that class.
size_t WordEnd(std::string_view text, size_t at);
size_t NameEnd(std::string_view text, size_t at);
size_t IriEnd(std::string_view text, size_t at);
// The same for U+0001 to U+007F.
size_t AsciiEnd(std::string_view text, size_t at);

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_VALUES_ASCII_RUN_H_
