// Reader of a regular expression's characters and their places; keeps the first mistake. Private to this
// folder. One thread.
#ifndef DOCENT_GRAPH_SPARQL_REGEX_PATTERN_SCANNER_H_
#define DOCENT_GRAPH_SPARQL_REGEX_PATTERN_SCANNER_H_

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "graph/sparql/regex/regex_parser.h"

namespace docent::sparql {

class PatternScanner {
 public:
  static constexpr char32_t kNone = 0xFFFFFFFF;  // past the end

  // `drop_space`: skips white space outside classes, also after a backslash (flag x).
  PatternScanner(std::string_view pattern, bool drop_space);

  bool AtEnd() const { return at_ == characters_.size(); }
  char32_t Peek(size_t ahead = 0) const {
    return at_ + ahead < characters_.size() ? characters_[at_ + ahead].first : kNone;
  }
  // As Peek(), and moves past the character.
  char32_t Take() { return AtEnd() ? kNone : characters_[at_++].first; }
  bool Accept(char32_t c) {
    const bool there = Peek() == c;
    if (there) ++at_;
    return there;
  }
  // The offset of the next character, in bytes of the pattern.
  size_t offset() const { return at_ < characters_.size() ? characters_[at_].second : bytes_; }
  // The pattern's text from `offset` to the next character, in quotes.
  std::string Quoted(size_t offset) const;

  bool ok() const { return !mistake_; }
  // Reports a mistake from `offset` to the next character.
  void Fail(size_t offset, std::string message, std::string hint = "");
  std::optional<RegexMistake> TakeMistake() { return std::move(mistake_); }

 private:
  std::string_view pattern_;
  std::vector<std::pair<char32_t, uint32_t>> characters_;  // with the offset of each
  size_t at_ = 0;
  size_t bytes_;
  std::optional<RegexMistake> mistake_;
};

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_REGEX_PATTERN_SCANNER_H_
