// Diagnostics: mistakes in a text that a person wrote (Turtle, SPARQL, rules, CAWL, RSEL), with their places.
//
// A parser collects every Diagnostic it finds and does not stop at the first; `Render` prints them all with
// the source line and a caret. Values; any thread.
#ifndef DOCENT_GRAPH_BASE_DIAGNOSTIC_H_
#define DOCENT_GRAPH_BASE_DIAGNOSTIC_H_

#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"

namespace docent {

// A place in a text. Lines and columns count from 1; a column counts Unicode code points. `offset` and
// `length` are bytes in the text; an editor uses them to mark the text.
struct SourceSpan {
  int line = 0;  // 0: no place known
  int column = 0;
  size_t offset = 0;
  size_t length = 0;
};

// Replacement of the bytes [offset, offset+length) of a text.
struct TextEdit {
  size_t offset = 0;
  size_t length = 0;
  std::string replacement;

  friend bool operator==(const TextEdit&, const TextEdit&) = default;
};

struct Diagnostic {
  enum class Severity { kError, kWarning };
  std::string file;  // as the user named it; may be empty (a query sent over the network)
  SourceSpan span;
  std::string message;  // what is wrong, with the value
  std::string hint;     // what to do next; may be empty
  Severity severity = Severity::kError;
  std::string rule =
      {};  // name of the kind of finding, which does not change ("unreachable-node"); may be empty
  std::vector<TextEdit> fix =
      {};  // edits of the text that remedy it, to be made together; empty: no remedy is evident
};

using Diagnostics = std::vector<Diagnostic>;

bool HasErrors(const Diagnostics& diagnostics);

// "file:line:column: error: message", the line, a caret, and the hint, for each diagnostic.
// `source` is the text that the spans point into; empty leaves line and caret out.
std::string Render(const Diagnostics& diagnostics, std::string_view source);

// `source` with the fixes of the diagnostics, in their order. One that overlaps a fix before it, or that reaches outside of
// `source`, is left out; an edit that is made already is not made twice. `applied` (may be null): how many were made.
std::string ApplyFixes(std::string_view source, const Diagnostics& diagnostics, size_t* applied);

// INVALID_ARGUMENT carrying the rendered text; OK when there is no error among them.
absl::Status ToStatus(const Diagnostics& diagnostics, std::string_view source);

// The span of the byte range [offset, offset+length) of `source`.
SourceSpan SpanAt(std::string_view source, size_t offset, size_t length = 0);

// The candidate nearest to `word` by edit distance, or empty when none is near (distance over a third of its
// length). For hints: "did you mean …?".
std::string Nearest(std::string_view word, const std::vector<std::string>& candidates);

}  // namespace docent

#endif  // DOCENT_GRAPH_BASE_DIAGNOSTIC_H_
