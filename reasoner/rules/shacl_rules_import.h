// SHACL rules in RDF (W3C SHACL Advanced Features, section 8: sh:SPARQLRule) as a `.rules` document.
//
//   ex:RobotShape sh:targetClass ex:Robot ; sh:rule [ a sh:SPARQLRule ; sh:prefixes ex: ;
//     sh:construct "CONSTRUCT { $this ex:state ex:Free } WHERE { $this ex:task ex:None }" ] .
//   →  RULE { ?this ex:state ex:Free } WHERE { ?this a ex:Robot . ?this ex:task ex:None }
//
// Pure; any thread.
#ifndef DOCENT_REASONER_RULES_SHACL_RULES_IMPORT_H_
#define DOCENT_REASONER_RULES_SHACL_RULES_IMPORT_H_

#include <string>
#include <string_view>
#include <vector>

#include "kb_server/base/diagnostic.h"
#include "kb_server/rdf/term.h"

namespace docent {

struct ImportedRules {
  std::string text;  // of a .rules document; usable only if ok()
  size_t rules = 0;
  Diagnostics diagnostics;
  bool ok() const { return !HasErrors(diagnostics); }
};

// The rules of all shapes of `shapes`. Targets: sh:targetClass, sh:targetNode, sh:targetSubjectsOf,
// sh:targetObjectsOf, and a shape that is a class itself; a class means its instances
// as the graph has them, which a warning says. Deactivated shapes and rules are left out; sh:order
// is not needed, as rules go to a fixpoint. Errors: sh:condition and other kinds of rules (sh:TripleRule), a
// query that is no CONSTRUCT, its mistakes. `file` names the document in diagnostics.
ImportedRules ImportShaclRules(const std::vector<TermQuad>& shapes, std::string_view file);

}  // namespace docent

#endif  // DOCENT_REASONER_RULES_SHACL_RULES_IMPORT_H_
