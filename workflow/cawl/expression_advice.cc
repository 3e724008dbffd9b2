#include "workflow/cawl/expression_advice.h"

#include <algorithm>
#include <optional>
#include <string_view>

#include "absl/strings/ascii.h"
#include "graph/base/text.h"

namespace docent::cawl {
namespace {

bool InName(char c) {
  return absl::ascii_isalnum(static_cast<unsigned char>(c)) || c == '_';
}

// "$request.booth" with its dot at `dot`: its first byte; nullopt: no such word stands there.
std::optional<size_t> PartBegin(std::string_view text, size_t dot) {
  if (dot + 1 >= text.size() || text[dot] != '.' || !absl::ascii_isalpha(text[dot + 1])) return std::nullopt;
  size_t begin = dot;
  while (begin > 0 && InName(text[begin - 1])) --begin;
  if (begin == dot || begin == 0 || text[begin - 1] != '$') return std::nullopt;
  return begin - 1;
}

// Words without quotes and without anything of an expression: Hello, visitor
bool IsBareText(std::string_view text) {
  const auto letter = [](char c) {
    return absl::ascii_isalpha(static_cast<unsigned char>(c)) || static_cast<unsigned char>(c) >= 0x80;
  };
  return !text.empty() && letter(text[0]) && std::all_of(text.begin(), text.end(), [&](char c) {
    return letter(c) || absl::ascii_isdigit(static_cast<unsigned char>(c)) ||
           std::string_view(" \t\r\n.,;!'-_").find(c) != std::string_view::npos;
  });
}

ExpressionAdvice OfPart(std::string_view text, size_t begin, size_t dot, bool of_input) {
  size_t end = dot + 1;
  while (end < text.size() && InName(text[end])) ++end;
  const std::string_view variable = text.substr(begin + 1, dot - begin - 1);
  const std::string_view part = text.substr(dot + 1, end - dot - 1);
  const std::string initialized =
      Concat("<variable name=\"", part, "\"><initialize><from variable=\"", variable, "\" part=\"", part,
             "\"/></initialize></variable>, and write $", part);
  ExpressionAdvice out;
  out.message =
      Concat("a part of a message cannot stand in an expression: ", text.substr(begin, end - begin));
  out.hint = of_input ? Concat("write variable=\"", variable, ".", part,
                               "\" in place of the expression, or give a variable this value: ", initialized)
                      : Concat("give a variable this value: ", initialized);
  out.span.offset = begin;
  out.span.length = end - begin;
  return out;
}

}  // namespace

ExpressionAdvice AdviceOn(const std::string& text, const Diagnostic& mistake, bool is_expression,
                          bool of_input) {
  const size_t at = mistake.span.offset;
  for (const size_t dot : {at, at - 1}) {  // the dot, or the name after it
    if (dot >= text.size()) continue;
    if (const std::optional<size_t> begin = PartBegin(text, dot)) return OfPart(text, *begin, dot, of_input);
  }
  ExpressionAdvice out{Concat("SPARQL: ", mistake.message), mistake.hint, mistake.span};
  if (!is_expression) return out;
  if (IsBareText(text)) {
    out.hint = Concat("a text needs quotes: expression='\"", text, "\"'");
  } else if (mistake.message.find("is not a function of SPARQL") != std::string::npos) {
    out.hint = "a variable of the run begins with $, a text needs quotes, and a name a prefix and ':'";
  }
  return out;
}

}  // namespace docent::cawl
