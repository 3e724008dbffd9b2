// Order of the rules with negation, where the axioms decide it.
//
// Rules of OWL such as ?s owl:sameAs ?t . ?s ?p ?o → ?t ?p ?o may make anything of anything, so that every rule with
// negation would negate what may follow from itself. What they do make depends on the axioms that are there. So the
// conclusions of each such rule (RuleProgram::ordered) are followed through the rules and through the instances of the
// SchemaIndex, as patterns: `?r ex:free true` leads by `ex:free rdfs:subPropertyOf ex:idle` to `?r ex:idle true`. A rule
// that negates what another leads to comes after it; one that negates what it leads to itself has no meaning. A fact comes
// with the last rule that may lead to it: then what it is made from is never later than itself.
//
// Patterns forget their subjects, but for those of axioms, and objects too where there are very many: an order may be refused
// that the facts would allow, never the other way about.
//
// Rules with negation may make no axioms, since these would change the order while it is followed. That is, none that can
// matter: each word that a rule concludes is by `rdfs` a part of itself (ex:free rdfs:subPropertyOf ex:free). A rule that, where
// the two terms of its axiom are the same, concludes one of its own premises makes nothing of such an axiom, and that it is
// there changes no order; nor does one that a FILTER lets no rule take.
// Private to this folder. Writer thread only.
#ifndef DOCENT_REASONER_RULES_NEGATION_ORDER_H_
#define DOCENT_REASONER_RULES_NEGATION_ORDER_H_

#include "absl/status/statusor.h"
#include "reasoner/rules/equality_classes.h"
#include "reasoner/rules/rule_program.h"
#include "reasoner/rules/schema_index.h"

namespace docent::rules {

// FAILED_PRECONDITION, with the way round, the axioms on it among them: there is no order. `schema`, `classes`, `graph`: the axioms that
// are there. `dictionary`: of all. An order for some axioms holds for less of them, too.
//
// Rules about axioms alone are joined with those in `graph`. An order may put off the very axioms that it was asked for; so they
// count, too, that an earlier one was (`before`). kNothing: as if there might be any.
enum class AskAxioms : uint8_t { kNothing, kGraph };
absl::StatusOr<NegationOrder> OrderNegation(const RuleProgram& program, const SchemaIndex& schema,
                                            const EqualityClasses& classes, const GraphVersion& graph,
                                            const Dictionary& dictionary, const AxiomAnswers& before = {},
                                            AskAxioms ask = AskAxioms::kGraph);

// Whether the order knew all that `graph` answers now to what it asked.
bool KnowsAnswers(const NegationOrder& order, const GraphVersion& graph);

}  // namespace docent::rules

#endif  // DOCENT_REASONER_RULES_NEGATION_ORDER_H_
