#include "graph/sparql/regex/escape_parser.h"

#include <string>
#include <utility>

#include "graph/base/diagnostic.h"
#include "graph/base/text.h"
#include "graph/rdf/utf8.h"

namespace docent::sparql {
namespace {

// The hint for an escape of other regular expression languages.
std::string HintFor(char32_t letter) {
  switch (letter) {
    case 'A':
      return "^ is the start of the text";
    case 'Z':
    case 'z':
      return "$ is the end of the text";
    case 'b':
    case 'B':
      return "there are no word boundaries; write for example (^|\\W)word(\\W|$)";
    case 'x':
    case 'u':
    case 'U':
      return "write the character itself; a string of SPARQL may have it as \\u0041";
    case 'Q':
    case 'E':
      return "flag q takes every character of the pattern as itself";
    case 'h':
      return "write [ \\t]";
    case 'R':
      return "write (\\r\\n|\\n|\\r)";
    default:
      break;
  }
  if (letter >= '0' && letter <= '9') return "a back-reference is \\1 to \\9, outside of classes";
  if ((letter | 0x20) >= 'a' && (letter | 0x20) <= 'z') {
    return "the escapes are \\n \\r \\t \\s \\d \\w \\i \\c, their opposites in capitals, \\p{…}, \\P{…}, "
           "\\1 to \\9, and a "
           "backslash before one of \\|.?*+(){}[]-^$";
  }
  return "write the character without the backslash";
}

bool IsNameCharacter(char32_t c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-';
}

// {L} or {IsGreek}, after \p or \P.
CharacterSetPtr ReadProperty(PatternScanner* scanner, size_t start) {
  if (!scanner->Accept('{')) {
    scanner->Fail(start, Concat(scanner->Quoted(start), " needs a property in braces"),
                  "write \\p{L} for letters, \\p{Nd} for digits, \\p{IsGreek} for a block");
    return nullptr;
  }
  std::string name;
  while (IsNameCharacter(scanner->Peek())) name += static_cast<char>(scanner->Take());
  if (!scanner->Accept('}')) {
    scanner->Fail(start, Concat(scanner->Quoted(start), " is not closed by '}'"));
    return nullptr;
  }
  const bool is_block = name.substr(0, 2) == "Is";
  CharacterSetPtr set = is_block ? BlockSet(name.substr(2)) : CategorySet(name);
  if (set != nullptr) return set;
  if (is_block) {
    const std::string near = Nearest(name.substr(2), BlockNames());
    scanner->Fail(
        start, Concat("'", name.substr(2), "' is not a block of Unicode"),
        near.empty() ? "a block's name is written without its spaces" : "did you mean Is" + near + "?");
  } else {
    scanner->Fail(
        start, Concat("'", name, "' is not a category of Unicode"),
        "categories are L, Lu, Ll, Lt, Lm, Lo, M…, N…, P…, Z…, S…, C…; a block is written \\p{IsGreek}");
  }
  return nullptr;
}

}  // namespace

std::optional<Escape> ReadEscape(PatternScanner* scanner) {
  const size_t start = scanner->offset();
  scanner->Take();
  if (scanner->AtEnd()) {
    scanner->Fail(start, "the pattern ends with a backslash", "write \\\\ for the character itself");
    return std::nullopt;
  }
  const char32_t letter = scanner->Take();
  switch (letter) {
    case 'n':
      return Escape{'\n', nullptr};
    case 'r':
      return Escape{'\r', nullptr};
    case 't':
      return Escape{'\t', nullptr};
    case 'p':
    case 'P': {
      CharacterSetPtr set = ReadProperty(scanner, start);
      if (set == nullptr) return std::nullopt;
      if (letter == 'P') set = std::make_shared<const CharacterSet>(set->Complement());
      return Escape{0, std::move(set)};
    }
    default:
      break;
  }
  if (letter < 128 &&
      std::string_view("\\|.?*+(){}[]-^$").find(static_cast<char>(letter)) != std::string_view::npos)
    return Escape{letter, nullptr};
  if (letter != '.') {
    if (CharacterSetPtr set = EscapeSet(letter)) return Escape{0, std::move(set)};
  }
  scanner->Fail(start, Concat(scanner->Quoted(start), " is not an escape of XPath's regular expressions"),
                HintFor(letter));
  return std::nullopt;
}

}  // namespace docent::sparql
