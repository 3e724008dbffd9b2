// Functions on strings (SPARQL 1.1 section 17.4.3), on times (17.4.5) and hashes (17.4.6).
#include <openssl/evp.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "graph/sparql/run/expression_evaluator.h"
#include "graph/sparql/values/case_map.h"
#include "graph/sparql/values/text.h"
#include "graph/sparql/values/time_text.h"

namespace docent::sparql {

using Type = Value::Type;

namespace {

// As text.find(part), whose worst-case time is the product of both lengths ("aaa…" in "aaa…"), but in linear
// time. glibc's memmem is the Two-Way algorithm (Crochemore and Perrin 1991) for all but short parts; its
// preparation is too slow for short texts.
size_t Find(std::string_view text, std::string_view part) {
  constexpr size_t kShortText = 1024, kShortPart = 8;
  if (text.size() <= kShortText || part.size() <= kShortPart) return text.find(part);
  const void* at = memmem(text.data(), text.size(), part.data(), part.size());
  return at == nullptr ? std::string_view::npos
                       : static_cast<size_t>(static_cast<const char*>(at) - text.data());
}

bool IsContinuation(char c) {
  return (static_cast<unsigned char>(c) & 0xC0) == 0x80;
}

// A string with the language tag of `like`.
Value SameKind(const Value& like, std::string text) {
  if (like.type() == Type::kLangString)
    return Value::LangString(std::move(text), std::string(like.language()));
  return Value::String(std::move(text));
}

// Argument compatibility (section 17.4.3.1.2)
bool Compatible(const Value& a, const Value& b) {
  if (!a.IsStringLike() || !b.IsStringLike()) return false;
  return b.type() == Type::kString ||
         (a.type() == Type::kLangString && EqualsIgnoreCase(a.language(), b.language()));
}

// CONTAINS, STRSTARTS or STRENDS.
bool Holds(Builtin test, std::string_view text, std::string_view part) {
  if (test == Builtin::kContains) return Find(text, part) != std::string_view::npos;
  return test == Builtin::kStrStarts ? text.starts_with(part) : text.ends_with(part);
}

// The text of a plain string in the query or the dictionary.
std::optional<std::string_view> PlainText(const PlanExpression& e, const TermId* row,
                                          const Dictionary& dictionary) {
  if (e.kind == Expression::Kind::kTerm && e.constant.type() == Type::kString) return e.constant.text();
  if (e.kind != Expression::Kind::kVariable || row[e.slot].tag() != TermId::Tag::kLiteral)
    return std::nullopt;
  const Dictionary::LiteralView literal = dictionary.Literal(row[e.slot]);
  if (!literal.datatype.empty() || !literal.language.empty()) return std::nullopt;
  return literal.lexical;
}

int64_t LengthInCodePoints(std::string_view text) {
  int64_t n = 0;
  for (const char c : text) n += IsContinuation(c) ? 0 : 1;
  return n;
}

// Code points from position `first` (1-based, may be outside) to before `last`, counted as in fn:substring.
std::string Substring(std::string_view text, double first, double last) {
  std::string out;
  double position = 0;
  for (const char c : text) {
    if (!IsContinuation(c)) position += 1;
    if (!(position < last)) break;  // NaN, too
    if (position >= first) out.push_back(c);
  }
  return out;
}

double RoundHalfUp(double x) {
  return std::floor(x + 0.5);
}

Value CallSubstr(const std::vector<Value>& a) {
  if (!a[0].IsStringLike() || !a[1].IsNumeric() || (a.size() > 2 && !a[2].IsNumeric())) return Value::Error();
  const double first = RoundHalfUp(a[1].AsDouble());
  const double last =
      a.size() > 2 ? first + RoundHalfUp(a[2].AsDouble()) : std::numeric_limits<double>::infinity();
  return SameKind(a[0], Substring(a[0].text(), first, last));
}

Value CallConcat(const std::vector<Value>& arguments) {
  size_t bytes = 0;
  for (const Value& v : arguments) bytes += v.text().size();
  std::string out;
  out.reserve(bytes);
  bool same_language = !arguments.empty();
  for (const Value& v : arguments) {
    if (!v.IsStringLike()) return Value::Error();
    out += v.text();
    same_language &= v.type() == Type::kLangString && EqualsIgnoreCase(v.language(), arguments[0].language());
  }
  return same_language ? Value::LangString(std::move(out), std::string(arguments[0].language()))
                       : Value::String(std::move(out));
}

// RFC 4647 section 3.3.1, and "*" for any tag
bool LanguageMatches(std::string_view tag, std::string_view range) {
  if (range == "*") return !tag.empty();
  if (tag.size() < range.size() || !EqualsIgnoreCase(tag.substr(0, range.size()), range)) return false;
  return tag.size() == range.size() || tag[range.size()] == '-';
}

std::string EncodeForUri(std::string_view text) {
  static constexpr char kHex[] = "0123456789ABCDEF";
  std::string out;
  for (const char c : text) {
    const bool unreserved = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                            c == '-' || c == '_' || c == '.' || c == '~';
    if (unreserved) {
      out.push_back(c);
    } else {
      out.push_back('%');
      out.push_back(kHex[static_cast<unsigned char>(c) >> 4]);
      out.push_back(kHex[static_cast<unsigned char>(c) & 15]);
    }
  }
  return out;
}

}  // namespace

std::optional<bool> TestPlainTexts(const PlanExpression& e, const TermId* row, EvaluationContext& context) {
  constexpr size_t kShort = 4096;  // bytes; longer results are charged as memory, as for all functions
  const auto text = PlainText(*e.arguments[0], row, context.dictionary);
  if (!text) return std::nullopt;
  const auto part = PlainText(*e.arguments[1], row, context.dictionary);
  if (!part || text->size() + part->size() > kShort || !context.Worked(text->size() + part->size()))
    return std::nullopt;
  return Holds(e.builtin, *text, *part);
}

Value CallStringBuiltin(PlanExpression& e, const std::vector<Value>& a, EvaluationContext& context) {
  (void)context;
  if (e.builtin == Builtin::kConcat) return CallConcat(a);
  if (e.builtin == Builtin::kSubstr) return CallSubstr(a);
  if (!a[0].IsStringLike()) return Value::Error();
  const std::string_view text = a[0].text();
  switch (e.builtin) {
    case Builtin::kLangMatches:
      if (a[0].type() != Type::kString || a[1].type() != Type::kString) return Value::Error();
      return Value::Boolean(LanguageMatches(text, a[1].text()));
    case Builtin::kStrlen:
      return Value::Integer(LengthInCodePoints(text));
    case Builtin::kUcase:
      return SameKind(a[0], UpperCase(text));
    case Builtin::kLcase:
      return SameKind(a[0], LowerCase(text));
    case Builtin::kEncodeForUri:
      return Value::String(EncodeForUri(text));
    default:
      break;
  }
  if (!Compatible(a[0], a[1])) return Value::Error();
  const std::string_view other = a[1].text();
  switch (e.builtin) {
    case Builtin::kContains:
    case Builtin::kStrStarts:
    case Builtin::kStrEnds:
      return Value::Boolean(Holds(e.builtin, text, other));
    case Builtin::kStrBefore: {
      const size_t at = Find(text, other);
      return at == std::string_view::npos ? Value::String("")
                                          : SameKind(a[0], std::string(text.substr(0, at)));
    }
    case Builtin::kStrAfter: {
      const size_t at = Find(text, other);
      return at == std::string_view::npos ? Value::String("")
                                          : SameKind(a[0], std::string(text.substr(at + other.size())));
    }
    default:
      return Value::Error();
  }
}

Value CallTimeBuiltin(Builtin builtin, const Value& argument) {
  const bool date_part = builtin == Builtin::kYear || builtin == Builtin::kMonth || builtin == Builtin::kDay;
  const bool clock_part =
      builtin == Builtin::kHours || builtin == Builtin::kMinutes || builtin == Builtin::kSeconds;
  if (!argument.IsTime() || (argument.type() == Type::kDate && !date_part) ||
      (argument.type() == Type::kTime && !clock_part)) {
    return Value::Error();
  }
  const CivilTime c = ToCivil(argument.local_time_us());
  switch (builtin) {
    case Builtin::kYear:
      return Value::Integer(c.year);
    case Builtin::kMonth:
      return Value::Integer(c.month);
    case Builtin::kDay:
      return Value::Integer(c.day);
    case Builtin::kHours:
      return Value::Integer(c.hour);
    case Builtin::kMinutes:
      return Value::Integer(c.minute);
    case Builtin::kSeconds:
      return Value::OfDecimal(Decimal{c.second_us, 6});
    case Builtin::kTz:
      return Value::String(FormatZone(argument.zone_minutes()));
    default:
      break;
  }
  if (!argument.zone_minutes()) return Value::Error();
  return Value::OfDuration({Duration::Kind::kDayTime, 0, TimeMicros{*argument.zone_minutes()} * 60'000'000});
}

Value CallHashBuiltin(Builtin builtin, const Value& argument) {
  if (argument.type() != Type::kString) return Value::Error();
  const EVP_MD* method = builtin == Builtin::kMd5      ? EVP_md5()
                         : builtin == Builtin::kSha1   ? EVP_sha1()
                         : builtin == Builtin::kSha256 ? EVP_sha256()
                         : builtin == Builtin::kSha384 ? EVP_sha384()
                                                       : EVP_sha512();
  unsigned char digest[EVP_MAX_MD_SIZE];
  unsigned size = 0;
  const std::string_view text = argument.text();
  if (EVP_Digest(text.data(), text.size(), digest, &size, method, nullptr) != 1) return Value::Error();
  static constexpr char kHex[] = "0123456789abcdef";
  std::string out;
  for (unsigned i = 0; i < size; ++i) {
    out.push_back(kHex[digest[i] >> 4]);
    out.push_back(kHex[digest[i] & 15]);
  }
  return Value::String(std::move(out));
}

}  // namespace docent::sparql
