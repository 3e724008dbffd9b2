// The rule language: `.rules` documents (text form of the W3C SHACL 1.2 Rules draft, built on SPARQL's
// productions).
//
//   PREFIX ex: <http://example.org/>
//   DATA { ex:nearBy ex:inverse ex:nearBy . }
//   RULE { ?a ex:nearBy ?b } WHERE { ?b ex:nearBy ?a }
//   RULE { ?r ex:state ex:Free } WHERE { ?r a ex:Robot . FILTER NOT EXISTS { ?r ex:task ?t } }
//
//   rules := ( prologue | data | rule )*
//   data  := DATA '{' triples without variables '}'
//   rule  := RULE '{' triples '}' WHERE group-graph-pattern
//
// A body may have triple patterns, FILTER (with EXISTS and NOT EXISTS), BIND, UNION, VALUES and MINUS. Pure;
// any thread.
#ifndef DOCENT_REASONER_RULES_RULE_PARSER_H_
#define DOCENT_REASONER_RULES_RULE_PARSER_H_

#include <string>
#include <string_view>
#include <vector>

#include "kb_server/base/diagnostic.h"
#include "kb_server/base/limits.h"
#include "kb_server/sparql/algebra.h"

namespace docent {

// RULE { head } WHERE { body }. DATA is a rule with an empty body.
struct Rule {
  std::vector<sparql::TriplePattern> head;
  sparql::Query body;  // form kAsk
  SourceSpan span;     // of the word RULE
};

struct ParsedRules {
  std::vector<Rule> rules;
  Diagnostics diagnostics;
  bool ok() const { return !HasErrors(diagnostics); }
};

// Reads and checks each rule by itself: syntax; every head variable bound by the body (safety); what a FILTER
// or BIND uses is bound; no blank node or impossible triple in a head; nothing in the body that cannot be
// kept up to date incrementally (OPTIONAL, GRAPH, recursive paths, sub-SELECT, aggregates), no NOW() or
// RAND(). All errors, not the first. `file` names the text in diagnostics. The well-known prefixes need no
// declaration.
ParsedRules ParseRules(std::string_view text, std::string_view file, const Limits& limits = {});

}  // namespace docent

#endif  // DOCENT_REASONER_RULES_RULE_PARSER_H_
