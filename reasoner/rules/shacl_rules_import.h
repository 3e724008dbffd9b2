// SHACL rules in RDF (W3C SHACL Advanced Features, section 8: sh:SPARQLRule) as a `.rules` document.
//
//   ex:RobotShape sh:targetClass ex:Robot ; sh:rule [ a sh:SPARQLRule ; sh:prefixes ex: ;
//     sh:construct "CONSTRUCT { $this ex:state ex:Free } WHERE { $this ex:task ex:None }" ] .
//   →  RULE { ?this ex:state ex:Free } WHERE { ?this a ex:Robot . ?this ex:task ex:None }
//
// A rule stands in the line of its sh:construct, so that errors and proofs (`rule 2 (line 5)`) name the line of the RDF
// document; what is wrong with it is told where the document has it. Pure; any thread.
#ifndef DOCENT_REASONER_RULES_SHACL_RULES_IMPORT_H_
#define DOCENT_REASONER_RULES_SHACL_RULES_IMPORT_H_

#include <string>
#include <string_view>
#include <vector>

#include "graph/base/diagnostic.h"
#include "graph/rdf/formats/located_parser.h"
#include "graph/sparql/syntax/algebra.h"

namespace docent::sparql {
class FunctionRegistry;
}

namespace docent::rules {

// A sh:construct as it was read.
struct ImportedConstruct {
  sparql::Query query;
  std::string text;     // of the literal
  size_t prologue = 0;  // bytes of the declarations of sh:prefixes, which stand before it in what was parsed
  SourceSpan literal;   // its place in the document
  size_t quote = 0;     // bytes of its quotation mark; 0: its characters are written otherwise (escapes, XML)
  // Where the document has a place of the query, as exactly as the way it is written allows.
  SourceSpan InDocument(const SourceSpan& in_query) const;
};

struct ImportedRules {
  std::string text;  // of a .rules document; usable only if ok()
  size_t rules = 0;
  std::vector<ImportedConstruct> constructs;
  Diagnostics diagnostics;
  bool ok() const { return !HasErrors(diagnostics); }
};

// The rules of all shapes of `shapes`. Targets: sh:targetClass, sh:targetNode, sh:targetSubjectsOf,
// sh:targetObjectsOf, and a shape that is a class itself; a class means its instances
// as the graph has them, which a warning says. Deactivated shapes and rules are left out; sh:order
// is not needed, as rules go to a fixpoint. Errors: sh:condition and other kinds of rules (sh:TripleRule), a
// query that is no CONSTRUCT, its mistakes, and what a rule may not have (rule_parser.h). `source` is the document's text,
// `file` names it in diagnostics. `functions`: as of ParseRules.
ImportedRules ImportShaclRules(const LocatedRdf& shapes, std::string_view source, std::string_view file,
                               const sparql::FunctionRegistry* functions = nullptr);

}  // namespace docent::rules

#endif  // DOCENT_REASONER_RULES_SHACL_RULES_IMPORT_H_
