// Explanations as text for people, and proofs as RDF (W3C PROV-O). Pure functions; any thread.
#ifndef DOCENT_REASONER_EXPLAIN_EXPLANATION_TEXT_H_
#define DOCENT_REASONER_EXPLAIN_EXPLANATION_TEXT_H_

#include <string>
#include <utility>
#include <vector>

#include "reasoner/explain/proof.h"
#include "reasoner/explain/why_not.h"

namespace docent::explain {

using Prefixes = std::vector<std::pair<std::string, std::string>>;

// A tree, indented by two columns for each step; facts already shown are referred to:
//
//   expo:John docent:isNear expo:R01
//     by guide.rules rule 1 (line 5), ?region = expo:Entrance
//     expo:John docent:isAt expo:Entrance
//       told by docent:default, reading of expo:DoorSensor, 2026-11-21 10:00:00 UTC, log offset 12
std::string ToText(const Proof& proof, const Prefixes& prefixes);

// What has to change, on one line: "ex:R1 ex:battery ?b ." for what is missing, "not ex:Lift ex:inUseBy ex:John ." for what is in
// the way; and what else is to be known of it: "now 0.1; where (?b > 0.2)", or nothing.
std::string ChangesText(const Repair& repair, const Prefixes& prefixes);
std::string RemarksText(const Repair& repair, const Prefixes& prefixes);

// "missing …", "in the way …", the facts that hold already, and those that would follow.
std::string ToText(const WhyNotAnswer& answer, const Prefixes& prefixes);

// Each fact is a prov:Entity that is an rdf:Statement. An inferred fact has prov:wasDerivedFrom its premises
// and prov:wasGeneratedBy the application of its rule; an asserted one has prov:wasAttributedTo its graph,
// with prov:generatedAtTime and docent:logOffset if known. Blank nodes "f0", "f1", … by step.
std::vector<TermQuad> ToProv(const Proof& proof);

}  // namespace docent::explain

#endif  // DOCENT_REASONER_EXPLAIN_EXPLANATION_TEXT_H_
