// OWL 2 RL/RDF: W3C OWL 2 Profiles (Second Edition), section 4.3, tables 4 to 9.
//
// Filters exclude trivial applications of a rule (x sameAs x, x a C from x a C); they change no answer.
// docs/reference/rules.md lists what is left out, and why.
#include "reasoner/rules/owl2rl_rules.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "reasoner/rules/rule_sets.h"

namespace docent::rules {
namespace {

constexpr char kEquality[] = R"rules(
PREFIX rl: <https://w3id.org/docent/rules/owl2rl#>

# lists of axioms: ?l docent:listNode ?n, for each cell ?n of the list ?l
RULE rl:list { ?l docent:listNode ?l } WHERE { ?x owl:members ?l FILTER(?l != rdf:nil) }
RULE rl:list { ?l docent:listNode ?l } WHERE { ?x owl:distinctMembers ?l FILTER(?l != rdf:nil) }
RULE rl:list { ?l docent:listNode ?l } WHERE { ?x owl:intersectionOf ?l FILTER(?l != rdf:nil) }
RULE rl:list { ?l docent:listNode ?l } WHERE { ?x owl:unionOf ?l FILTER(?l != rdf:nil) }
RULE rl:list { ?l docent:listNode ?l } WHERE { ?x owl:oneOf ?l FILTER(?l != rdf:nil) }
RULE rl:list { ?l docent:listNode ?m } WHERE { ?l docent:listNode ?n . ?n rdf:rest ?m FILTER(?m != rdf:nil) }

# Table 4: equality
RULE rl:eq-sym { ?y owl:sameAs ?x } WHERE { ?x owl:sameAs ?y }
RULE rl:eq-trans { ?x owl:sameAs ?z } WHERE { ?x owl:sameAs ?y . ?y owl:sameAs ?z }
RULE rl:eq-rep-s { ?s2 ?p ?o } WHERE { ?s owl:sameAs ?s2 . ?s ?p ?o FILTER(?s != ?s2) }
RULE rl:eq-rep-p { ?s ?p2 ?o } WHERE { ?p owl:sameAs ?p2 . ?s ?p ?o FILTER(?p != ?p2) }
RULE rl:eq-rep-o { ?s ?p ?o2 } WHERE { ?o owl:sameAs ?o2 . ?s ?p ?o FILTER(?o != ?o2) }
RULE rl:eq-diff1 { } WHERE { ?x owl:sameAs ?y . ?x owl:differentFrom ?y }
RULE rl:eq-diff1 { } WHERE { ?x owl:differentFrom ?x }
RULE rl:eq-diff2 { } WHERE {
  ?x a owl:AllDifferent . ?x owl:members ?l . ?l docent:listNode ?n1 . ?l docent:listNode ?n2 .
  ?n1 rdf:first ?z1 . ?n2 rdf:first ?z2 . ?z1 owl:sameAs ?z2 FILTER(?n1 != ?n2) }
RULE rl:eq-diff3 { } WHERE {
  ?x a owl:AllDifferent . ?x owl:distinctMembers ?l . ?l docent:listNode ?n1 . ?l docent:listNode ?n2 .
  ?n1 rdf:first ?z1 . ?n2 rdf:first ?z2 . ?z1 owl:sameAs ?z2 FILTER(?n1 != ?n2) }
# eq-ref is left out, so what is stated to be different from itself is looked for as it stands
RULE rl:eq-diff2 { } WHERE {
  ?x a owl:AllDifferent . ?x owl:members ?l . ?l docent:listNode ?n1 . ?l docent:listNode ?n2 .
  ?n1 rdf:first ?z . ?n2 rdf:first ?z FILTER(?n1 != ?n2) }
RULE rl:eq-diff3 { } WHERE {
  ?x a owl:AllDifferent . ?x owl:distinctMembers ?l . ?l docent:listNode ?n1 . ?l docent:listNode ?n2 .
  ?n1 rdf:first ?z . ?n2 rdf:first ?z FILTER(?n1 != ?n2) }
)rules";

constexpr char kProperties[] = R"rules(
# Table 5: axioms about properties
RULE rl:prp-ap {
  rdfs:label a owl:AnnotationProperty . rdfs:comment a owl:AnnotationProperty .
  rdfs:seeAlso a owl:AnnotationProperty . rdfs:isDefinedBy a owl:AnnotationProperty .
  owl:deprecated a owl:AnnotationProperty . owl:versionInfo a owl:AnnotationProperty .
  owl:priorVersion a owl:AnnotationProperty . owl:backwardCompatibleWith a owl:AnnotationProperty .
  owl:incompatibleWith a owl:AnnotationProperty } WHERE { }
RULE rl:prp-dom { ?x a ?c } WHERE { ?p rdfs:domain ?c . ?x ?p ?y }
RULE rl:prp-rng { ?y a ?c } WHERE { ?p rdfs:range ?c . ?x ?p ?y }
RULE rl:prp-fp { ?y1 owl:sameAs ?y2 } WHERE {
  ?p a owl:FunctionalProperty . ?x ?p ?y1 . ?x ?p ?y2 FILTER(?y1 != ?y2) }
RULE rl:prp-ifp { ?x1 owl:sameAs ?x2 } WHERE {
  ?p a owl:InverseFunctionalProperty . ?x1 ?p ?y . ?x2 ?p ?y FILTER(?x1 != ?x2) }
RULE rl:prp-irp { } WHERE { ?p a owl:IrreflexiveProperty . ?x ?p ?x }
RULE rl:prp-symp { ?y ?p ?x } WHERE { ?p a owl:SymmetricProperty . ?x ?p ?y }
RULE rl:prp-asyp { } WHERE { ?p a owl:AsymmetricProperty . ?x ?p ?y . ?y ?p ?x }
RULE rl:prp-trp { ?x ?p ?z } WHERE { ?p a owl:TransitiveProperty . ?x ?p ?y . ?y ?p ?z }
RULE rl:prp-spo1 { ?x ?p2 ?y } WHERE { ?p1 rdfs:subPropertyOf ?p2 . ?x ?p1 ?y FILTER(?p1 != ?p2) }
RULE rl:prp-eqp1 { ?x ?p2 ?y } WHERE { ?p1 owl:equivalentProperty ?p2 . ?x ?p1 ?y FILTER(?p1 != ?p2) }
RULE rl:prp-eqp2 { ?x ?p1 ?y } WHERE { ?p1 owl:equivalentProperty ?p2 . ?x ?p2 ?y FILTER(?p1 != ?p2) }
RULE rl:prp-pdw { } WHERE { ?p1 owl:propertyDisjointWith ?p2 . ?x ?p1 ?y . ?x ?p2 ?y }
RULE rl:prp-adp { } WHERE {
  ?a a owl:AllDisjointProperties . ?a owl:members ?l . ?l docent:listNode ?n1 . ?l docent:listNode ?n2 .
  ?n1 rdf:first ?p1 . ?n2 rdf:first ?p2 . ?x ?p1 ?y . ?x ?p2 ?y FILTER(?n1 != ?n2) }
RULE rl:prp-inv1 { ?y ?p2 ?x } WHERE { ?p1 owl:inverseOf ?p2 . ?x ?p1 ?y }
RULE rl:prp-inv2 { ?y ?p1 ?x } WHERE { ?p1 owl:inverseOf ?p2 . ?x ?p2 ?y }
RULE rl:prp-npa1 { } WHERE {
  ?x owl:sourceIndividual ?i1 . ?x owl:assertionProperty ?p . ?x owl:targetIndividual ?i2 . ?i1 ?p ?i2 }
RULE rl:prp-npa2 { } WHERE {
  ?x owl:sourceIndividual ?i . ?x owl:assertionProperty ?p . ?x owl:targetValue ?lt . ?i ?p ?lt }
)rules";

constexpr char kClasses[] = R"rules(
# Table 6: classes
RULE rl:cls-thing { owl:Thing a owl:Class } WHERE { }
RULE rl:cls-nothing1 { owl:Nothing a owl:Class } WHERE { }
RULE rl:cls-nothing2 { } WHERE { ?x a owl:Nothing }
RULE rl:cls-int2 { ?y a ?c1 } WHERE {
  ?c owl:intersectionOf ?l . ?l docent:listNode ?n . ?n rdf:first ?c1 . ?y a ?c }
RULE rl:cls-uni { ?y a ?c } WHERE {
  ?c owl:unionOf ?l . ?l docent:listNode ?n . ?n rdf:first ?c1 . ?y a ?c1 }
RULE rl:cls-com { } WHERE { ?c1 owl:complementOf ?c2 . ?x a ?c1 . ?x a ?c2 }
RULE rl:cls-svf1 { ?u a ?x } WHERE {
  ?x owl:someValuesFrom ?y . ?x owl:onProperty ?p . ?u ?p ?v . ?v a ?y }
RULE rl:cls-svf2 { ?u a ?x } WHERE {
  ?x owl:someValuesFrom owl:Thing . ?x owl:onProperty ?p . ?u ?p ?v }
RULE rl:cls-avf { ?v a ?y } WHERE {
  ?x owl:allValuesFrom ?y . ?x owl:onProperty ?p . ?u a ?x . ?u ?p ?v }
RULE rl:cls-hv1 { ?u ?p ?y } WHERE { ?x owl:hasValue ?y . ?x owl:onProperty ?p . ?u a ?x }
RULE rl:cls-hv2 { ?u a ?x } WHERE { ?x owl:hasValue ?y . ?x owl:onProperty ?p . ?u ?p ?y }
RULE rl:cls-maxc1 { } WHERE {
  ?x owl:maxCardinality ?n . ?x owl:onProperty ?p . ?u a ?x . ?u ?p ?y FILTER(?n = 0) }
RULE rl:cls-maxc2 { ?y1 owl:sameAs ?y2 } WHERE {
  ?x owl:maxCardinality ?n . ?x owl:onProperty ?p . ?u a ?x . ?u ?p ?y1 . ?u ?p ?y2
  FILTER(?n = 1) FILTER(?y1 != ?y2) }
RULE rl:cls-maxqc1 { } WHERE {
  ?x owl:maxQualifiedCardinality ?n . ?x owl:onProperty ?p . ?x owl:onClass ?c . ?u a ?x . ?u ?p ?y . ?y a ?c
  FILTER(?n = 0) }
RULE rl:cls-maxqc2 { } WHERE {
  ?x owl:maxQualifiedCardinality ?n . ?x owl:onProperty ?p . ?x owl:onClass owl:Thing . ?u a ?x . ?u ?p ?y
  FILTER(?n = 0) }
RULE rl:cls-maxqc3 { ?y1 owl:sameAs ?y2 } WHERE {
  ?x owl:maxQualifiedCardinality ?n . ?x owl:onProperty ?p . ?x owl:onClass ?c . ?u a ?x .
  ?u ?p ?y1 . ?y1 a ?c . ?u ?p ?y2 . ?y2 a ?c FILTER(?n = 1) FILTER(?y1 != ?y2) }
RULE rl:cls-maxqc4 { ?y1 owl:sameAs ?y2 } WHERE {
  ?x owl:maxQualifiedCardinality ?n . ?x owl:onProperty ?p . ?x owl:onClass owl:Thing . ?u a ?x .
  ?u ?p ?y1 . ?u ?p ?y2 FILTER(?n = 1) FILTER(?y1 != ?y2) }
RULE rl:cls-oo { ?y a ?c } WHERE { ?c owl:oneOf ?l . ?l docent:listNode ?n . ?n rdf:first ?y }

# Table 7: class axioms
RULE rl:cax-sco { ?x a ?c2 } WHERE { ?c1 rdfs:subClassOf ?c2 . ?x a ?c1 FILTER(?c1 != ?c2) }
RULE rl:cax-eqc1 { ?x a ?c2 } WHERE { ?c1 owl:equivalentClass ?c2 . ?x a ?c1 FILTER(?c1 != ?c2) }
RULE rl:cax-eqc2 { ?x a ?c1 } WHERE { ?c1 owl:equivalentClass ?c2 . ?x a ?c2 FILTER(?c1 != ?c2) }
RULE rl:cax-dw { } WHERE { ?c1 owl:disjointWith ?c2 . ?x a ?c1 . ?x a ?c2 }
RULE rl:cax-adc { } WHERE {
  ?a a owl:AllDisjointClasses . ?a owl:members ?l . ?l docent:listNode ?n1 . ?l docent:listNode ?n2 .
  ?n1 rdf:first ?c1 . ?n2 rdf:first ?c2 . ?x a ?c1 . ?x a ?c2 FILTER(?n1 != ?n2) }
)rules";

constexpr char kSchema[] = R"rules(
# Table 8: datatypes
RULE rl:dt-type1 {
  rdf:PlainLiteral a rdfs:Datatype . rdf:XMLLiteral a rdfs:Datatype . rdfs:Literal a rdfs:Datatype .
  xsd:decimal a rdfs:Datatype . xsd:integer a rdfs:Datatype . xsd:nonNegativeInteger a rdfs:Datatype .
  xsd:nonPositiveInteger a rdfs:Datatype . xsd:positiveInteger a rdfs:Datatype .
  xsd:negativeInteger a rdfs:Datatype . xsd:long a rdfs:Datatype . xsd:int a rdfs:Datatype .
  xsd:short a rdfs:Datatype . xsd:byte a rdfs:Datatype . xsd:unsignedLong a rdfs:Datatype .
  xsd:unsignedInt a rdfs:Datatype . xsd:unsignedShort a rdfs:Datatype . xsd:unsignedByte a rdfs:Datatype .
  xsd:float a rdfs:Datatype . xsd:double a rdfs:Datatype . xsd:string a rdfs:Datatype .
  xsd:normalizedString a rdfs:Datatype . xsd:token a rdfs:Datatype . xsd:language a rdfs:Datatype .
  xsd:Name a rdfs:Datatype . xsd:NCName a rdfs:Datatype . xsd:NMTOKEN a rdfs:Datatype .
  xsd:boolean a rdfs:Datatype . xsd:hexBinary a rdfs:Datatype . xsd:base64Binary a rdfs:Datatype .
  xsd:anyURI a rdfs:Datatype . xsd:dateTime a rdfs:Datatype . xsd:dateTimeStamp a rdfs:Datatype } WHERE { }

# Table 9: schema vocabulary
RULE rl:scm-cls { ?c rdfs:subClassOf ?c . ?c owl:equivalentClass ?c . ?c rdfs:subClassOf owl:Thing .
  owl:Nothing rdfs:subClassOf ?c } WHERE { ?c a owl:Class }
RULE rl:scm-sco { ?c1 rdfs:subClassOf ?c3 } WHERE { ?c1 rdfs:subClassOf ?c2 . ?c2 rdfs:subClassOf ?c3 }
RULE rl:scm-eqc1 { ?c1 rdfs:subClassOf ?c2 . ?c2 rdfs:subClassOf ?c1 } WHERE { ?c1 owl:equivalentClass ?c2 }
RULE rl:scm-eqc2 { ?c1 owl:equivalentClass ?c2 } WHERE {
  ?c1 rdfs:subClassOf ?c2 . ?c2 rdfs:subClassOf ?c1 }
RULE rl:scm-op { ?p rdfs:subPropertyOf ?p . ?p owl:equivalentProperty ?p } WHERE { ?p a owl:ObjectProperty }
RULE rl:scm-dp { ?p rdfs:subPropertyOf ?p . ?p owl:equivalentProperty ?p } WHERE { ?p a owl:DatatypeProperty }
RULE rl:scm-spo { ?p1 rdfs:subPropertyOf ?p3 } WHERE {
  ?p1 rdfs:subPropertyOf ?p2 . ?p2 rdfs:subPropertyOf ?p3 }
RULE rl:scm-eqp1 { ?p1 rdfs:subPropertyOf ?p2 . ?p2 rdfs:subPropertyOf ?p1 } WHERE {
  ?p1 owl:equivalentProperty ?p2 }
RULE rl:scm-eqp2 { ?p1 owl:equivalentProperty ?p2 } WHERE {
  ?p1 rdfs:subPropertyOf ?p2 . ?p2 rdfs:subPropertyOf ?p1 }
RULE rl:scm-dom1 { ?p rdfs:domain ?c2 } WHERE { ?p rdfs:domain ?c1 . ?c1 rdfs:subClassOf ?c2 }
RULE rl:scm-dom2 { ?p1 rdfs:domain ?c } WHERE { ?p2 rdfs:domain ?c . ?p1 rdfs:subPropertyOf ?p2 }
RULE rl:scm-rng1 { ?p rdfs:range ?c2 } WHERE { ?p rdfs:range ?c1 . ?c1 rdfs:subClassOf ?c2 }
RULE rl:scm-rng2 { ?p1 rdfs:range ?c } WHERE { ?p2 rdfs:range ?c . ?p1 rdfs:subPropertyOf ?p2 }
RULE rl:scm-hv { ?c1 rdfs:subClassOf ?c2 } WHERE {
  ?c1 owl:hasValue ?i . ?c1 owl:onProperty ?p1 . ?c2 owl:hasValue ?i . ?c2 owl:onProperty ?p2 .
  ?p1 rdfs:subPropertyOf ?p2 }
RULE rl:scm-svf1 { ?c1 rdfs:subClassOf ?c2 } WHERE {
  ?c1 owl:someValuesFrom ?y1 . ?c1 owl:onProperty ?p . ?c2 owl:someValuesFrom ?y2 . ?c2 owl:onProperty ?p .
  ?y1 rdfs:subClassOf ?y2 }
RULE rl:scm-svf2 { ?c1 rdfs:subClassOf ?c2 } WHERE {
  ?c1 owl:someValuesFrom ?y . ?c1 owl:onProperty ?p1 . ?c2 owl:someValuesFrom ?y . ?c2 owl:onProperty ?p2 .
  ?p1 rdfs:subPropertyOf ?p2 }
RULE rl:scm-avf1 { ?c1 rdfs:subClassOf ?c2 } WHERE {
  ?c1 owl:allValuesFrom ?y1 . ?c1 owl:onProperty ?p . ?c2 owl:allValuesFrom ?y2 . ?c2 owl:onProperty ?p .
  ?y1 rdfs:subClassOf ?y2 }
RULE rl:scm-avf2 { ?c2 rdfs:subClassOf ?c1 } WHERE {
  ?c1 owl:allValuesFrom ?y . ?c1 owl:onProperty ?p1 . ?c2 owl:allValuesFrom ?y . ?c2 owl:onProperty ?p2 .
  ?p1 rdfs:subPropertyOf ?p2 }
RULE rl:scm-int { ?c rdfs:subClassOf ?c1 } WHERE {
  ?c owl:intersectionOf ?l . ?l docent:listNode ?n . ?n rdf:first ?c1 }
RULE rl:scm-uni { ?c1 rdfs:subClassOf ?c } WHERE {
  ?c owl:unionOf ?l . ?l docent:listNode ?n . ?n rdf:first ?c1 }
)rules";

// ?l0 rdf:first ?v1 . ?l0 rdf:rest ?l1 . … ?l(n-1) rdf:rest rdf:nil
std::string List(const char* item, int length) {
  std::string text;
  for (int i = 0; i < length; ++i) {
    const std::string next = i + 1 == length ? "rdf:nil" : absl::StrCat("?l", i + 1);
    absl::StrAppend(&text, " ?l", i, " rdf:first ?", item, i + 1, " . ?l", i, " rdf:rest ", next, " .");
  }
  return text;
}

// FILTERs that pass a literal ?y outside the datatype ?d (OWL 2, section 4): from another value space, or
// with an invalid lexical form. IRIs never pass: they may name a value.
constexpr char kOutside[] = R"rules(
  FILTER(?d IN (xsd:decimal, xsd:integer, xsd:nonNegativeInteger, xsd:nonPositiveInteger, xsd:positiveInteger,
    xsd:negativeInteger, xsd:long, xsd:int, xsd:short, xsd:byte, xsd:unsignedLong, xsd:unsignedInt,
    xsd:unsignedShort, xsd:unsignedByte, xsd:float, xsd:double, xsd:string, xsd:boolean, xsd:dateTime,
    xsd:dateTimeStamp, xsd:anyURI, xsd:hexBinary, xsd:base64Binary, rdf:langString))
  FILTER(ISLITERAL(?y))
  FILTER(
    IF(?d IN (xsd:float, xsd:double), DATATYPE(?y) != ?d || !ISNUMERIC(?y),
    IF(?d = xsd:boolean, DATATYPE(?y) != ?d || STR(?y) NOT IN ("true", "false", "1", "0"),
    IF(?d = xsd:string, DATATYPE(?y) NOT IN (xsd:string, xsd:normalizedString, xsd:token, xsd:language, xsd:Name,
      xsd:NCName, xsd:NMTOKEN),
    IF(?d IN (xsd:dateTime, xsd:dateTimeStamp), DATATYPE(?y) NOT IN (xsd:dateTime, xsd:dateTimeStamp)
      || COALESCE(YEAR(?y), 0) = 0 || (?d = xsd:dateTimeStamp && TZ(?y) = ""),
    IF(?d IN (xsd:anyURI, xsd:hexBinary, xsd:base64Binary, rdf:langString), DATATYPE(?y) != ?d,
    !ISNUMERIC(?y) || DATATYPE(?y) IN (xsd:float, xsd:double) || (?d != xsd:decimal && FLOOR(?y) != ?y)
      || (?d IN (xsd:nonNegativeInteger, xsd:unsignedLong, xsd:unsignedInt, xsd:unsignedShort, xsd:unsignedByte)
          && ?y < 0)
      || (?d = xsd:positiveInteger && ?y < 1) || (?d = xsd:nonPositiveInteger && ?y > 0)
      || (?d = xsd:negativeInteger && ?y > -1)
      || (?d = xsd:long && (?y < -9223372036854775808 || ?y > 9223372036854775807))
      || (?d = xsd:int && (?y < -2147483648 || ?y > 2147483647)) || (?d = xsd:unsignedInt && ?y > 4294967295)
      || (?d = xsd:short && (?y < -32768 || ?y > 32767)) || (?d = xsd:unsignedShort && ?y > 65535)
      || (?d = xsd:byte && (?y < -128 || ?y > 127)) || (?d = xsd:unsignedByte && ?y > 255)
      || (?d = xsd:unsignedLong && ?y > 18446744073709551615)))))))
)rules";

// An expression that distinguishes the value of a literal ?y from others: its value space (OWL 2, section 4:
// no two value spaces overlap) and, if the text decides it, the value. Numbers and times within a space are
// left to `!=`. An error for ill-typed literals and unknown datatypes.
constexpr char kValue[] = R"rules(
    IF(DATATYPE(?y) IN (xsd:string, rdf:langString), CONCAT("string ", LANG(?y), " ", STR(?y)),
    IF(DATATYPE(?y) IN (xsd:normalizedString, xsd:token, xsd:language, xsd:Name, xsd:NCName, xsd:NMTOKEN)
      && REGEX(STR(?y), IF(DATATYPE(?y) = xsd:language, "^[a-zA-Z]{1,8}(-[a-zA-Z0-9]{1,8})*$",
        IF(DATATYPE(?y) IN (xsd:Name, xsd:NCName, xsd:NMTOKEN), "^[a-zA-Z_][a-zA-Z0-9._-]*$",
        "^([^ \\t\\r\\n]+( [^ \\t\\r\\n]+)*)?$"))), CONCAT("string  ", STR(?y)),
    IF(ISNUMERIC(?y), IF(DATATYPE(?y) IN (xsd:float, xsd:double), STR(DATATYPE(?y)), "decimal"),
    IF(DATATYPE(?y) = xsd:boolean && STR(?y) IN ("true", "false", "1", "0"), "boolean",
    IF(DATATYPE(?y) IN (xsd:dateTime, xsd:dateTimeStamp) && COALESCE(YEAR(?y), 0) != 0, "time",
    IF(DATATYPE(?y) = xsd:anyURI, CONCAT("IRI ", STR(?y)),
    IF(DATATYPE(?y) = xsd:hexBinary && REGEX(STR(?y), "^([0-9a-fA-F]{2})*$"), CONCAT("hex ", UCASE(STR(?y))),
    IF(DATATYPE(?y) = xsd:base64Binary && REGEX(REPLACE(STR(?y), " ", ""),
        "^([a-zA-Z0-9+/]{4})*([a-zA-Z0-9+/]{2}[AEIMQUYcgkosw048]=|[a-zA-Z0-9+/][AQgw]==)?$"),
      CONCAT("base64 ", REPLACE(STR(?y), " ", "")),
    1 / 0)))))))))rules";

// FILTERs that pass two literals ?y1 and ?y2 with certainly different values, in one order of the two.
std::string TwoValues() {
  const auto value = [](const char* variable) { return absl::StrReplaceAll(kValue, {{"?y", variable}}); };
  return absl::StrCat(R"rules(
  FILTER(!SAMETERM(?y1, ?y2)) FILTER(ISLITERAL(?y1)) FILTER(ISLITERAL(?y2))
  FILTER(CONCAT(STR(?y1), " ", STR(DATATYPE(?y1)), " ", LANG(?y1)) < CONCAT(STR(?y2), " ", STR(DATATYPE(?y2)), " ", LANG(?y2)))
  FILTER(COALESCE()rules",
                      value("?y1"), " !=", value("?y2"), ", false) || ?y1 != ?y2) }\n");
}

std::string DatatypeRules() {
  return absl::StrCat(
      "\n# Table 8 again: literals that prp-fp and cls-maxc2 would make the same (eq-diff1)\n"
      "RULE rl:dt-diff { } WHERE {\n"
      "  ?p a owl:FunctionalProperty . ?x ?p ?y1 . ?x ?p ?y2",
      TwoValues(),
      "RULE rl:dt-diff { } WHERE {\n"
      "  ?c owl:maxCardinality ?n . ?c owl:onProperty ?p . ?x a ?c . ?x ?p ?y1 . ?x ?p ?y2 FILTER(?n = 1)",
      TwoValues(),
      "# what prp-rng and cls-avf would say of a literal\n"
      "RULE rl:dt-not-type { } WHERE { ?p rdfs:range ?d . ?x ?p ?y",
      kOutside,
      "}\nRULE rl:dt-not-type { } WHERE {\n"
      "  ?c owl:allValuesFrom ?d . ?c owl:onProperty ?p . ?x a ?c . ?x ?p ?y",
      kOutside, "}\n");
}

// Intersections of more classes, from the last one on: ?y docent:inAllFrom ?n if ?y is in the classes of the
// cell ?n and of all later cells.
std::string LongIntersections() {
  std::string text = "\nRULE rl:list { ?l0 docent:longList ?n } WHERE { ?c owl:intersectionOf ?l0 .";
  for (int i = 0; i < kIntersectionClasses; ++i)
    absl::StrAppend(&text, " ?l", i, " rdf:rest ?l", i + 1, " .");
  absl::StrAppend(&text, " ?l0 docent:listNode ?n FILTER(?l", kIntersectionClasses, " != rdf:nil) }", R"rules(
RULE rl:cls-int1 { ?y docent:inAllFrom ?n } WHERE {
  ?l docent:longList ?n . ?n rdf:rest rdf:nil . ?n rdf:first ?c1 . ?y a ?c1 }
RULE rl:cls-int1 { ?y docent:inAllFrom ?n } WHERE {
  ?l docent:longList ?n . ?n rdf:rest ?m . ?n rdf:first ?c1 . ?y a ?c1 . ?y docent:inAllFrom ?m }
RULE rl:cls-int1 { ?y a ?c } WHERE {
  ?c owl:intersectionOf ?l . ?l docent:longList ?l . ?y docent:inAllFrom ?l }
)rules");
  return text;
}

// The rules with a body as long as a list.
std::string ListRules() {
  std::string text = "\n# tables 5 and 6 again: one rule for each length of the list\n";
  for (int n = 2; n <= kChainProperties; ++n) {
    absl::StrAppend(&text, "RULE rl:prp-spo2 { ?u0 ?p ?u", n, " } WHERE { ?p owl:propertyChainAxiom ?l0 .",
                    List("p", n));
    for (int i = 0; i < n; ++i) absl::StrAppend(&text, " ?u", i, " ?p", i + 1, " ?u", i + 1, " .");
    absl::StrAppend(&text, " }\n");
  }
  for (int n = 1; n <= kKeyProperties; ++n) {
    absl::StrAppend(&text, "RULE rl:prp-key { ?x owl:sameAs ?y } WHERE { ?c owl:hasKey ?l0 .", List("p", n),
                    " ?x a ?c . ?y a ?c .");
    for (int i = 1; i <= n; ++i) absl::StrAppend(&text, " ?x ?p", i, " ?z", i, " . ?y ?p", i, " ?z", i, " .");
    absl::StrAppend(&text, " FILTER(?x != ?y) }\n");
  }
  for (int n = 1; n <= kIntersectionClasses; ++n) {
    absl::StrAppend(&text, "RULE rl:cls-int1 { ?y a ?c } WHERE { ?c owl:intersectionOf ?l0 .", List("c", n));
    for (int i = 1; i <= n; ++i) absl::StrAppend(&text, " ?y a ?c", i, " .");
    absl::StrAppend(&text, " }\n");
  }
  return text;
}

}  // namespace

std::string Owl2RlRules() {
  return absl::StrCat(kEquality, kProperties, kClasses, kSchema, DatatypeRules(), ListRules(),
                      LongIntersections());
}

}  // namespace docent::rules
