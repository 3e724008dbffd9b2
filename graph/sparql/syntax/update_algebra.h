// A SPARQL Update request (SPARQL 1.1 Update, section 3), made by the parser: a sequence of operations, each
// of which sees the effects of the earlier ones. Independent of the store: terms are text, variables are
// names. Values.
#ifndef DOCENT_GRAPH_SPARQL_SYNTAX_UPDATE_ALGEBRA_H_
#define DOCENT_GRAPH_SPARQL_SYNTAX_UPDATE_ALGEBRA_H_

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "graph/sparql/syntax/algebra.h"

namespace docent::sparql {

// One triple of DATA or of a template, with the GRAPH around it.
struct QuadTemplate {
  TriplePattern triple;
  std::shared_ptr<const PatternTerm> graph;  // null: the default graph, or that of WITH
};
using QuadTemplates = std::deque<QuadTemplate>;  // as many as an update has: grows without a copy

// DEFAULT, GRAPH <iri>, NAMED, ALL.
struct GraphTarget {
  enum class Kind : uint8_t { kDefault, kGraph, kNamed, kAll };
  Kind kind = Kind::kDefault;
  Term graph;  // kGraph
};

struct UpdateOperation {
  enum class Kind : uint8_t {
    kInsertData,  // INSERT DATA { quads }                      insert
    kDeleteData,  // DELETE DATA { quads }                      remove
    kModify,      // WITH <g> DELETE { … } INSERT { … } USING <u> USING NAMED <n> WHERE { … }
                  //                                            with, remove, insert, from, from_named, where
                  // DELETE WHERE { quads } is of this kind, too: remove, where
    kLoad,        // LOAD SILENT <document> INTO GRAPH <g>      silent, document, target
    kClear,       // CLEAR SILENT GRAPH <g>                     silent, target
    kDrop,        // DROP SILENT GRAPH <g>                      silent, target
    kCreate,      // CREATE SILENT GRAPH <g>                    silent, target
    kCopy,        // COPY SILENT <a> TO <b>                     silent, source, target
    kMove,        // MOVE SILENT <a> TO <b>                     silent, source, target
    kAdd,         // ADD SILENT <a> TO <b>                      silent, source, target
  };
  Kind kind = Kind::kInsertData;
  SourceSpan span;
  bool silent = false;
  QuadTemplates remove;  // no blank nodes
  QuadTemplates insert;  // blank nodes stay terms: new ones for each solution (kModify) or request
  std::optional<Term> with;
  std::vector<Term> from;        // USING <iri>
  std::vector<Term> from_named;  // USING NAMED <iri>
  AlgebraPtr where;              // kModify
  Term document;
  GraphTarget source, target;
};

// A whole request. May be empty.
struct Update {
  std::string base_iri;
  std::vector<std::pair<std::string, std::string>> prefixes;  // declared in the text, in order
  std::vector<UpdateOperation> operations;
};

}  // namespace docent::sparql

#endif  // DOCENT_GRAPH_SPARQL_SYNTAX_UPDATE_ALGEBRA_H_
