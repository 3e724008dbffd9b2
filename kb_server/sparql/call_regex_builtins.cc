// REGEX and REPLACE (SPARQL 1.1 sections 17.4.3.14 and 17.4.3.15) on RE2: linear time and bounded memory
// whatever the expression, so a query cannot hang the server. What RE2 does not have (back-references,
// look-around) is an error.
#include <re2/re2.h>

#include "kb_server/sparql/expression_evaluator.h"

namespace docent::sparql {

using Type = Value::Type;

namespace {

constexpr int64_t kRegexMemoryBytes = 8 << 20;

// XPath's \\d and \\w mean the characters of Unicode, RE2's those of ASCII. What stands for `letter` outside a class and
// within one; empty: as RE2 has it.
std::string_view UnicodeClass(char letter, bool within) {
  switch (letter) {
    case 'd':
      return "\\p{Nd}";
    case 'D':
      return "\\P{Nd}";
    case 'w':  // everything but punctuation, separators and others
      return within ? "\\pL\\pM\\pN\\pS" : "[\\pL\\pM\\pN\\pS]";
    case 'W':
      return within ? "\\pP\\pZ\\pC" : "[\\pP\\pZ\\pC]";
    default:
      return {};
  }
}

// XPath and XQuery Functions section 5.6.1.1: flags s, m, i, x, q. Null: not valid, or a class subtraction ([a-z-[aeiou]]),
// which RE2 does not have and would read as something else.
std::shared_ptr<re2::RE2> Compile(std::string_view pattern, std::string_view flags) {
  re2::RE2::Options options;
  options.set_log_errors(false);
  options.set_max_mem(kRegexMemoryBytes);
  std::string source;
  bool multi_line = false, literal = false, drop_space = false;
  for (const char flag : flags) {
    switch (flag) {
      case 'i':
        options.set_case_sensitive(false);
        break;
      case 's':
        options.set_dot_nl(true);
        break;
      case 'm':
        multi_line = true;
        break;
      case 'x':
        drop_space = true;
        break;
      case 'q':
        literal = true;
        break;
      default:
        return nullptr;
    }
  }
  options.set_literal(literal);
  if (literal) source = pattern;
  bool within = false;  // a class
  for (size_t i = 0; i < pattern.size() && !literal; ++i) {
    const char c = pattern[i];
    if (drop_space && !within && (c == ' ' || c == '\t' || c == '\n' || c == '\r')) continue;
    if (c == '\\' && i + 1 < pattern.size()) {
      const std::string_view of_unicode = UnicodeClass(pattern[++i], within);
      source += of_unicode.empty() ? pattern.substr(i - 1, 2) : of_unicode;
      continue;
    }
    if (within && c == '[' && pattern[i - 1] == '-') return nullptr;
    within = within ? c != ']' : c == '[';
    source.push_back(c);
  }
  if (multi_line && !literal) source = "(?m)" + source;
  auto compiled = std::make_shared<re2::RE2>(source, options);
  return compiled->ok() ? compiled : nullptr;
}

// The compiled expression of this call, kept while pattern and flags stay the same.
re2::RE2* Prepared(PlanExpression& e, const Value& pattern, std::string_view flags) {
  std::string source(flags);
  source.push_back('/');
  source += pattern.text();
  if (source != e.regex_source || !e.regex) {
    e.regex = Compile(pattern.text(), flags);
    e.regex_source = std::move(source);
  }
  return e.regex.get();
}

// XPath's replacement ($1, \$) as RE2 writes it (\1). nullopt if it is not valid.
std::optional<std::string> Rewrite(std::string_view replacement, int groups, bool literal) {
  std::string out;
  for (size_t i = 0; i < replacement.size(); ++i) {
    const char c = replacement[i];
    if (literal) {
      if (c == '\\') out.push_back('\\');
      out.push_back(c);
    } else if (c == '\\') {
      if (++i >= replacement.size() || (replacement[i] != '\\' && replacement[i] != '$')) return std::nullopt;
      if (replacement[i] == '\\') out.push_back('\\');
      out.push_back(replacement[i]);
    } else if (c == '$') {
      if (++i >= replacement.size() || replacement[i] < '0' || replacement[i] > '9') return std::nullopt;
      if (replacement[i] - '0' > groups) continue;  // an absent group is empty
      out.push_back('\\');
      out.push_back(replacement[i]);
    } else {
      out.push_back(c);
    }
  }
  return out;
}

// At most so long is `text` with all matches of `regex` replaced.
size_t LengthReplaced(const re2::StringPiece& text, const re2::RE2& regex, const std::string& rewrite) {
  const size_t references = static_cast<size_t>(std::count(rewrite.begin(), rewrite.end(), '\\'));
  constexpr size_t kLittle = 1 << 20;
  size_t matches = text.size() + 1;
  // Matches share no character, so each reference gives the whole text at most once.
  const auto length = [&] { return text.size() * (1 + references) + matches * rewrite.size(); };
  if (length() <= kLittle) return length();
  matches = 0;
  re2::StringPiece match;
  for (size_t at = 0; at <= text.size() && regex.Match(text, at, text.size(), re2::RE2::UNANCHORED, &match, 1); ++matches) {
    const size_t end = static_cast<size_t>(match.data() - text.data()) + match.size();
    at = match.empty() ? end + 1 : end;
  }
  return length();
}

}  // namespace

Value CallRegexBuiltin(PlanExpression& e, const std::vector<Value>& a, EvaluationContext& context) {
  const size_t flags_at = e.builtin == Builtin::kRegex ? 2 : 3;
  if (!a[0].IsStringLike() || a[1].type() != Type::kString) return Value::Error();
  if (a.size() > flags_at && a[flags_at].type() != Type::kString) return Value::Error();
  const std::string_view flags = a.size() > flags_at ? a[flags_at].text() : std::string_view();
  re2::RE2* regex = Prepared(e, a[1], flags);
  if (regex == nullptr) return Value::Error();
  const std::string_view text = a[0].text();
  const re2::StringPiece piece(text.data(), text.size());
  if (e.builtin == Builtin::kRegex) return Value::Boolean(re2::RE2::PartialMatch(piece, *regex));
  if (a[2].type() != Type::kString) return Value::Error();
  if (re2::RE2::FullMatch("", *regex)) return Value::Error();  // FORX0003: it matches the empty string
  const bool literal = flags.find('q') != std::string_view::npos;
  const std::optional<std::string> rewrite = Rewrite(a[2].text(), regex->NumberOfCapturingGroups(), literal);
  if (!rewrite || !context.HasRoom(2 * LengthReplaced(piece, *regex, *rewrite))) return Value::Error();
  std::string out(text);
  re2::RE2::GlobalReplace(&out, *regex, *rewrite);
  if (a[0].type() == Type::kLangString)
    return Value::LangString(std::move(out), std::string(a[0].language()));
  return Value::String(std::move(out));
}

}  // namespace docent::sparql
