// Lexer of SPARQL (SPARQL 1.1 section 19.8, productions [139] to [173]): one token at a time. It decodes
// escapes and counts places; it does not resolve names. One thread.
#ifndef DOCENT_GRAPH_SPARQL_SYNTAX_LEXER_H_
#define DOCENT_GRAPH_SPARQL_SYNTAX_LEXER_H_

#include <cstdint>
#include <list>
#include <string>
#include <string_view>

#include "graph/base/diagnostic.h"
#include "graph/sparql/values/text.h"

namespace docent::sparql {

enum class TokenKind {
  kEnd,
  kIri,           // <…>             text: the inner text, escapes decoded
  kPrefixedName,  // prefix:local    prefix, text: the local name, escapes decoded
  kBlankLabel,    // _:label         text: label
  kVariable,      // ?name $name     text: name
  kString,        // "…" '''…'''     text: value
  kLanguage,      // @en-GB          text: tag as written
  kInteger,       // 12              text as written; a sign is its own token
  kDecimal,       // 1.2
  kDouble,        // 1.2e3
  kWord,          // SELECT a true   text as written
  kPunctuation,   // { && ^^ …       text
  kError,         // text: what is wrong; prefix: hint
};

// A word of the grammar, in any letter case.
class Keyword {
 public:
  // The first eight letters, digits and '_' in lower case as a number. Shorter words with the same number are
  // equal.
  static constexpr uint64_t CodeOf(std::string_view word) {
    uint64_t code = 0;
    for (size_t i = 0; i < word.size() && i < sizeof(code); ++i) {
      code |= static_cast<uint64_t>(static_cast<uint8_t>(word[i]) | 0x20) << 8 * i;
    }
    return code;
  }

  template <size_t size>
  consteval Keyword(const char (&text)[size]) : Keyword(std::string_view(text, size - 1)) {}
  constexpr explicit Keyword(std::string_view text) : code(CodeOf(text)), text(text) {}

  uint64_t code;
  std::string_view text;
};

// Valid as long as the lexer that made it: its texts are views of the query's text, or, with escapes, of the
// lexer.
struct Token {
  TokenKind kind = TokenKind::kEnd;
  uint64_t code =
      0;  // kPunctuation: MarkOf its text; kWord: Keyword::CodeOf it; the codes of the two never coincide
  SourceSpan span;
  std::string_view text;
  std::string_view prefix;

  // Punctuation of one or two characters as a number.
  static constexpr uint64_t MarkOf(std::string_view text) {
    return static_cast<uint64_t>(static_cast<uint8_t>(text[0]) |
                                 (text.size() > 1 ? static_cast<uint8_t>(text[1]) << 8 : 0));
  }
  bool Is(std::string_view punctuation) const { return code == MarkOf(punctuation); }
  // The predicate "a", a case-sensitive keyword.
  bool IsA() const { return code == 'a' && text[0] == 'a'; }
  bool IsWord(const Keyword& keyword) const {
    return code == keyword.code &&
           (keyword.text.size() < sizeof(code) || EqualsIgnoreCase(text, keyword.text));
  }
};

class Lexer {
 public:
  // `text` must outlive it and be valid UTF-8 (see FindInvalidUtf8).
  explicit Lexer(std::string_view text);

  // Writes the next token; kEnd for ever after the last.
  void Next(Token* out);
  Token Next() {
    Token token;
    Next(&token);
    return token;
  }
  // Memory of texts of tokens, which lasts as long as the lexer.
  size_t kept_bytes() const { return kept_bytes_; }

 private:
  void SkipSpaceAndComments();
  void Advance(size_t bytes);
  void BeginLine(size_t at) {
    ++line_;
    line_begin_ = at;
  }
  SourceSpan SpanOf(size_t length) const {
    return {line_, static_cast<int>(at_ - line_begin_) + 1, at_, length};
  }
  // Each function here and below writes the token of that many bytes that begins here, and moves past it.
  void Put(Token* out, TokenKind kind, size_t length, std::string_view text, std::string_view prefix = {});
  // The same for ASCII text without a line end.
  void PutAscii(Token* out, TokenKind kind, size_t length, std::string_view text,
                std::string_view prefix = {});
  void PutMark(Token* out, size_t length);  // punctuation
  void PutWord(Token* out, size_t length);  // without escapes
  void Error(Token* out, size_t length, std::string message, std::string_view hint = {});
  // Stores the text in the lexer.
  std::string_view Keep(std::string text) {
    kept_bytes_ += kBytesOfKept + text.size();
    return kept_.emplace_back(std::move(text));
  }
  void LexString(Token* out);
  void LexNumber(Token* out);
  void LexWordOrName(Token* out);
  void LexWideName(Token* out, size_t end);
  void LexVariable(Token* out);
  void LexWideVariable(Token* out);
  void LexLanguage(Token* out);
  void LexIriOrPunctuation(Token* out);
  void LexWideIriOrPunctuation(Token* out, size_t i);
  bool LexNameWithWidePrefix(Token* out);
  void LexLocalName(Token* out, size_t prefix_length);
  void LexBlankLabel(Token* out);
  void LexEscapedLocalName(Token* out, size_t begin, std::string_view prefix);
  void LexPunctuation(Token* out);
  void Misplaced(Token* out);
  void LexEscapedIri(Token* out, size_t length);

  std::string_view text_;
  static constexpr size_t kBytesOfKept = sizeof(std::string) + 48;
  std::list<std::string> kept_;  // texts of tokens with escapes
  size_t kept_bytes_ = 0;
  size_t at_ = 0;
  size_t no_prefix_before_ = 0;  // no prefix with other than ASCII letters begins between at_ and there
  int line_ = 1;
  size_t line_begin_;  // begin of the line, plus one for each byte since that begins no character
};

// Offset of the first byte that is not UTF-8 or is U+0000; npos if there is none.
size_t FindInvalidUtf8(std::string_view text);
// `code` as UTF-8 appended to *out; false if it is not a Unicode scalar value.
bool AppendUtf8(uint32_t code, std::string* out);

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_SYNTAX_LEXER_H_
