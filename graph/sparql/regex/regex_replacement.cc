#include "graph/sparql/regex/regex_replacement.h"

namespace docent::sparql {
namespace {

RegexMistake Mistake(std::string message, std::string hint, size_t offset) {
  return {std::move(message), std::move(hint), RegexMistake::Where::kReplacement, offset, 1};
}

}  // namespace

std::optional<RegexMistake> ReadReplacement(std::string_view replacement, int groups, bool literal,
                                            RegexReplacement* out) {
  *out = RegexReplacement{};
  const auto digit = [&](size_t i) {
    return i < replacement.size() && replacement[i] >= '0' && replacement[i] <= '9';
  };
  for (size_t i = 0; i < replacement.size(); ++i) {
    const char c = replacement[i];
    if (literal || (c != '\\' && c != '$')) {
      out->texts.back().push_back(c);
    } else if (c == '\\') {
      if (++i >= replacement.size() || (replacement[i] != '\\' && replacement[i] != '$')) {
        return Mistake("a backslash must be followed by '\\' or '$'", "write \\\\ for the backslash itself",
                       i - 1);
      }
      out->texts.back().push_back(replacement[i]);
    } else {
      if (!digit(++i))
        return Mistake("'$' must be followed by a digit", "write \\$ for the character itself", i - 1);
      int group = replacement[i] - '0';
      while (digit(i + 1) && group * 10 + (replacement[i + 1] - '0') <= groups)
        group = group * 10 + (replacement[++i] - '0');
      if (group > groups) continue;
      out->groups.push_back(group);
      out->texts.emplace_back();
    }
  }
  for (const std::string& text : out->texts) out->text_bytes += text.size();
  return std::nullopt;
}

}  // namespace docent::sparql
