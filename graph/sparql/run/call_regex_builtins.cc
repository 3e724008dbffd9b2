// REGEX and REPLACE (SPARQL 1.1 sections 17.4.3.14 and 17.4.3.15) on RE2: linear time and bounded memory
// whatever the expression, so a query cannot hang the server. What RE2 does not have (back-references,
// look-around) is an error.
#include <re2/re2.h>

#include <algorithm>
#include <vector>

#include "graph/base/regex_limits.h"
#include "graph/sparql/run/expression_evaluator.h"
#include "graph/sparql/values/text.h"

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
re2::RE2* Prepared(PlanExpression& e, const Value& pattern, std::string_view flags,
                   EvaluationContext& context) {
  constexpr size_t kBytesAnInstruction = 256;  // about the time to compile it
  std::string source(flags);
  source.push_back('/');
  source += pattern.text();
  if (source != e.regex_source || !e.regex) {
    e.regex = Compile(pattern.text(), flags);
    e.regex_source = std::move(source);
    if (e.regex) context.Worked(kBytesAnInstruction * static_cast<size_t>(e.regex->ProgramSize()));
  }
  return e.regex.get();
}

// A replacement read: fixed texts, each but the last with the group that comes after it.
struct Replacement {
  std::vector<std::string> texts{""};
  std::vector<int> groups;
  size_t text_bytes = 0;
};

// XPath's replacement ($1, \$; XPath and XQuery Functions section 5.6.4). nullopt if it is not valid.
std::optional<Replacement> Read(std::string_view replacement, int groups, bool literal) {
  Replacement out;
  const auto digit = [&](size_t i) {
    return i < replacement.size() && replacement[i] >= '0' && replacement[i] <= '9';
  };
  for (size_t i = 0; i < replacement.size(); ++i) {
    const char c = replacement[i];
    if (literal || (c != '\\' && c != '$')) {
      out.texts.back().push_back(c);
    } else if (c == '\\') {
      if (++i >= replacement.size() || (replacement[i] != '\\' && replacement[i] != '$')) return std::nullopt;
      out.texts.back().push_back(replacement[i]);
    } else {
      if (!digit(++i)) return std::nullopt;
      int group = replacement[i] - '0';
      // The longest number that is a group; of others the first digit, which is an empty one then.
      while (digit(i + 1) && group * 10 + (replacement[i + 1] - '0') <= groups)
        group = group * 10 + (replacement[++i] - '0');
      if (group > groups) continue;
      out.groups.push_back(group);
      out.texts.emplace_back();
    }
  }
  for (const std::string& text : out.texts) out.text_bytes += text.size();
  return out;
}

// As regex.Match of `text` from `at` on, for its first n groups. RE2 can't be cancelled, and where an expression has too many
// states to keep, it simulates all instructions on each byte: false, with the context's status set, where that would take long.
bool Match(const re2::RE2& regex, const re2::StringPiece& text, size_t at, re2::StringPiece* groups, int n,
           EvaluationContext& context) {
  const uint64_t steps = static_cast<uint64_t>(regex.ProgramSize()) * (text.size() - at);
  constexpr RegexLimits kLimits;
  if (steps <= kLimits.regex_steps)
    return regex.Match(text, at, text.size(), re2::RE2::UNANCHORED, groups, n);
  if (context.status.ok()) {
    context.status = absl::ResourceExhaustedError(
        Concat({"evaluation stopped at its limit regex_steps = ", std::to_string(kLimits.regex_steps), ": ",
                std::to_string(regex.ProgramSize()), " instructions of a regular expression on a text of ",
                std::to_string(text.size() - at), " bytes"}));
  }
  return false;
}

// The bytes of the character that `text` begins with; 1 if it is none.
size_t CharacterBytes(std::string_view text) {
  const unsigned char first = static_cast<unsigned char>(text[0]);
  const size_t bytes = first < 0xC0 ? 1 : first < 0xE0 ? 2 : first < 0xF0 ? 3 : 4;
  return std::min(bytes, text.size());
}

// `text` with all matches replaced, as RE2::GlobalReplace does it. nullopt, with the context's status set, where the
// evaluation has to end meanwhile or the result is too long.
std::optional<std::string> Replaced(const re2::StringPiece& text, const re2::RE2& regex,
                                    const Replacement& replacement, EvaluationContext& context) {
  constexpr size_t kBytesAMatch = 1024;  // about the time of one without groups
  const int n = 1 + (replacement.groups.empty()
                         ? 0
                         : *std::max_element(replacement.groups.begin(), replacement.groups.end()));
  std::vector<re2::StringPiece> groups(static_cast<size_t>(n));
  std::string out;
  size_t room =
      std::max<size_t>(4096, text.size() + text.size() / 2);  // that there is so much was asked by the caller
  const auto grow = [&](size_t bytes) {
    if (out.size() + bytes <= room) return true;
    room = (out.size() + bytes) * 5 / 4;
    return context.HasRoom(2 * room);
  };
  size_t at = 0;
  const char* last_end = nullptr;
  while (at <= text.size() && Match(regex, text, at, groups.data(), n, context)) {
    const char* from = text.data() + at;
    const size_t before = static_cast<size_t>(groups[0].data() - from);
    size_t bytes = before + replacement.text_bytes;
    for (const int group : replacement.groups) bytes += groups[static_cast<size_t>(group)].size();
    // A match may have looked at all that is left, and have been the shorter for it.
    if (!grow(bytes) || !context.Worked(kBytesAMatch + bytes + (text.size() - at) / 16)) return std::nullopt;
    out.append(from, before);
    if (groups[0].data() == last_end && groups[0].empty()) {  // nothing, right after a match
      if (at < text.size()) {
        const size_t skipped = CharacterBytes({from, text.size() - at});
        out.append(from, skipped);
        at += skipped;
      } else {
        ++at;
      }
      continue;
    }
    for (size_t i = 0; i < replacement.texts.size(); ++i) {
      out += replacement.texts[i];
      if (i == replacement.groups.size()) break;
      const re2::StringPiece& group = groups[static_cast<size_t>(replacement.groups[i])];
      if (!group.empty()) out.append(group.data(), group.size());
    }
    last_end = groups[0].data() + groups[0].size();
    at = static_cast<size_t>(last_end - text.data());
  }
  if (!context.status.ok() || (at < text.size() && !grow(text.size() - at))) return std::nullopt;
  if (at < text.size()) out.append(text.data() + at, text.size() - at);
  return out;
}

}  // namespace

Value CallRegexBuiltin(PlanExpression& e, const std::vector<Value>& a, EvaluationContext& context) {
  const size_t flags_at = e.builtin == Builtin::kRegex ? 2 : 3;
  if (!a[0].IsStringLike() || a[1].type() != Type::kString) return Value::Error();
  if (a.size() > flags_at && a[flags_at].type() != Type::kString) return Value::Error();
  const std::string_view flags = a.size() > flags_at ? a[flags_at].text() : std::string_view();
  re2::RE2* regex = Prepared(e, a[1], flags, context);
  if (regex == nullptr) return Value::Error();
  const std::string_view text = a[0].text();
  const re2::StringPiece piece(text.data(), text.size());
  // Each call may take so many instructions: the row after it is not waited for.
  if (!context.Worked(static_cast<size_t>(regex->ProgramSize()))) return Value::Error();
  if (e.builtin == Builtin::kRegex) {
    const bool found = Match(*regex, piece, 0, nullptr, 0, context);
    return context.status.ok() ? Value::Boolean(found) : Value::Error();
  }
  if (a[2].type() != Type::kString) return Value::Error();
  if (re2::RE2::FullMatch("", *regex)) return Value::Error();  // FORX0003: it matches the empty string
  const bool literal = flags.find('q') != std::string_view::npos;
  const std::optional<Replacement> replacement = Read(a[2].text(), regex->NumberOfCapturingGroups(), literal);
  if (!replacement) return Value::Error();
  std::optional<std::string> out = Replaced(piece, *regex, *replacement, context);
  if (!out) return Value::Error();
  if (a[0].type() == Type::kLangString)
    return Value::LangString(*std::move(out), std::string(a[0].language()));
  return Value::String(*std::move(out));
}

}  // namespace docent::sparql
