// An RDF term as people write it in the text of a CAWL or RSEL element. Any thread.
//
//   prefix:local   <https://example.org/x>   "text"   "text"@en   "1.5"^^xsd:decimal   'text'   7   0.5   1e3   true
#ifndef DOCENT_WORKFLOW_XML_TERM_TEXT_H_
#define DOCENT_WORKFLOW_XML_TERM_TEXT_H_

#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "graph/rdf/term.h"

namespace docent::xml {

// Prefix → namespace IRI, as XML declarations in scope give it ("" is the default namespace and not used here).
using Prefixes = std::map<std::string, std::string>;

struct TermError {
  size_t offset = 0;  // in the text
  size_t length = 0;
  std::string message;
  std::string hint;
  std::string wrong = {}, right = {};  // a word and the one that was probably meant; empty: not known
};

// The term that the whole of `text` (trimmed by the caller) writes; nullopt and `error` filled otherwise. Prefixes
// that `prefixes` lacks are looked up among kWellKnownPrefixes. Numbers and booleans get the datatype of their form
// (Turtle, section 2.5.2 and 2.5.3).
std::optional<Term> ParseTerm(std::string_view text, const Prefixes& prefixes, TermError* error);

// The IRI of `prefix`, from `prefixes` or else the well-known ones.
std::optional<std::string> FindPrefix(const Prefixes& prefixes, std::string_view prefix);

// True if `name` may name a variable or a message's part: ASCII letters, digits and "_", not beginning with a digit
// or "_".
bool IsVariableName(std::string_view name);

}  // namespace docent::xml

#endif  // DOCENT_WORKFLOW_XML_TERM_TEXT_H_
