// Reads expected query results: SPARQL XML and JSON results, and result sets as RDF.
#ifndef DOCENT_TESTS_CONFORMANCE_SPARQL_RESULT_FILES_H_
#define DOCENT_TESTS_CONFORMANCE_SPARQL_RESULT_FILES_H_

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "graph/rdf/term.h"

namespace docent {

// The answer to a query: a boolean, or solutions (in order if `ordered`), or a graph.
struct Answer {
  std::optional<bool> boolean;
  std::vector<std::string> variables;
  std::vector<std::map<std::string, Term>> rows;
  bool ordered = false;  // the order of rows is part of the answer
  std::optional<std::vector<TermQuad>> graph;
};

Answer ReadXmlResult(const std::string& text);
Answer ReadJsonResult(const std::string& text);
Answer ReadTsvResult(const std::string& text);
// A result set in the DAWG vocabulary, or else a graph.
Answer ReadRdfResult(const std::vector<TermQuad>& quads);
// Equal up to blank node labels and the lexical forms of numbers. `lax`: the number of equal solutions is
// ignored.
bool SameAnswer(const Answer& a, const Answer& b, bool lax);
std::string ToText(const Answer& answer);

}  // namespace docent

#endif  // DOCENT_TESTS_CONFORMANCE_SPARQL_RESULT_FILES_H_
