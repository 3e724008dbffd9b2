#include "reasoner/rules/rule_sets.h"

#include "reasoner/rules/owl2rl_rules.h"

namespace docent::rules {
namespace {

// W3C RDF 1.1 Semantics, sections 8.1.1 and 9.2.1, with the axiomatic triples of 8 and 9 (those of rdf:_n for
// the container properties that occur).
constexpr char kRdfs[] = R"rules(
PREFIX rs: <https://w3id.org/docent/rules/rdfs#>

RULE rs:rdf-axioms {
  rdf:type a rdf:Property . rdf:subject a rdf:Property . rdf:predicate a rdf:Property .
  rdf:object a rdf:Property . rdf:first a rdf:Property . rdf:rest a rdf:Property .
  rdf:value a rdf:Property . rdf:nil a rdf:List } WHERE { }
RULE rs:rdfs-axioms {
  rdf:type rdfs:domain rdfs:Resource . rdfs:domain rdfs:domain rdf:Property .
  rdfs:range rdfs:domain rdf:Property . rdfs:subPropertyOf rdfs:domain rdf:Property .
  rdfs:subClassOf rdfs:domain rdfs:Class . rdf:subject rdfs:domain rdf:Statement .
  rdf:predicate rdfs:domain rdf:Statement . rdf:object rdfs:domain rdf:Statement .
  rdfs:member rdfs:domain rdfs:Resource . rdf:first rdfs:domain rdf:List . rdf:rest rdfs:domain rdf:List .
  rdfs:seeAlso rdfs:domain rdfs:Resource . rdfs:isDefinedBy rdfs:domain rdfs:Resource .
  rdfs:comment rdfs:domain rdfs:Resource . rdfs:label rdfs:domain rdfs:Resource .
  rdf:value rdfs:domain rdfs:Resource .
  rdf:type rdfs:range rdfs:Class . rdfs:domain rdfs:range rdfs:Class . rdfs:range rdfs:range rdfs:Class .
  rdfs:subPropertyOf rdfs:range rdf:Property . rdfs:subClassOf rdfs:range rdfs:Class .
  rdf:subject rdfs:range rdfs:Resource . rdf:predicate rdfs:range rdfs:Resource .
  rdf:object rdfs:range rdfs:Resource . rdfs:member rdfs:range rdfs:Resource .
  rdf:first rdfs:range rdfs:Resource . rdf:rest rdfs:range rdf:List . rdfs:seeAlso rdfs:range rdfs:Resource .
  rdfs:isDefinedBy rdfs:range rdfs:Resource . rdfs:comment rdfs:range rdfs:Literal .
  rdfs:label rdfs:range rdfs:Literal . rdf:value rdfs:range rdfs:Resource .
  rdf:Alt rdfs:subClassOf rdfs:Container . rdf:Bag rdfs:subClassOf rdfs:Container .
  rdf:Seq rdfs:subClassOf rdfs:Container .
  rdfs:ContainerMembershipProperty rdfs:subClassOf rdf:Property .
  rdfs:isDefinedBy rdfs:subPropertyOf rdfs:seeAlso . rdfs:Datatype rdfs:subClassOf rdfs:Class } WHERE { }
RULE rs:rdfs1 {
  rdf:langString a rdfs:Datatype . xsd:string a rdfs:Datatype . xsd:boolean a rdfs:Datatype .
  xsd:decimal a rdfs:Datatype . xsd:integer a rdfs:Datatype . xsd:double a rdfs:Datatype .
  xsd:float a rdfs:Datatype . xsd:date a rdfs:Datatype . xsd:dateTime a rdfs:Datatype } WHERE { }
RULE rs:rdfD2 { ?p a rdf:Property } WHERE { ?x ?p ?y }
RULE rs:rdfs2 { ?x a ?c } WHERE { ?p rdfs:domain ?c . ?x ?p ?y FILTER(?c != rdfs:Resource) }
RULE rs:rdfs3 { ?y a ?c } WHERE { ?p rdfs:range ?c . ?x ?p ?y FILTER(?c != rdfs:Resource) }
RULE rs:rdfs5 { ?p1 rdfs:subPropertyOf ?p3 } WHERE {
  ?p1 rdfs:subPropertyOf ?p2 . ?p2 rdfs:subPropertyOf ?p3 }
RULE rs:rdfs6 { ?p rdfs:subPropertyOf ?p } WHERE { ?p a rdf:Property }
RULE rs:rdfs7 { ?x ?p2 ?y } WHERE { ?p1 rdfs:subPropertyOf ?p2 . ?x ?p1 ?y FILTER(?p1 != ?p2) }
RULE rs:rdfs8 { ?c rdfs:subClassOf rdfs:Resource } WHERE { ?c a rdfs:Class }
RULE rs:rdfs9 { ?x a ?c2 } WHERE {
  ?c1 rdfs:subClassOf ?c2 . ?x a ?c1 FILTER(?c1 != ?c2) FILTER(?c2 != rdfs:Resource) }
RULE rs:rdfs10 { ?c rdfs:subClassOf ?c } WHERE { ?c a rdfs:Class }
RULE rs:rdfs11 { ?c1 rdfs:subClassOf ?c3 } WHERE { ?c1 rdfs:subClassOf ?c2 . ?c2 rdfs:subClassOf ?c3 }
RULE rs:rdfs12 { ?p rdfs:subPropertyOf rdfs:member } WHERE { ?p a rdfs:ContainerMembershipProperty }
RULE rs:rdfs13 { ?d rdfs:subClassOf rdfs:Literal } WHERE { ?d a rdfs:Datatype }
RULE rs:rdf_n { ?p a rdfs:ContainerMembershipProperty } WHERE {
  ?p a rdf:Property FILTER(REGEX(STR(?p), "^http://www[.]w3[.]org/1999/02/22-rdf-syntax-ns#_[1-9][0-9]*$")) }
)rules";

}  // namespace

std::vector<std::string> BuiltInRuleSets() {
  return {"rdfs", "owl2rl"};
}

std::string BuiltInRuleSet(std::string_view name) {
  if (name == "rdfs") return kRdfs;
  if (name == "owl2rl") return Owl2RlRules();
  return "";
}

std::vector<std::string> EntailmentRegimes(std::string_view name) {
  if (name == "rdfs") return {"http://www.w3.org/ns/entailment/RDF", "http://www.w3.org/ns/entailment/RDFS"};
  if (name == "owl2rl") return {"http://www.w3.org/ns/owl-profile/RL"};
  return {};
}

}  // namespace docent::rules
