#include "reasoner/ontology/finding_kinds.h"

#include <algorithm>

namespace docent::ontology {

const std::vector<FindingKind>& FindingKinds() {
  static const auto* kinds = new std::vector<FindingKind>{
      {"bad-literal", "error", "RDF",
       "The text of a literal is not one that its datatype allows: \"soon\"^^xsd:dateTime.",
       "Correct the text or the datatype."},
      {"consistency", "warning", "RDF, rules",
       "Something could not be taken into account when the facts were checked for contradictions: a rule "
       "that cannot stand beside "
       "OWL 2 RL, or more facts or time than the limits allow.",
       "See the hint of the finding; name fewer files at once, or shorten them."},
      {"cycle", "warning", "RDF",
       "Classes or properties are below each other in a circle, so they mean the same.",
       "Remove one of the rdfs:subClassOf or rdfs:subPropertyOf, or write owl:equivalentClass or "
       "owl:equivalentProperty."},
      {"disjoint-types", "error", "RDF",
       "A thing is in two disjoint classes, or a class is below two disjoint classes and can have no "
       "members.",
       "Remove one of the types, or the owl:disjointWith."},
      {"domain-clash", "error", "RDF",
       "The subject of a fact cannot be in the domain of the property: its class is disjoint with it.",
       "Use another property, or correct the type of the subject."},
      {"domain-mismatch", "warning", "RDF",
       "The subject of a fact is not known to be in the domain of the property. Rules of OWL would infer "
       "that it is.",
       "Add the type, or use another property."},
      {"import", "warning", "RDF",
       "An ontology is imported (owl:imports) that is in none of the files named. Imports are not fetched.",
       "Name the file of the imported ontology, too."},
      {"inconsistency", "error", "RDF, rules",
       "The facts contradict each other under the rules of OWL 2 RL and the rules named. The proof shows the "
       "facts and rules "
       "that it rests on.",
       "Correct or remove one of the facts of the proof, or the rule."},
      {"limit", "warning", "all", "The file has more findings than are shown, or an explanation is too long.",
       "Correct the findings that are shown first."},
      {"long-list", "warning", "RDF",
       "A property chain or key is longer than the rule set owl2rl follows; nothing is inferred from it.",
       "Give a part of the chain a property of its own, or name fewer properties, or write a rule."},
      {"missing-comment", "warning", "RDF", "A class or property has a label but no rdfs:comment.",
       "Add an rdfs:comment that says what it means and when it holds."},
      {"missing-label", "warning", "RDF", "A class or property has no rdfs:label.",
       "Add an rdfs:label, the word that people see."},
      {"namespace", "warning", "RDF, SPARQL, rules",
       "A namespace is unknown but differs little from a known one, by its case, its last sign or http for "
       "https.",
       "Correct the namespace, usually in a prefix declaration."},
      {"range-clash", "error", "RDF",
       "The value of a fact cannot be in the range of the property: it is of a disjoint class or another "
       "datatype, or it is a "
       "literal where a resource is needed or the reverse.",
       "Use another property, or correct the value or its type."},
      {"range-mismatch", "warning", "RDF",
       "The value of a fact is not known to be in the range of the property. Rules of OWL would infer that "
       "it is.",
       "Add the type, or use another property."},
      {"rule", "warning", "RDF, rules",
       "A rule is valid, but may do less than its author means, such as one imported from SHACL that sees no "
       "instances of subclasses.",
       "See the hint of the finding."},
      {"service", "error or warning", "RSEL",
       "A robot service is not valid: a missing part, an unknown process, a circle of invocations.",
       "See the hint of the finding, and the reference of RSEL."},
      {"shape", "error or warning", "RDF",
       "A SHACL shape is not well-formed, refers to itself, or uses something that is not supported.",
       "See the hint of the finding, and the reference of shapes."},
      {"syntax", "error or warning", "all",
       "The file does not follow its grammar. Nothing else of it is checked.",
       "Correct the text at the place that the finding names."},
      {"undefined-term", "error", "RDF, SPARQL, rules",
       "A word of a namespace that the files named define is not defined there. Usually it is misspelt; the "
       "hint names the nearest word.",
       "Correct the word, or declare it in its ontology."},
      {"unused-prefix", "warning", "RDF, SPARQL, rules", "A prefix is declared and not used.",
       "Remove the declaration."},
      {"workflow", "error or warning", "CAWL",
       "A workflow is not valid: an unknown word, a condition that does not compile, a node that can never "
       "be reached.",
       "See the hint of the finding, and the reference of CAWL."},
      {"wrong-kind", "error", "RDF, SPARQL, rules",
       "A property stands where a class is needed, or the reverse.",
       "Use the word that the hint names, or correct its declaration."},
  };
  return *kinds;
}

bool IsFindingKind(std::string_view rule) {
  return std::any_of(FindingKinds().begin(), FindingKinds().end(),
                     [&](const FindingKind& kind) { return kind.rule == rule; });
}

}  // namespace docent::ontology
