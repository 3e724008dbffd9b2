// Scanner of the terminals of Turtle, TriG, N-Triples and N-Quads (RDF 1.1 Turtle section 6.5, N-Triples
// section 7). Included only by .cc files. One thread.
//
// Each reading function starts at its terminal's first character. It moves past the terminal and returns
// true; or it stores place, message and hint in failure() and returns false.
#ifndef DOCENT_GRAPH_RDF_TURTLE_SCANNER_H_
#define DOCENT_GRAPH_RDF_TURTLE_SCANNER_H_

#include <string>
#include <string_view>

namespace docent {

// Turtle [164s] PN_CHARS_U and [166s] PN_CHARS.
bool IsNameStart(char32_t c);
bool IsNameChar(char32_t c);

class TurtleScanner {
 public:
  struct Failure {
    size_t offset = 0;
    size_t length = 0;
    std::string message;
    std::string hint;
  };

  // `text` must be well-formed UTF-8 and outlive the scanner. `line_based`: N-Triples and N-Quads, where a
  // statement is a line. `term_bytes`: the longest term.
  TurtleScanner(std::string_view text, bool line_based, size_t term_bytes)
      : text_(text), line_based_(line_based), term_bytes_(term_bytes) {}

  size_t position() const { return position_; }
  bool AtEnd() const { return position_ >= text_.size(); }
  // The character `ahead` bytes further, 0 past the end.
  char Peek(size_t ahead = 0) const {
    return position_ + ahead < text_.size() ? text_[position_ + ahead] : '\0';
  }
  // White space and comments within a statement (a line-based one holds neither ends of lines nor comments).
  void SkipSpace();
  // White space after a string, if a language tag or a datatype follows: it may stand between any two tokens.
  void SkipSpaceWithinLiteral();
  // White space, ends of lines and comments between statements.
  void SkipLines();
  // Moves past `c` if it is the next character.
  bool Take(char c);
  // Moves past `word` if it is next and no name continues after it. `any_case`: case is ignored.
  bool TakeKeyword(std::string_view word, bool any_case);
  // As TakeKeyword, but a colon may follow ("@prefix:<…>." declares the empty prefix).
  bool TakeDirective(std::string_view word);
  // Moves to where another statement may begin after a mistake: past the next "." before white space, or past
  // the line.
  void SkipToNextStatement();
  void SkipAll() { position_ = text_.size(); }

  // <…> with its escapes decoded, not resolved.
  bool ReadIri(std::string* iri);
  // prefix:local with its escapes decoded. `prefix` is a part of the text.
  bool ReadPrefixedName(std::string_view* prefix, std::string* local);
  // prefix: of a declaration.
  bool ReadPrefix(std::string_view* prefix);
  // _:label, without the "_:".
  bool ReadBlankLabel(std::string_view* label);
  // "…", '…', """…""" or '''…''' (line-based: "…" only), decoded.
  bool ReadString(std::string* value);
  // @tag, without the "@".
  bool ReadLanguage(std::string_view* tag);
  // A number and the IRI of its datatype.
  bool ReadNumber(std::string_view* lexical, std::string_view* datatype);
  // True if a number begins here.
  bool AtNumber() const;

  // Sets failure() and returns false: `return Fail(…)`. `name_found`: the message ends with "…, found X".
  bool Fail(std::string message, std::string hint = "", bool name_found = false);
  bool FailAt(size_t offset, size_t length, std::string message, std::string hint = "");
  const Failure& failure() const { return failure_; }

 private:
  std::string Found() const;
  bool ReadUnicodeEscape(char32_t* c);
  bool ReadStringEscape(std::string* value);
  bool CheckLength(size_t start, size_t length);

  std::string_view text_;
  bool line_based_;
  size_t term_bytes_;
  size_t position_ = 0;
  Failure failure_;
};

}  // namespace docent

#endif  // DOCENT_GRAPH_RDF_TURTLE_SCANNER_H_
