// Which rules with negation come after which, where the axioms decide.
//
// Rules of OWL such as ?s owl:sameAs ?t . ?s ?p ?o → ?t ?p ?o may make anything of anything, so that every rule with
// negation would negate what may follow from itself. What they do make depends on the axioms that are there. So the
// conclusions of each such rule (RuleProgram::ordered) are followed through the rules and through the instances of the
// SchemaIndex, as patterns: `?r ex:free true` leads by `ex:free rdfs:subPropertyOf ex:idle` to `?r ex:idle true`. A rule
// that negates what another leads to comes after it; one that negates what it leads to itself has no meaning. A fact comes
// with the last rule that may lead to it: then what it is made from is never later than itself.
//
// Patterns forget their subjects, and objects too where there are very many: an order may be refused that the facts would
// allow, never the other way about. Rules with negation may make no axioms, since these would change the order while it is
// followed.
// Private to this folder. Writer thread only.
#ifndef DOCENT_REASONER_RULES_NEGATION_ORDER_H_
#define DOCENT_REASONER_RULES_NEGATION_ORDER_H_

#include "absl/status/statusor.h"
#include "reasoner/rules/rule_program.h"
#include "reasoner/rules/schema_index.h"

namespace docent {

// FAILED_PRECONDITION, with the way round, the axioms on it among them: there is no order. `dictionary`: of both.
absl::StatusOr<NegationOrder> OrderNegation(const RuleProgram& program, const SchemaIndex& schema, const Dictionary& dictionary);

}  // namespace docent

#endif  // DOCENT_REASONER_RULES_NEGATION_ORDER_H_
