// Order of the rules with negation, if it depends on the axioms.
//
// Rules of OWL such as ?s owl:sameAs ?t . ?s ?p ?o → ?t ?p ?o may make any fact from any other, so without
// the axioms every rule with negation would seem to negate its own consequences. Their actual results depend
// on the existing axioms. So the conclusions of each such rule (RuleProgram::ordered) are followed, as
// patterns, through the rules and through the instances of the SchemaIndex: `?r ex:free true` leads by
// `ex:free rdfs:subPropertyOf ex:idle` to `?r ex:idle true`. A rule that negates a consequence of another
// rule comes after it; a rule that negates its own consequence is an error. A fact belongs to the last rule
// that may lead to it, so its premises are never later than itself.
//
// Patterns drop their subjects (except those of axioms), and also their objects if there are very many. So an
// order may be refused although the facts would allow it, but a wrong order is never accepted.
//
// Rules with negation must not make relevant axioms, since these would change the order while it is followed.
// An axiom is irrelevant if no rule can use it for a new fact. Example: the set `rdfs` makes each concluded
// property a part of itself (ex:free rdfs:subPropertyOf ex:free). With both terms equal, a rule for such an
// axiom only concludes one of its own premises; so the axiom changes no order. An axiom that a FILTER keeps
// from all rules is irrelevant, too.
// Private to this folder. Writer thread only.
#ifndef DOCENT_REASONER_RULES_NEGATION_ORDER_H_
#define DOCENT_REASONER_RULES_NEGATION_ORDER_H_

#include "absl/status/statusor.h"
#include "reasoner/rules/equality_classes.h"
#include "reasoner/rules/rule_program.h"
#include "reasoner/rules/schema_index.h"

namespace docent::rules {

// FAILED_PRECONDITION if there is no order, with the cycle and its axioms. `schema`, `classes`, `graph`: the
// existing axioms. `dictionary`: of all. An order for some axioms also holds for fewer of them.
//
// Rules about axioms alone are joined with the axioms in `graph`. An order may put off axioms on which it is
// based; so the axioms that an earlier order used (`before`) count, too. kNothing: as if any axiom might
// exist.
enum class AskAxioms : uint8_t { kNothing, kGraph };
absl::StatusOr<NegationOrder> OrderNegation(const RuleProgram& program, const SchemaIndex& schema,
                                            const EqualityClasses& classes, const GraphVersion& graph,
                                            const Dictionary& dictionary, const AxiomAnswers& before = {},
                                            AskAxioms ask = AskAxioms::kGraph);

// True if the order is based on all current answers of `graph` to its questions.
bool KnowsAnswers(const NegationOrder& order, const GraphVersion& graph);

}  // namespace docent::rules

#endif  // DOCENT_REASONER_RULES_NEGATION_ORDER_H_
