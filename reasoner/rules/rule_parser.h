// Parser of the rule language: `.rules` documents (text form of the W3C SHACL 1.2 Rules draft, built on
// SPARQL's productions).
//
//   PREFIX ex: <http://example.org/>
//   DATA { ex:nearBy ex:inverse ex:nearBy . }
//   RULE { ?a ex:nearBy ?b } WHERE { ?b ex:nearBy ?a }
//   RULE { ?r ex:state ex:Free } WHERE { ?r a ex:Robot . FILTER NOT EXISTS { ?r ex:task ?t } }
//
//   rules := ( prologue | data | rule )*
//   data  := DATA '{' triples without variables '}'
//   rule  := RULE iri? '{' triples '}' WHERE group-graph-pattern
//          | IF group-graph-pattern THEN '{' triples '}'
//
// Also from the draft: RULE with a name (RULE ex:name { … } WHERE { … }), IF { body } THEN { head }, and in a
// body NOT { … } and SET(?x := expression). A rule with an empty head is a *check*: each of its solutions is
// reported as an inconsistency (inconsistency.h).
//
// A body may have triple patterns, FILTER (with EXISTS and NOT EXISTS), BIND, UNION, VALUES, MINUS, and
// sub-SELECTs with COUNT, SUM, MIN and MAX. Pure; any thread.
#ifndef DOCENT_REASONER_RULES_RULE_PARSER_H_
#define DOCENT_REASONER_RULES_RULE_PARSER_H_

#include <string>
#include <string_view>
#include <vector>

#include "graph/base/diagnostic.h"
#include "graph/base/limits.h"
#include "graph/sparql/syntax/algebra.h"
#include "reasoner/rules/rule_text_origin.h"

namespace docent::sparql {
class FunctionRegistry;
}

namespace docent::rules {

// RULE { head } WHERE { body }. DATA is a rule with an empty body.
struct Rule {
  std::string name;  // its IRI; empty: none
  std::vector<sparql::TriplePattern> head;
  sparql::Query body;  // form kAsk
  SourceSpan span;     // of the word RULE
  // Head variables whose values the body computes and that may grow without end if the rule feeds itself
  // (arithmetic, CONCAT and the like, without a FILTER in the body that compares numbers or lengths), and the
  // place of the computation.
  std::vector<std::string> growing;
  SourceSpan growing_span;
};

struct ParsedRules {
  std::vector<Rule> rules;
  Diagnostics diagnostics;
  bool ok() const { return !HasErrors(diagnostics); }
};

// The last part of its IRI ("prp-dom"); empty without an IRI.
std::string ShortName(const Rule& rule);
// The name of a rule in errors, proofs and reports: "owl2rl prp-dom (line 40)", or without an IRI
// "guide.rules rule 3 (line 12)". `number`: its place in the document `set`, from 1.
std::string RuleLabel(std::string_view set, const Rule& rule, int number);

// Parses and checks each rule on its own: syntax; the body binds every head variable (safety); variables in a
// FILTER or BIND are bound; no blank node or impossible triple in a head; no construct in the body that
// cannot be maintained incrementally (OPTIONAL, GRAPH, recursive paths, sub-SELECTs that do not aggregate),
// no NOW() or RAND(), no reports of checks (new texts only). Reports all errors, not only the first. `file` names the text in diagnostics. The
// well-known prefixes need no declaration. `functions`: the functions that calls may use (parser.h). Constant
// regular expressions that cannot be evaluated are errors only in new texts.
ParsedRules ParseRules(std::string_view text, std::string_view file, const Limits& limits = {},
                       const sparql::FunctionRegistry* functions = nullptr,
                       RuleTextOrigin origin = RuleTextOrigin::kNew);

}  // namespace docent::rules

#endif  // DOCENT_REASONER_RULES_RULE_PARSER_H_
