#include "reasoner/ontology/finding_kinds.h"

#include <algorithm>

namespace docent::ontology {

const std::vector<FindingKind>& FindingKinds() {
  static const auto* kinds = new std::vector<FindingKind>{
      {"activator-feeds-itself", "warning", "CAWL",
       "A constraint of an activator matches what its own runs write into the graph: it matches any fact, or "
       "facts of runs "
       "whatever their workflow. Each run may then start another. A turn ends that at a limit, and the "
       "deployment of such a "
       "workflow may be refused.",
       "Name a predicate, a class or a thing; or leave the workflow's own runs out by docent:workflow."},
      {"activator-never-rises", "warning", "CAWL",
       "No alternative of an activator's condition can hold, so it starts no run. What is wrong with the "
       "alternatives is told beside it.",
       "Correct the condition."},
      {"always-true-condition", "warning", "CAWL",
       "A condition, a context or a rule always holds: it has no constraint, or its expression is true "
       "whatever its parts are. An activator with such a condition starts one run, when the document is "
       "deployed.",
       "Say what must hold, or leave it out."},
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
      {"load", "error", "all",
       "A server refuses to load the file, alone or after those that are named before it: it goes beyond a "
       "limit of a "
       "turn, or its name cannot be one of a document. The message is the server's.",
       "See the message: it names the limit."},
      {"long-list", "warning", "RDF",
       "A property chain or key is longer than the rule set owl2rl follows; nothing is inferred from it.",
       "Give a part of the chain a property of its own, or name fewer properties, or write a rule."},
      {"loop-without-wait", "warning", "CAWL",
       "The nodes of a loop have neither a condition nor an invoke. While the condition of the link that "
       "leads back holds, the loop goes round until the limit node_iterations.",
       "Give a node of the loop a condition that waits for what is to come."},
      {"max-without-effect", "warning", "CAWL",
       "An activator has ext:max with a mode that gives each key one run at a time: single or restart.",
       "Leave the max out, or use another mode."},
      {"missing-comment", "warning", "RDF", "A class or property has a label but no rdfs:comment.",
       "Add an rdfs:comment that says what it means and when it holds."},
      {"missing-label", "warning", "RDF", "A class or property has no rdfs:label.",
       "Add an rdfs:label, the word that people see."},
      {"namespace", "warning", "RDF, SPARQL, rules",
       "A namespace is unknown but differs little from a known one, by its case, its last sign or http for "
       "https.",
       "Correct the namespace, usually in a prefix declaration."},
      {"no-way-to-sink", "error", "CAWL",
       "No links lead from a node, or from the source, to the sink: a run would never end.",
       "Link the node on."},
      {"range-clash", "error", "RDF",
       "The value of a fact cannot be in the range of the property: it is of a disjoint class or another "
       "datatype, or it is a "
       "literal where a resource is needed or the reverse.",
       "Use another property, or correct the value or its type."},
      {"range-mismatch", "warning", "RDF",
       "The value of a fact is not known to be in the range of the property. Rules of OWL would infer that "
       "it is.",
       "Add the type, or use another property."},
      {"release-before-use", "warning", "CAWL",
       "A node gives back its robot when it opens, before its invoke takes the robot again.",
       "Write at=\"done\": it is given back when the node is done."},
      {"robot-race", "warning", "CAWL, RSEL",
       "Two nodes that may be active at the same time, or two invocations that start together, command the "
       "same robot.",
       "Put them one after the other, or let each bind a ?robot of its own."},
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
      {"shared-start", "warning", "CAWL",
       "Another workflow, among the files or deployed and enabled, starts a run on the same wish, event or "
       "situation. Each of them serves it, one after the other or with two robots.",
       "Disable or replace one of them, or say in the conditions what tells them apart."},
      {"syntax", "error or warning", "all",
       "The file does not follow its grammar. Nothing else of it is checked.",
       "Correct the text at the place that the finding names."},
      {"timeout-without-effect", "warning", "CAWL",
       "A timeout ends nothing: it stands where nothing takes time, at an activator, or behind one that ends "
       "first. Or the delay of further attempts of an invocation is as long as the timeout of the node, so "
       "that there are none.",
       "Take it away, or put it where something is waited for; make the delay shorter."},
      {"type-clash", "warning", "CAWL, RSEL",
       "A value does not suit: a literal where the property has resources or the reverse, a literal of "
       "another datatype, a variable whose declared type is disjoint with what a constraint or an operation "
       "needs, a constant that a variable or an input of another type gets, a part that is given to one of "
       "another type.",
       "Correct the word, or the type of the variable or part."},
      {"undefined-term", "error or warning", "CAWL, RSEL, RDF, SPARQL, rules",
       "A word of a namespace that the files named define is not defined there, or a datatype of xsd: is "
       "none "
       "of XML Schema. Usually it is misspelt; the hint names the nearest word. In CAWL and RSEL it is a "
       "warning.",
       "Correct the word, or declare it in its ontology."},
      {"unknown-input", "warning", "CAWL",
       "ext:input gives a value to an input that the operation, or the flow of the same document, does not "
       "have. The value is not used.",
       "Correct the name of the part."},
      {"unknown-operation", "warning", "CAWL, RSEL",
       "No robot offers an operation now, and no robot service has this name. An invocation of it waits "
       "until a robot joins that offers it.",
       "Correct the name where it is misspelt; the hint names the nearest one."},
      {"unknown-output", "warning", "CAWL",
       "ext:output names a result that the flow of the same document, or the robot service, does not give. "
       "The "
       "variable gets no value.",
       "Correct the name of the part."},
      {"unreachable-node", "error", "CAWL", "No links lead from the source to a node.",
       "Link it, or remove it."},
      {"unsatisfiable-condition", "warning", "CAWL",
       "An alternative of a condition can never hold: its constraints need one thing to be in two disjoint "
       "classes, need something to hold and not to hold, compare with a variable that has no value, or must "
       "have held for longer than the wait lasts. Or a joinCondition is never true: it needs a node and "
       "needs it not, or two of which only one comes.",
       "Correct one of the constraints, or the expression."},
      {"unset-variable", "error or warning", "CAWL",
       "A variable is used where it can have no value: nothing initializes it, and no condition, action or "
       "operation before gives it one. The same is said of ?name in an expression, and of a variable of an "
       "activator "
       "that its condition does not bind.",
       "Initialize it, or bind it in a condition before; write $name in an expression."},
      {"unused-prefix", "warning", "RDF, SPARQL, rules", "A prefix is declared and not used.",
       "Remove the declaration."},
      {"value-range", "warning", "RDF",
       "A literal has a value that its datatype allows and the server does not compute with: a year beyond "
       "200000, a "
       "number of more than 38 digits. It is kept as it is written, equals only the same text, and "
       "comparisons with it "
       "are errors.",
       "Write a value that can be computed with, if it is to be compared."},
      {"variable-race", "warning", "CAWL",
       "Two nodes that may be active at the same time, or two invokes of one node, set the same variable. "
       "What "
       "it is afterwards depends on which of them is done last. Two that set the same constant, or count on "
       "from its value, are not meant, nor two before a joinCondition with `or`.",
       "Put them one after the other, or let each set a variable of its own."},
      {"while-holds-without-effect", "warning", "CAWL",
       "A node with ext:while-holds=\"true\" makes its own condition fall by what it tells or withdraws when "
       "it opens. What a "
       "node does itself does not stop it: the condition is not asked again.",
       "Leave what the node itself tells out of its condition, or write what has to hold as a pattern of its "
       "own."},
      {"workflow", "error or warning", "CAWL",
       "A workflow is not valid: an unknown word, a condition that does not compile.",
       "See the hint of the finding, and the reference of CAWL."},
      {"wrong-kind", "error", "RDF, SPARQL, rules", "A property is used in place of a class, or the reverse.",
       "Use the word that the hint names, or correct its declaration."},
  };
  return *kinds;
}

bool IsFindingKind(std::string_view rule) {
  return std::any_of(FindingKinds().begin(), FindingKinds().end(),
                     [&](const FindingKind& kind) { return kind.rule == rule; });
}

}  // namespace docent::ontology
