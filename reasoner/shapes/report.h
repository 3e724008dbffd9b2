// Validation reports for people (text with the lines of the sources) and for machines (sh:ValidationReport,
// SHACL section 3.6). Pure functions; any thread.
#ifndef DOCENT_REASONER_SHAPES_REPORT_H_
#define DOCENT_REASONER_SHAPES_REPORT_H_

#include <optional>
#include <string>
#include <vector>

#include "graph/rdf/dictionary.h"
#include "graph/rdf/term.h"
#include "reasoner/shapes/source_map.h"
#include "reasoner/shapes/validator.h"

namespace docent::shapes {

// nullopt: the result names no value.
std::optional<Term> ValueOf(const ValidationResult& result, const Dictionary& dictionary);

// In SPARQL syntax: docent:at/^docent:of*.
std::string PathText(const Path& path, const Dictionary& dictionary);

// One result as text, in the form that reports show.
struct ResultText {
  std::string file;  // of the data; empty if it is not known
  int line = 0, column = 0;
  std::string shape_file;
  int shape_line = 0, shape_column = 0;
  std::string severity;                   // "violation", "warning", "info", or the IRI
  std::string focus, path, value, shape;  // for people; path and value may be empty
  std::string component;                  // "sh:minCount", or the IRI of a component of the shapes graph
  std::string message;                    // English if there is one
  std::vector<std::string> details;       // reasons in nested shapes, indented by depth
};
// `data` and `shapes` may be null.
ResultText Describe(const ValidationResult& result, const Dictionary& dictionary, const SourceMap* data,
                    const SourceMap* shapes);
// "hall.ttl:12:5: violation: …" and the lines below it.
std::string Render(const ResultText& result);
// "conforms (4 nodes checked)" or "3 violations, 1 warning (4 nodes checked)".
std::string Summary(const ValidationReport& report, const Dictionary& dictionary);

// The report as triples without graph; its blank nodes are labelled `label_prefix` and a number, those of the
// data keep their labels.
std::vector<TermQuad> ToRdf(const ValidationReport& report, const Dictionary& dictionary,
                            const std::string& label_prefix = "report");

}  // namespace docent::shapes

#endif  // DOCENT_REASONER_SHAPES_REPORT_H_
