#include "graph/rdf/turtle_scanner.h"

#include <array>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "graph/base/text.h"
#include "graph/rdf/iri.h"
#include "graph/rdf/utf8.h"
#include "graph/rdf/vocabulary.h"

namespace docent {
namespace {

bool IsDigit(char c) {
  return c >= '0' && c <= '9';
}
bool IsLetter(char c) {
  return absl::ascii_isalpha(static_cast<unsigned char>(c));
}

// Turtle [163s] PN_CHARS_BASE.
bool IsNameBase(char32_t c) {
  constexpr std::array<std::pair<char32_t, char32_t>, 14> kRanges = {{{'A', 'Z'},
                                                                      {'a', 'z'},
                                                                      {0xC0, 0xD6},
                                                                      {0xD8, 0xF6},
                                                                      {0xF8, 0x2FF},
                                                                      {0x370, 0x37D},
                                                                      {0x37F, 0x1FFF},
                                                                      {0x200C, 0x200D},
                                                                      {0x2070, 0x218F},
                                                                      {0x2C00, 0x2FEF},
                                                                      {0x3001, 0xD7FF},
                                                                      {0xF900, 0xFDCF},
                                                                      {0xFDF0, 0xFFFD},
                                                                      {0x10000, 0xEFFFF}}};
  for (auto [low, high] : kRanges) {
    if (c >= low && c <= high) return true;
  }
  return false;
}

}  // namespace

bool IsNameStart(char32_t c) {
  return c == '_' || IsNameBase(c);
}
bool IsNameChar(char32_t c) {
  return IsNameStart(c) || c == '-' || (c >= '0' && c <= '9') || c == 0xB7 || (c >= 0x300 && c <= 0x36F) ||
         (c >= 0x203F && c <= 0x2040);
}

namespace {

// Turtle [172s] PN_LOCAL_ESC.
bool IsEscapableInName(char c) {
  return c != '\0' && std::string_view("_~.-!$&'()*+,;=/?#@%").find(c) != std::string_view::npos;
}

}  // namespace

void TurtleScanner::SkipSpace() {
  if (!line_based_) return SkipLines();
  while (Peek() == ' ' || Peek() == '\t') ++position_;
}

void TurtleScanner::SkipSpaceWithinLiteral() {
  const size_t before = position_;
  SkipSpace();
  const std::string_view rest = text_.substr(position_);
  const bool tag = rest.starts_with('@') && !rest.starts_with("@prefix") && !rest.starts_with("@base");
  if (!tag && !rest.starts_with("^^")) position_ = before;
}

void TurtleScanner::SkipLines() {
  while (!AtEnd()) {
    char c = text_[position_];
    if (c == ' ' || c == '\t' || c == '\n' || c == '\r') {
      ++position_;
    } else if (c == '#') {
      while (!AtEnd() && text_[position_] != '\n' && text_[position_] != '\r') ++position_;
    } else {
      return;
    }
  }
}

bool TurtleScanner::Take(char c) {
  if (Peek() != c || AtEnd()) return false;
  ++position_;
  return true;
}

bool TurtleScanner::TakeKeyword(std::string_view word, bool any_case) {
  if ((Peek() | 0x20) != (word[0] | 0x20)) return false;  // the common case
  std::string_view next = text_.substr(position_, word.size());
  bool same =
      any_case ? absl::AsciiStrToLower(ToAbsl(next)) == absl::AsciiStrToLower(ToAbsl(word)) : next == word;
  if (!same) return false;
  size_t after = position_ + word.size();
  if (after < text_.size()) {
    size_t at = after;
    char32_t c = NextCodePoint(text_, &at);
    if (IsNameChar(c) || c == ':') return false;
    // A dot continues a name only if more of the name follows.
    if (c == '.' && at < text_.size() && IsNameChar(NextCodePoint(text_, &at))) return false;
  }
  position_ = after;
  return true;
}

bool TurtleScanner::TakeDirective(std::string_view word) {
  if (text_.substr(position_, word.size() + 1) != Concat(word, ":")) return TakeKeyword(word, false);
  position_ += word.size();
  return true;
}

void TurtleScanner::SkipToNextStatement() {
  for (; !AtEnd(); ++position_) {
    char c = text_[position_];
    if (line_based_ ? c == '\n'
                    : c == '.' && (position_ + 1 == text_.size() || absl::ascii_isspace(Peek(1)))) {
      ++position_;
      return;
    }
  }
}

bool TurtleScanner::ReadIri(std::string* iri) {
  size_t start = position_++;
  iri->clear();
  while (!AtEnd()) {
    const size_t run = position_;  // of characters that stand for themselves
    while (!AtEnd() && text_[position_] != '>' && text_[position_] != '\\' &&
           !IsForbiddenInIri(static_cast<unsigned char>(text_[position_]))) {
      ++position_;
    }
    iri->append(text_.substr(run, position_ - run));
    if (AtEnd()) break;
    char c = text_[position_];
    if (c == '>') {
      ++position_;
      return CheckLength(start, iri->size());
    }
    char32_t decoded = static_cast<unsigned char>(c);
    size_t at = position_;
    if (c == '\\') {
      if (!ReadUnicodeEscape(&decoded)) return false;
      AppendUtf8(decoded, iri);
    } else {
      *iri += c;
      ++position_;
    }
    if (!IsForbiddenInIri(decoded)) continue;
    if (decoded == '\n' || decoded == '\r') break;
    return FailAt(at, position_ - at,
                  absl::StrFormat("U+%04X is not allowed in an IRI", static_cast<uint32_t>(decoded)),
                  "write it percent-encoded, a space as %20");
  }
  return FailAt(start, 1, "this '<' opens an IRI that has no '>' on its line");
}

bool TurtleScanner::ReadPrefix(std::string_view* prefix) {
  size_t start = position_, at = start, end = start;
  bool first = true;
  while (at < text_.size() && text_[at] != ':') {
    size_t next = at;
    char32_t c = NextCodePoint(text_, &next);
    if (first ? !IsNameBase(c) : !(IsNameChar(c) || c == '.')) break;
    first = false;
    at = next;
    if (c != '.') end = at;
  }
  if (at >= text_.size() || text_[at] != ':')
    return Fail("expected a prefixed name", "a name needs a colon, as in ex:name", true);
  if (end != at)
    return FailAt(start, at - start,
                  Concat("the prefix '", text_.substr(start, at - start), "' ends in a dot"));
  *prefix = text_.substr(start, at - start);
  position_ = at + 1;
  return true;
}

bool TurtleScanner::ReadPrefixedName(std::string_view* prefix, std::string* local) {
  size_t start = position_;
  if (!ReadPrefix(prefix)) return false;
  local->clear();
  size_t kept = position_, kept_size = 0;  // up to the last character that is not a dot
  while (!AtEnd()) {
    char c = text_[position_];
    if (c == '%') {
      if (!absl::ascii_isxdigit(Peek(1)) || !absl::ascii_isxdigit(Peek(2))) {
        return FailAt(position_, 1, "'%' in a name needs two hexadecimal digits after it",
                      "write \\% for the character");
      }
      *local += text_.substr(position_, 3);
      position_ += 3;
    } else if (c == '\\') {
      if (!IsEscapableInName(Peek(1)))
        return FailAt(position_, 2, "this character can't be escaped in a name", "use <…>");
      *local += Peek(1);
      position_ += 2;
    } else {
      size_t next = position_;
      char32_t code = NextCodePoint(text_, &next);
      bool first = local->empty();
      bool fits = first ? IsNameStart(code) || code == ':' || IsDigit(c)
                        : IsNameChar(code) || code == ':' || code == '.';
      if (!fits) break;
      *local += text_.substr(position_, next - position_);
      position_ = next;
      if (code == '.') continue;
    }
    kept = position_;
    kept_size = local->size();
  }
  position_ = kept;
  local->resize(kept_size);
  return CheckLength(start, prefix->size() + local->size());
}

bool TurtleScanner::ReadBlankLabel(std::string_view* label) {
  size_t start = position_ + 2, at = start, end = start;
  while (at < text_.size()) {
    size_t next = at;
    char32_t c = NextCodePoint(text_, &next);
    bool fits = at == start ? IsNameStart(c) || (c >= '0' && c <= '9') : IsNameChar(c) || c == '.';
    if (!fits) break;
    at = next;
    if (c != '.') end = at;
  }
  if (end == start)
    return FailAt(position_, 2, "expected a label after '_:'",
                  "a label begins with a letter, a digit or '_'");
  *label = text_.substr(start, end - start);
  position_ = end;
  return CheckLength(start, label->size());
}

bool TurtleScanner::ReadUnicodeEscape(char32_t* c) {
  size_t start = position_;
  size_t digits = Peek(1) == 'u' ? 4 : Peek(1) == 'U' ? 8 : 0;
  if (digits == 0) return FailAt(start, 2, "unknown escape", "only \\uXXXX and \\UXXXXXXXX are allowed here");
  uint32_t value = 0;
  for (size_t i = 0; i < digits; ++i) {
    char digit = Peek(2 + i);
    if (!absl::ascii_isxdigit(static_cast<unsigned char>(digit))) {
      return FailAt(start, 2 + i,
                    absl::StrCat("\\", std::string(1, Peek(1)), " needs ", digits, " hexadecimal digits"));
    }
    value = value << 4 | static_cast<uint32_t>(IsDigit(digit) ? digit - '0' : (digit | 0x20) - 'a' + 10);
  }
  if (value > 0x10FFFF || (value >= 0xD800 && value <= 0xDFFF)) {
    return FailAt(
        start, 2 + digits, absl::StrFormat("U+%04X is not a Unicode character", value),
        value > 0x10FFFF ? "the last is U+10FFFF" : "write the character itself, not its UTF-16 surrogates");
  }
  position_ += 2 + digits;
  *c = value;
  return true;
}

bool TurtleScanner::ReadStringEscape(std::string* value) {
  constexpr std::string_view kNames = "tbnrf\"'\\", kValues = "\t\b\n\r\f\"'\\";
  size_t known = AtEnd() || Peek(1) == '\0' ? std::string_view::npos : kNames.find(Peek(1));
  if (known != std::string_view::npos) {
    *value += kValues[known];
    position_ += 2;
    return true;
  }
  char32_t c;
  if (Peek(1) != 'u' && Peek(1) != 'U')
    return FailAt(position_, 2, "unknown escape in a string", "a backslash is written \\\\");
  if (!ReadUnicodeEscape(&c)) return false;
  AppendUtf8(c, value);
  return true;
}

bool TurtleScanner::ReadString(std::string* value) {
  size_t start = position_;
  char quote = Peek();
  bool is_long = !line_based_ && Peek(1) == quote && Peek(2) == quote;
  position_ += is_long ? 3 : 1;
  value->clear();
  while (!AtEnd()) {
    const size_t run = position_;
    while (!AtEnd() && text_[position_] != quote && text_[position_] != '\\' && text_[position_] != '\n' &&
           text_[position_] != '\r') {
      ++position_;
    }
    value->append(text_.substr(run, position_ - run));
    if (AtEnd()) break;
    char c = text_[position_];
    if (c == quote && (!is_long || (Peek(1) == quote && Peek(2) == quote))) {
      position_ += is_long ? 3 : 1;
      return CheckLength(start, value->size());
    }
    if (c == '\\') {
      if (!ReadStringEscape(value)) return false;
      continue;
    }
    if (!is_long && (c == '\n' || c == '\r')) break;
    *value += c;
    ++position_;
  }
  if (is_long) return FailAt(start, 3, "this string has no end");
  return FailAt(
      start, 1, "this string has no end on its line",
      line_based_ ? "write \\n for an end of line" : "write \\n for an end of line, or \"\"\"…\"\"\"");
}

bool TurtleScanner::ReadLanguage(std::string_view* tag) {
  size_t start = position_++;
  size_t at = position_;
  while (IsLetter(Peek())) ++position_;
  bool ok = position_ > at;
  while (ok && Peek() == '-') {
    size_t part = ++position_;
    while (IsLetter(Peek()) || IsDigit(Peek())) ++position_;
    ok = position_ > part;
  }
  if (!ok && position_ > at && Peek() == '-') {
    return FailAt(position_ - 1, 2,
                  "base directions of texts, as in \"…\"@en--ltr, are of RDF 1.2, which is not read",
                  "leave the direction out");
  }
  if (!ok)
    return FailAt(start, position_ - start, "expected a language tag after '@'", "as in \"colour\"@en-GB");
  *tag = text_.substr(at, position_ - at);
  return CheckLength(start, tag->size());
}

bool TurtleScanner::AtNumber() const {
  size_t sign = Peek() == '+' || Peek() == '-' ? 1 : 0;
  return IsDigit(Peek(sign)) || (Peek(sign) == '.' && IsDigit(Peek(sign + 1)));
}

bool TurtleScanner::ReadNumber(std::string_view* lexical, std::string_view* datatype) {
  size_t start = position_;
  *datatype = kXsdInteger;
  if (Peek() == '+' || Peek() == '-') ++position_;
  while (IsDigit(Peek())) ++position_;
  // "1." is an integer and the end of a statement, "1.E0" a double.
  size_t exponent_at = 1;
  while (IsDigit(Peek(exponent_at))) ++exponent_at;
  bool exponent_after = Peek(exponent_at) == 'e' || Peek(exponent_at) == 'E';
  size_t sign = Peek(exponent_at + 1) == '+' || Peek(exponent_at + 1) == '-' ? 1 : 0;
  exponent_after = exponent_after && IsDigit(Peek(exponent_at + 1 + sign));
  if (Peek() == '.' && (IsDigit(Peek(1)) || exponent_after)) {
    *datatype = kXsdDecimal;
    ++position_;
    while (IsDigit(Peek())) ++position_;
  }
  if (Peek() == 'e' || Peek() == 'E') {
    *datatype = kXsdDouble;
    ++position_;
    if (Peek() == '+' || Peek() == '-') ++position_;
    if (!IsDigit(Peek()))
      return FailAt(start, position_ - start, "expected digits in the exponent of this number");
    while (IsDigit(Peek())) ++position_;
  }
  *lexical = text_.substr(start, position_ - start);
  return CheckLength(start, lexical->size());
}

bool TurtleScanner::CheckLength(size_t start, size_t length) {
  if (length <= term_bytes_) return true;
  return FailAt(start, 1,
                absl::StrCat("this term has ", length, " bytes, the limit term_bytes is ", term_bytes_));
}

std::string TurtleScanner::Found() const {
  if (AtEnd()) return "the end of the document";
  size_t end = position_;
  NextCodePoint(text_, &end);
  while (end < text_.size() && end - position_ < 30 &&
         !absl::ascii_isspace(static_cast<unsigned char>(text_[end]))) {
    NextCodePoint(text_, &end);
  }
  if (Peek() == '\n' || Peek() == '\r') return "the end of the line";
  return Concat("'", text_.substr(position_, end - position_), "'");
}

bool TurtleScanner::Fail(std::string message, std::string hint, bool name_found) {
  if (name_found) message += ", found " + Found();
  return FailAt(position_, AtEnd() ? 0 : 1, std::move(message), std::move(hint));
}

bool TurtleScanner::FailAt(size_t offset, size_t length, std::string message, std::string hint) {
  failure_ = {offset, length, std::move(message), std::move(hint)};
  return false;
}

}  // namespace docent
