#include "reasoner/ontology/standard_words.h"

#include "absl/strings/str_split.h"
#include "graph/base/text.h"
#include "graph/rdf/vocabulary.h"

namespace docent::ontology {
namespace {

struct Table {
  std::string_view name_space;
  StandardKind kind;
  std::string_view words;
};
// RDF 1.1 Schema; OWL 2 Structural Specification and RDF mapping (table 3 and section 3); XML Schema part 2.
constexpr Table kTables[] = {
    {kRdfNs, StandardKind::kClass, "Property Statement Bag Seq Alt List CompoundLiteral"},
    {kRdfNs, StandardKind::kProperty, "type subject predicate object value first rest language direction"},
    {kRdfNs, StandardKind::kDatatype, "langString HTML XMLLiteral PlainLiteral JSON"},
    {kRdfNs, StandardKind::kOther, "nil RDF Description"},
    {kRdfsNs, StandardKind::kClass, "Resource Class Container ContainerMembershipProperty Datatype"},
    {kRdfsNs, StandardKind::kDatatype, "Literal"},
    {kRdfsNs, StandardKind::kProperty,
     "subClassOf subPropertyOf domain range label comment member seeAlso isDefinedBy"},
    {kOwlNs, StandardKind::kClass,
     "AllDifferent AllDisjointClasses AllDisjointProperties Annotation AnnotationProperty AsymmetricProperty "
     "Axiom Class "
     "DataRange DatatypeProperty DeprecatedClass DeprecatedProperty FunctionalProperty "
     "InverseFunctionalProperty "
     "IrreflexiveProperty NamedIndividual NegativePropertyAssertion Nothing ObjectProperty Ontology "
     "OntologyProperty "
     "ReflexiveProperty Restriction SymmetricProperty Thing TransitiveProperty"},
    {kOwlNs, StandardKind::kProperty,
     "allValuesFrom annotatedProperty annotatedSource annotatedTarget assertionProperty "
     "backwardCompatibleWith "
     "bottomDataProperty bottomObjectProperty cardinality complementOf datatypeComplementOf deprecated "
     "differentFrom "
     "disjointUnionOf disjointWith distinctMembers equivalentClass equivalentProperty hasKey hasSelf "
     "hasValue imports "
     "incompatibleWith intersectionOf inverseOf maxCardinality maxQualifiedCardinality members "
     "minCardinality "
     "minQualifiedCardinality onClass onDataRange onDatatype onProperties onProperty oneOf priorVersion "
     "propertyChainAxiom propertyDisjointWith qualifiedCardinality sameAs someValuesFrom sourceIndividual "
     "targetIndividual "
     "targetValue topDataProperty topObjectProperty unionOf versionIRI versionInfo withRestrictions"},
    {kOwlNs, StandardKind::kDatatype, "real rational"},
    {kXsdNs, StandardKind::kDatatype,
     "anyAtomicType anySimpleType anyType anyURI base64Binary boolean byte date dateTime dateTimeStamp "
     "dayTimeDuration "
     "decimal double duration float gDay gMonth gMonthDay gYear gYearMonth hexBinary int integer language "
     "long Name NCName "
     "negativeInteger NMTOKEN nonNegativeInteger nonPositiveInteger normalizedString positiveInteger QName "
     "short string time "
     "token unsignedByte unsignedInt unsignedLong unsignedShort yearMonthDuration"},
    {kXsdNs, StandardKind::kProperty,
     "length minLength maxLength pattern langRange minInclusive minExclusive maxInclusive maxExclusive "
     "totalDigits "
     "fractionDigits whiteSpace"},
};

}  // namespace

const std::vector<StandardWord>& StandardWords() {
  static const std::vector<StandardWord>* words = [] {
    auto* out = new std::vector<StandardWord>;
    for (const Table& table : kTables) {
      for (const absl::string_view word : absl::StrSplit(ToAbsl(table.words), ' ')) {
        out->push_back({table.name_space, FromAbsl(word), table.kind});
      }
    }
    return out;
  }();
  return *words;
}

}  // namespace docent::ontology
