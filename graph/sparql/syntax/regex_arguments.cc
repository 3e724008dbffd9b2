#include "graph/sparql/syntax/regex_arguments.h"

#include <algorithm>

#include "graph/base/text.h"
#include "graph/rdf/term.h"
#include "graph/sparql/regex/regex_parser.h"
#include "graph/sparql/regex/regex_replacement.h"
#include "graph/sparql/syntax/builtins.h"

namespace docent::sparql {
namespace {

// Bytes of the string value for the character or escape at `at` of the text; moves *at past it.
size_t TakeCharacter(std::string_view text, size_t* at) {
  if (text[*at] != '\\' || *at + 1 >= text.size()) {
    ++*at;
    return 1;
  }
  const char letter = text[*at + 1];
  const size_t digits = letter == 'u' ? 4 : letter == 'U' ? 8 : 0;
  uint32_t code = 0;
  for (const char c : text.substr(std::min(*at + 2, text.size()), digits))
    code = code * 16 + static_cast<uint32_t>(c <= '9' ? c - '0' : (c | 0x20) - 'a' + 10);
  *at = std::min(text.size(), *at + 2 + digits);
  return code < 0x80 ? 1 : code < 0x800 ? 2 : code < 0x10000 ? 3 : 4;
}

// The place in the text of `length` bytes at `offset` of the string literal written at `literal`.
SourceSpan PlaceInString(std::string_view text, const SourceSpan& literal, size_t offset, size_t length) {
  const std::string_view written = text.substr(std::min(literal.offset, text.size()));
  if (written.empty() || (written[0] != '"' && written[0] != '\'')) return literal;
  const bool is_long = written.size() > 2 && written[1] == written[0] && written[2] == written[0];
  size_t at = is_long ? 3 : 1, bytes = 0;
  while (bytes < offset && at < written.size()) bytes += TakeCharacter(written, &at);
  const size_t begin = at;
  while (bytes < offset + length && at < written.size()) bytes += TakeCharacter(written, &at);
  return SpanAt(text, literal.offset + begin, at - begin);
}

// One argument of the call.
struct Argument {
  const Expression* expression = nullptr;  // null: not given
  std::string_view what;                   // "pattern"

  bool IsComputed() const { return expression != nullptr && expression->kind != Expression::Kind::kTerm; }
  std::string_view text() const {
    return expression == nullptr ? "" : std::string_view(expression->term.lexical);
  }
};

class Checker {
 public:
  Checker(const Expression& call, std::string_view text) : call_(call), text_(text) {}

  std::optional<ArgumentMistake> Find() {
    const bool replaces = call_.builtin == Builtin::kReplace;
    const Argument pattern = At(1, "pattern"), flags = At(replaces ? 3 : 2, "flags");
    const Argument replacement = replaces ? At(2, "replacement") : Argument{};
    for (const Argument* argument : {&pattern, &flags, &replacement}) {
      if (std::optional<ArgumentMistake> mistake = FindWrongType(*argument)) return mistake;
    }
    if (flags.IsComputed()) return std::nullopt;  // the meaning of the others depends on them
    if (const auto mistake = FindFlagMistake(flags.text())) return Report(flags, *mistake);
    RegexTree tree;
    if (!pattern.IsComputed()) {
      if (const auto mistake = ParseRegex(pattern.text(), flags.text(), &tree))
        return Report(pattern, *mistake);
      if (replaces && MatchesEmptyText(tree.root)) {
        return ArgumentMistake{
            pattern.expression->span,
            "the pattern of REPLACE matches the empty string, which has no end of matches (FORX0003)",
            "use + instead of *, or {1,…}"};
      }
    }
    if (!replaces || replacement.IsComputed()) return std::nullopt;
    RegexReplacement read;
    const bool literal = flags.text().find('q') != std::string_view::npos;
    const auto mistake = ReadReplacement(replacement.text(), tree.groups, literal, &read);
    return mistake ? std::optional(Report(replacement, *mistake)) : std::nullopt;
  }

 private:
  Argument At(size_t number, std::string_view what) const {
    return {number < call_.arguments.size() ? call_.arguments[number].get() : nullptr, what};
  }

  std::optional<ArgumentMistake> FindWrongType(const Argument& argument) const {
    if (argument.expression == nullptr || argument.IsComputed()) return std::nullopt;
    const Term& term = argument.expression->term;
    if (term.IsLiteral() && term.datatype.empty() && term.language.empty()) return std::nullopt;
    return ArgumentMistake{argument.expression->span,
                           Concat("the ", argument.what, " of ", NameOf(call_.builtin),
                                  " is a string without a language, not ", ToDisplay(term)),
                           "write it in quotes: \"…\""};
  }

  ArgumentMistake Report(const Argument& argument, const RegexMistake& mistake) const {
    return {PlaceInString(text_, argument.expression->span, mistake.offset, mistake.length),
            Concat("the ", argument.what, " of ", NameOf(call_.builtin),
                   " cannot be evaluated: ", mistake.message),
            mistake.hint};
  }

  const Expression& call_;
  const std::string_view text_;
};

}  // namespace

std::optional<ArgumentMistake> FindRegexMistake(const Expression& call, std::string_view text) {
  if (call.kind != Expression::Kind::kBuiltin) return std::nullopt;
  if (call.builtin != Builtin::kRegex && call.builtin != Builtin::kReplace) return std::nullopt;
  return Checker(call, text).Find();
}

}  // namespace docent::sparql
