// Conversion of SHACL rules in RDF (W3C SHACL Advanced Features, section 8: sh:SPARQLRule) to a `.rules`
// document.
//
//   ex:RobotShape sh:targetClass ex:Robot ; sh:rule [ a sh:SPARQLRule ; sh:prefixes ex: ;
//     sh:construct "CONSTRUCT { $this ex:state ex:Free } WHERE { $this ex:task ex:None }" ] .
//   →  RULE { ?this ex:state ex:Free } WHERE { ?this a ex:Robot . ?this ex:task ex:None }
//
// A rule is in the line of its sh:construct, so that errors and proofs (`rule 2 (line 5)`) name the line of
// the RDF document. Mistakes are reported at their place in that document. Pure; any thread.
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

// A parsed sh:construct.
struct ImportedConstruct {
  sparql::Query query;
  std::string text;     // of the literal
  size_t prologue = 0;  // bytes of the declarations of sh:prefixes, which precede it in the parsed text
  SourceSpan literal;   // its place in the document
  size_t quote = 0;     // bytes of its quotation mark; 0: its characters are escaped or XML
  // A place of the query in the document, as exact as the literal's form allows.
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
// sh:targetObjectsOf, sh:target with a sh:select, and a shape that is a class itself; a class stands for its instances in the graph,
// which a warning mentions. Deactivated shapes and rules are left out; sh:order is ignored, as rules run to a
// fixpoint. Errors: sh:condition and other kinds of rules (sh:TripleRule), other kinds of sh:target, a query that
// is no CONSTRUCT, its mistakes, and constructs that a rule must not have (rule_parser.h). `source` is the document's text, `file`
// names it in diagnostics. `functions`: as of ParseRules.
ImportedRules ImportShaclRules(const LocatedRdf& shapes, std::string_view source, std::string_view file,
                               const sparql::FunctionRegistry* functions = nullptr);

}  // namespace docent::rules

#endif  // DOCENT_REASONER_RULES_SHACL_RULES_IMPORT_H_
