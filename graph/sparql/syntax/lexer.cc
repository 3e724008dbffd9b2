#include "graph/sparql/syntax/lexer.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <optional>
#include <utility>

#include "graph/sparql/syntax/joined_words.h"
#include "graph/sparql/values/ascii_run.h"

namespace docent::sparql {
namespace {

bool IsDigit(char c) {
  return c >= '0' && c <= '9';
}
bool IsAlpha(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}
bool IsHex(char c) {
  return IsDigit(c) || (c >= 'a' && c <= 'f') || (c >= 'A' && c <= 'F');
}
uint32_t HexValue(char c) {
  return IsDigit(c) ? c - '0' : (c | 0x20) - 'a' + 10;
}

// The code point at `at` of valid UTF-8 and its length.
std::pair<uint32_t, size_t> CodePointAt(std::string_view text, size_t at) {
  const auto byte = [&](size_t i) { return static_cast<uint8_t>(text[at + i]); };
  const uint8_t lead = byte(0);
  if (lead < 0x80) return {lead, 1};
  if (lead < 0xE0) return {(lead & 0x1Fu) << 6 | (byte(1) & 0x3Fu), 2};
  if (lead < 0xF0) return {(lead & 0x0Fu) << 12 | (byte(1) & 0x3Fu) << 6 | (byte(2) & 0x3Fu), 3};
  return {(lead & 0x07u) << 18 | (byte(1) & 0x3Fu) << 12 | (byte(2) & 0x3Fu) << 6 | (byte(3) & 0x3Fu), 4};
}

// [164] PN_CHARS_BASE without ASCII
bool IsWideNameStart(uint32_t c) {
  return (c >= 0xC0 && c <= 0xD6) || (c >= 0xD8 && c <= 0xF6) || (c >= 0xF8 && c <= 0x2FF) ||
         (c >= 0x370 && c <= 0x37D) || (c >= 0x37F && c <= 0x1FFF) || (c >= 0x200C && c <= 0x200D) ||
         (c >= 0x2070 && c <= 0x218F) || (c >= 0x2C00 && c <= 0x2FEF) || (c >= 0x3001 && c <= 0xD7FF) ||
         (c >= 0xF900 && c <= 0xFDCF) || (c >= 0xFDF0 && c <= 0xFFFD) || (c >= 0x10000 && c <= 0xEFFFF);
}
bool IsNameStart(uint32_t c) {
  return c < 0x80 ? IsAlpha(static_cast<char>(c)) : IsWideNameStart(c);
}
// [167] PN_CHARS
bool IsNameChar(uint32_t c) {
  if (c < 0x80) return IsAlpha(static_cast<char>(c)) || IsDigit(static_cast<char>(c)) || c == '_' || c == '-';
  return c == 0xB7 || (c >= 0x300 && c <= 0x36F) || (c >= 0x203F && c <= 0x2040) || IsWideNameStart(c);
}

// \uXXXX or \UXXXXXXXX at `at` (which points at the backslash): its code and length.
std::optional<std::pair<uint32_t, size_t>> CodePointEscape(std::string_view text, size_t at) {
  if (at + 1 >= text.size() || (text[at + 1] != 'u' && text[at + 1] != 'U')) return std::nullopt;
  const size_t digits = text[at + 1] == 'u' ? 4 : 8;
  if (at + 2 + digits > text.size()) return std::nullopt;
  uint32_t code = 0;
  for (size_t i = 0; i < digits; ++i) {
    const char c = text[at + 2 + i];
    if (!IsHex(c)) return std::nullopt;
    code = code << 4 | HexValue(c);
  }
  return std::make_pair(code, digits + 2);
}

struct CodePoint {
  uint32_t code;
  size_t length;  // in the text
};

// The code point at `at`, written or escaped (section 19.2); nullopt at the end, and at a '\\' that begins no
// such escape.
std::optional<CodePoint> CodePointOrEscape(std::string_view text, size_t at) {
  if (at >= text.size()) return std::nullopt;
  const auto found = text[at] == '\\' ? CodePointEscape(text, at) : std::optional(CodePointAt(text, at));
  if (!found) return std::nullopt;
  return CodePoint{found->first, found->second};
}

std::optional<char> SimpleEscape(char c) {
  switch (c) {
    case 't':
      return '\t';
    case 'b':
      return '\b';
    case 'n':
      return '\n';
    case 'r':
      return '\r';
    case 'f':
      return '\f';
    case '"':
      return '"';
    case '\'':
      return '\'';
    case '\\':
      return '\\';
    default:
      return std::nullopt;
  }
}

}  // namespace

bool AppendUtf8(uint32_t code, std::string* out) {
  if (code == 0 || code > 0x10FFFF || (code >= 0xD800 && code <= 0xDFFF)) return false;
  const auto put = [out](uint32_t byte) { out->push_back(static_cast<char>(byte)); };
  if (code < 0x80) {
    put(code);
  } else if (code < 0x800) {
    put(0xC0 | code >> 6);
    put(0x80 | (code & 0x3F));
  } else if (code < 0x10000) {
    put(0xE0 | code >> 12);
    put(0x80 | (code >> 6 & 0x3F));
    put(0x80 | (code & 0x3F));
  } else {
    put(0xF0 | code >> 18);
    put(0x80 | (code >> 12 & 0x3F));
    put(0x80 | (code >> 6 & 0x3F));
    put(0x80 | (code & 0x3F));
  }
  return true;
}

size_t FindInvalidUtf8(std::string_view text) {
  for (size_t i = AsciiEnd(text, 0); i < text.size(); i = AsciiEnd(text, i)) {
    const uint8_t lead = static_cast<uint8_t>(text[i]);
    const size_t length = lead >= 0xC2 && lead < 0xE0   ? 2
                          : (lead & 0xF0) == 0xE0       ? 3
                          : lead >= 0xF0 && lead < 0xF5 ? 4
                                                        : 0;
    if (length == 0 || i + length > text.size()) return i;
    for (size_t k = 1; k < length; ++k) {
      if ((static_cast<uint8_t>(text[i + k]) & 0xC0) != 0x80) return i;
    }
    const uint32_t code = CodePointAt(text, i).first;
    const bool overlong = (length == 3 && code < 0x800) || (length == 4 && code < 0x10000);
    if (overlong || code > 0x10FFFF || (code >= 0xD800 && code <= 0xDFFF)) return i;
    i += length;
  }
  return std::string_view::npos;
}

// A byte order mark is not part of the text.
Lexer::Lexer(std::string_view text)
    : text_(text), at_(text.starts_with("\xEF\xBB\xBF") ? 3 : 0), line_begin_(at_) {}

void Lexer::Advance(size_t bytes) {
  for (const size_t end = at_ + bytes; at_ < end; ++at_) {
    const uint8_t c = static_cast<uint8_t>(text_[at_]);
    if (c == '\n') {
      BeginLine(at_ + 1);
    } else if ((c & 0xC0) == 0x80) {
      ++line_begin_;
    }
  }
}

void Lexer::Put(Token* out, TokenKind kind, size_t length, std::string_view text, std::string_view prefix) {
  *out = {kind, 0, SpanOf(length), text, prefix};
  Advance(length);
}

void Lexer::PutAscii(Token* out, TokenKind kind, size_t length, std::string_view text,
                     std::string_view prefix) {
  *out = {kind, 0, SpanOf(length), text, prefix};
  at_ += length;
}

void Lexer::PutMark(Token* out, size_t length) {
  const std::string_view text(text_.data() + at_, length);
  *out = {TokenKind::kPunctuation, Token::MarkOf(text), SpanOf(length), text, {}};
  at_ += length;
}

void Lexer::PutWord(Token* out, size_t length) {
  length = FirstWordLength(text_.substr(at_, length));
  const std::string_view text(text_.data() + at_, length);
  uint64_t code;
  if (at_ + sizeof(code) <= text_.size()) {  // as Keyword::CodeOf, for all letters together
    std::memcpy(&code, text.data(), sizeof(code));
    code |= 0x2020202020202020;
    if (length < sizeof(code)) code &= (uint64_t{1} << 8 * length) - 1;
  } else {
    code = Keyword::CodeOf(text);
  }
  *out = {TokenKind::kWord, code, SpanOf(length), text, {}};
  at_ += length;
}

void Lexer::Error(Token* out, size_t length, std::string message, std::string_view hint) {
  Put(out, TokenKind::kError, length, Keep(std::move(message)), hint);
}

void Lexer::SkipSpaceAndComments() {
  size_t at = at_;
  for (; at < text_.size() && Is(text_[at], kBetweenTokens); ++at) {
    if (text_[at] == '\n') {
      BeginLine(at + 1);
    } else if (text_[at] == '#') {
      const size_t end = std::min(text_.find_first_of("\n\r", at), text_.size());
      for (; at < end; ++at) line_begin_ += (static_cast<uint8_t>(text_[at]) & 0xC0) == 0x80;
      --at;
    }
  }
  at_ = at;
}

void Lexer::Next(Token* out) {
  const auto after = [this](size_t bytes) { return at_ + bytes < text_.size() ? text_[at_ + bytes] : '\0'; };
  char c = after(0);
  if (c == ' ') {  // before most tokens
    ++at_;
    c = after(0);
  }
  if (Is(c, kBetweenTokens)) {
    SkipSpaceAndComments();
    return Next(out);
  }
  if (Is(c, kLetter)) return LexWordOrName(out);
  if (Is(c, kMarkAlone)) return PutMark(out, 1);
  switch (c) {
    case '?':
    case '$':
      return LexVariable(out);
    case '<':
      return LexIriOrPunctuation(out);
    case ':':
      return LexLocalName(out, 0);
    case '\\':
      return LexWideName(out, at_);
    case '"':
    case '\'':
      return LexString(out);
    case '@':
      return LexLanguage(out);
    case '_':
      return after(1) == ':' ? LexBlankLabel(out) : LexPunctuation(out);
    case '.':
      return IsDigit(after(1)) ? LexNumber(out) : LexPunctuation(out);
    case '\0':  // never inside a text
      return PutAscii(out, TokenKind::kEnd, 0, "");
    default:
      break;
  }
  if (IsDigit(c)) return LexNumber(out);
  if (static_cast<uint8_t>(c) >= 0x80 && IsNameStart(CodePointAt(text_, at_).first))
    return LexWideName(out, at_);
  return LexPunctuation(out);
}

void Lexer::LexVariable(Token* out) {
  const size_t begin = at_ + 1, end = WordEnd(text_, begin);  // [166] VARNAME
  const char after = end < text_.size() ? text_[end] : ' ';
  if (static_cast<uint8_t>(after) >= 0x80 || after == '\\') return LexWideVariable(out);
  if (end == begin) return LexPunctuation(out);
  return PutAscii(out, TokenKind::kVariable, end - at_, {text_.data() + begin, end - begin});
}

// A variable whose name holds more than ASCII letters, digits and '_', or escapes.
void Lexer::LexWideVariable(Token* out) {
  std::string name;
  size_t end = at_ + 1;
  while (const std::optional<CodePoint> c = CodePointOrEscape(text_, end)) {
    const bool never_first =
        c->code == 0xB7 || (c->code >= 0x300 && c->code <= 0x36F) || (c->code >= 0x203F && c->code <= 0x2040);
    if (!IsNameChar(c->code) || c->code == '-' || (name.empty() && never_first)) break;
    AppendUtf8(c->code, &name);
    end += c->length;
  }
  if (name.empty()) return LexPunctuation(out);
  return Put(out, TokenKind::kVariable, end - at_, Keep(std::move(name)));
}

void Lexer::LexLanguage(Token* out) {
  size_t end = at_ + 1;
  while (end < text_.size() && IsAlpha(text_[end])) ++end;
  if (end == at_ + 1)
    return Error(out, 1, "a language tag needs letters after '@'", "write it like \"text\"@en");
  while (end + 1 < text_.size() && text_[end] == '-' &&
         (IsAlpha(text_[end + 1]) || IsDigit(text_[end + 1]))) {
    ++end;
    while (end < text_.size() && (IsAlpha(text_[end]) || IsDigit(text_[end]))) ++end;
  }
  return PutAscii(out, TokenKind::kLanguage, end - at_, text_.substr(at_ + 1, end - at_ - 1));
}

// `<…>` is an IRI if it holds only characters of an IRI, else it is the operator '<'.
void Lexer::LexIriOrPunctuation(Token* out) {
  const size_t begin = at_ + 1, end = IriEnd(text_, begin);
  if (end == text_.size() || text_[end] != '>') return LexWideIriOrPunctuation(out, end);
  return PutAscii(out, TokenKind::kIri, end + 1 - at_, {text_.data() + begin, end - begin});
}

// The same, continued at `i`, where a character other than ASCII of an IRI was found.
void Lexer::LexWideIriOrPunctuation(Token* out, size_t i) {
  bool escaped = false;
  for (; i < text_.size(); ++i) {
    const char c = text_[i];
    if (Is(c, kInIri) || static_cast<uint8_t>(c) >= 0x80) continue;
    if (c == '>') {
      const size_t length = i + 1 - at_;
      return escaped ? LexEscapedIri(out, length)
                     : Put(out, TokenKind::kIri, length, text_.substr(at_ + 1, length - 2));
    }
    if (c != '\\' || !CodePointEscape(text_, i)) break;
    escaped = true;
  }
  return LexPunctuation(out);
}

void Lexer::LexString(Token* out) {
  const char quote = text_[at_];
  const bool is_long = text_.substr(at_, 3) == std::string(3, quote);
  const size_t begin = at_ + (is_long ? 3 : 1);
  size_t i = begin;
  std::string value;                                         // up to the last escape
  size_t rest = begin;                                       // after it
  std::optional<std::pair<size_t, std::string>> bad_escape;  // where, what
  while (true) {
    if (i >= text_.size() || (!is_long && (text_[i] == '\n' || text_[i] == '\r'))) {
      return Error(out, i - at_, "this string is not closed",
                   is_long ? "end it with three quotes"
                           : "end it with the same quote on the same line, or use \"\"\"");
    }
    const char c = text_[i];
    if (c == quote && (!is_long || text_.substr(i, 3) == std::string(3, quote))) break;
    if (c != '\\') {
      ++i;
      continue;
    }
    value.append(text_.substr(rest, i - rest));
    if (const auto escape = CodePointEscape(text_, i)) {
      if (escape->first == 0) {
        value.push_back('\0');  // section 19.2: from U+0 on
      } else if (!AppendUtf8(escape->first, &value) && !bad_escape) {
        bad_escape = {i, "is not a Unicode character"};
      }
      i += escape->second;
    } else if (i + 1 < text_.size() && SimpleEscape(text_[i + 1])) {
      value.push_back(*SimpleEscape(text_[i + 1]));
      i += 2;
    } else {
      if (!bad_escape) bad_escape = {i, "is not an escape of SPARQL"};
      ++i;
    }
    rest = i;
  }
  const size_t length = i + (is_long ? 3 : 1) - at_;
  if (bad_escape) {
    return Error(
        out, length,
        "'" + std::string(text_.substr(bad_escape->first, 2)) + "…' in this string " + bad_escape->second,
        "a backslash itself is written \\\\");
  }
  if (rest == begin) return Put(out, TokenKind::kString, length, text_.substr(begin, i - begin));
  value.append(text_.substr(rest, i - rest));
  return Put(out, TokenKind::kString, length, Keep(std::move(value)));
}

void Lexer::LexNumber(Token* out) {
  size_t end = at_;
  TokenKind kind = TokenKind::kInteger;
  while (end < text_.size() && IsDigit(text_[end])) ++end;
  const auto exponent = [&](size_t at) -> size_t {  // length of [eE][+-]?[0-9]+ at `at`
    if (at >= text_.size() || (text_[at] != 'e' && text_[at] != 'E')) return 0;
    size_t i = at + 1;
    if (i < text_.size() && (text_[i] == '+' || text_[i] == '-')) ++i;
    const size_t digits = i;
    while (i < text_.size() && IsDigit(text_[i])) ++i;
    return i > digits ? i - at : 0;
  };
  if (end < text_.size() && text_[end] == '.') {
    size_t fraction = end + 1;
    while (fraction < text_.size() && IsDigit(text_[fraction])) ++fraction;
    // "1." is an integer and the end of a triple, "1.e3" a double
    if (fraction > end + 1 || exponent(fraction) > 0) {
      end = fraction;
      kind = TokenKind::kDecimal;
    }
  }
  if (const size_t length = exponent(end)) {
    end += length;
    kind = TokenKind::kDouble;
  }
  return PutAscii(out, kind, end - at_, text_.substr(at_, end - at_));
}

void Lexer::LexBlankLabel(Token* out) {
  size_t end = at_ + 2;
  size_t good = end;  // a label does not end with '.'
  while (end < text_.size()) {
    const auto [code, length] = CodePointAt(text_, end);
    const bool first = end == at_ + 2;
    const bool part =
        first ? IsNameStart(code) || code == '_' || (code < 0x80 && IsDigit(static_cast<char>(code)))
              : IsNameChar(code) || code == '.';
    if (!part) break;
    end += length;
    if (code != '.') good = end;
  }
  if (good == at_ + 2)
    return Error(out, 2, "a blank node needs a label after '_:'", "write it like _:b1, or []");
  return Put(out, TokenKind::kBlankLabel, good - at_, text_.substr(at_ + 2, good - at_ - 2));
}

// A token that begins with an ASCII letter.
void Lexer::LexWordOrName(Token* out) {
  const size_t end = WordEnd(text_, at_ + 1);
  const char after = end < text_.size() ? text_[end] : ' ';
  if (after == ' ') return PutWord(out, end - at_);
  if (after == ':') return LexLocalName(out, end - at_);
  return LexWideName(out, end);
}

// The same, or a token that begins with another name character; `end` is the end of the ASCII letters, digits
// and '_'.
void Lexer::LexWideName(Token* out, size_t end) {
  const size_t name_end = NameEnd(text_, end);
  const char after = name_end < text_.size() ? text_[name_end] : ' ';
  if (after == ':') return LexLocalName(out, name_end - at_);
  const bool goes_on = after == '.' || after == '\\' || static_cast<uint8_t>(after) >= 0x80;
  if (goes_on) {
    if (LexNameWithWidePrefix(out)) return;
  }
  if (end == text_.size() || text_[end] != '\\') {
    return end > at_ ? PutWord(out, end - at_) : Misplaced(out);
  }
  std::string word;  // a keyword with escapes
  end = at_;
  for (std::optional<CodePoint> c;
       (c = CodePointOrEscape(text_, end)) && c->code < 0x80 && Is(static_cast<char>(c->code), kInWord);) {
    word.push_back(static_cast<char>(c->code));
    end += c->length;
  }
  if (end == at_) return Error(out, 1, "'\\' is not allowed here");
  Put(out, TokenKind::kWord, end - at_, Keep(std::move(word)));
  out->code = Keyword::CodeOf(out->text);
}

// A prefixed name whose prefix holds more than ASCII letters, digits, '_' and '-'; false if there is none
// here.
bool Lexer::LexNameWithWidePrefix(Token* out) {
  if (at_ < no_prefix_before_) return false;
  std::string prefix;
  size_t end = at_;
  while (const std::optional<CodePoint> c = CodePointOrEscape(text_, end)) {
    if (c->code == ':') {
      if (!prefix.empty() && prefix.back() == '.') break;
      LexEscapedLocalName(out, end + c->length, Keep(std::move(prefix)));
      return true;
    }
    if (!(prefix.empty() ? IsNameStart(c->code) : IsNameChar(c->code) || c->code == '.')) break;
    AppendUtf8(c->code, &prefix);
    end += c->length;
  }
  no_prefix_before_ = end;  // later starts in this run of characters reach the same end
  return false;
}

void Lexer::LexLocalName(Token* out, size_t prefix_length) {
  const std::string_view prefix(text_.data() + at_, prefix_length);
  const size_t begin = at_ + prefix_length + 1;
  const size_t end = begin < text_.size() && text_[begin] != '-' ? NameEnd(text_, begin) : begin;
  const char next = end < text_.size() ? text_[end] : ' ';
  if (Is(next, kInLocalName)) return LexEscapedLocalName(out, begin, prefix);
  return PutAscii(out, TokenKind::kPrefixedName, end - at_, {text_.data() + begin, end - begin}, prefix);
}

// [169] PN_LOCAL from `begin` on
void Lexer::LexEscapedLocalName(Token* out, size_t begin, std::string_view prefix) {
  std::string local;
  size_t end = begin;
  size_t good_end = end, good_size = 0;  // the name does not end with '.'
  while (end < text_.size()) {
    const char c = text_[end];
    if (c == '%') {
      if (end + 2 >= text_.size() || !IsHex(text_[end + 1]) || !IsHex(text_[end + 2])) break;
      local.append(text_.substr(end, 3));
      end += 3;
    } else if (const std::optional<CodePoint> point = CodePointOrEscape(text_, end)) {
      const uint32_t code = point->code;
      const bool anywhere = IsNameStart(code) || code == ':' || code == '_' ||
                            (code < 0x80 && IsDigit(static_cast<char>(code)));
      if (!anywhere && (local.empty() || !(IsNameChar(code) || code == '.'))) break;
      AppendUtf8(code, &local);
      end += point->length;
      if (code == '.') continue;
    } else if (end + 1 < text_.size() &&
               std::string_view("_~.-!$&'()*+,;=/?#@%").find(text_[end + 1]) != std::string_view::npos) {
      local.push_back(text_[end + 1]);  // [173] PN_LOCAL_ESC
      end += 2;
    } else {
      break;
    }
    good_end = end;
    good_size = local.size();
  }
  local.resize(good_size);
  return Put(out, TokenKind::kPrefixedName, good_end - at_, Keep(std::move(local)), prefix);
}

void Lexer::LexEscapedIri(Token* out, size_t length) {
  std::string iri;
  for (size_t i = at_ + 1; i + 1 < at_ + length;) {
    if (text_[i] != '\\') {
      iri.push_back(text_[i++]);
      continue;
    }
    const auto escape = CodePointEscape(text_, i);  // always an escape: checked before
    const bool allowed = escape->first >= 0x80 || Is(static_cast<char>(escape->first), kInIri);
    if (!allowed || !AppendUtf8(escape->first, &iri)) {
      return Error(out, length, "an escape in this IRI is not a character that an IRI may hold");
    }
    i += escape->second;
  }
  return Put(out, TokenKind::kIri, length, Keep(std::move(iri)));
}

void Lexer::LexPunctuation(Token* out) {
  const char c = text_[at_], next = at_ + 1 < text_.size() ? text_[at_ + 1] : '\0';
  const bool doubled = c == next && (c == '^' || c == '&' || c == '|');
  if (doubled || (next == '=' && (c == '!' || c == '<' || c == '>'))) {
    return PutMark(out, 2);
  }
  return Is(c, kPunctuationMark) ? PutMark(out, 1) : Misplaced(out);
}

// An error: no token begins with this character.
void Lexer::Misplaced(Token* out) {
  const size_t length = CodePointAt(text_, at_).second;
  return Error(out, length, "'" + std::string(text_.substr(at_, length)) + "' is not allowed here");
}

}  // namespace docent::sparql
