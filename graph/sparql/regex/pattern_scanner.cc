#include "graph/sparql/regex/pattern_scanner.h"

#include <algorithm>

#include "graph/rdf/utf8.h"

namespace docent::sparql {
namespace {

bool IsSpace(char32_t c) {
  return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

}  // namespace

PatternScanner::PatternScanner(std::string_view pattern, bool drop_space)
    : pattern_(pattern), bytes_(pattern.size()) {
  characters_.reserve(pattern.size());
  int classes = 0;  // open character classes
  bool escaped = false;
  for (size_t at = 0; at < pattern.size();) {
    const auto offset = static_cast<uint32_t>(at);
    const char32_t c = NextCodePoint(pattern, &at);
    if (drop_space && classes == 0 && IsSpace(c)) continue;
    characters_.emplace_back(c, offset);
    if (!escaped && c == '[') ++classes;
    if (!escaped && c == ']' && classes > 0) --classes;
    escaped = !escaped && c == '\\';
  }
}

std::string PatternScanner::Quoted(size_t offset) const {
  return "'" + std::string(pattern_.substr(offset, this->offset() - offset)) + "'";
}

void PatternScanner::Fail(size_t offset, std::string message, std::string hint) {
  if (mistake_) return;
  const size_t length = std::max<size_t>(1, this->offset() - std::min(offset, this->offset()));
  mistake_ = {std::move(message), std::move(hint), RegexMistake::Where::kPattern, offset, length};
}

}  // namespace docent::sparql
