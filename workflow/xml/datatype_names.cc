#include "workflow/xml/datatype_names.h"

#include <algorithm>

#include "graph/base/text.h"
#include "graph/rdf/vocabulary.h"

namespace docent::xml {

const std::vector<std::string>& SchemaDatatypes() {
  static const auto* const names = new std::vector<std::string>{"ENTITIES",
                                                                "ENTITY",
                                                                "ID",
                                                                "IDREF",
                                                                "IDREFS",
                                                                "NCName",
                                                                "NMTOKEN",
                                                                "NMTOKENS",
                                                                "NOTATION",
                                                                "Name",
                                                                "QName",
                                                                "anyAtomicType",
                                                                "anySimpleType",
                                                                "anyType",
                                                                "anyURI",
                                                                "base64Binary",
                                                                "boolean",
                                                                "byte",
                                                                "date",
                                                                "dateTime",
                                                                "dateTimeStamp",
                                                                "dayTimeDuration",
                                                                "decimal",
                                                                "double",
                                                                "duration",
                                                                "float",
                                                                "gDay",
                                                                "gMonth",
                                                                "gMonthDay",
                                                                "gYear",
                                                                "gYearMonth",
                                                                "hexBinary",
                                                                "int",
                                                                "integer",
                                                                "language",
                                                                "long",
                                                                "negativeInteger",
                                                                "nonNegativeInteger",
                                                                "nonPositiveInteger",
                                                                "normalizedString",
                                                                "positiveInteger",
                                                                "short",
                                                                "string",
                                                                "time",
                                                                "token",
                                                                "unsignedByte",
                                                                "unsignedInt",
                                                                "unsignedLong",
                                                                "unsignedShort",
                                                                "yearMonthDuration"};
  return *names;
}

void CheckDatatype(std::string_view iri, const SourceSpan& span, ElementReader* reader) {
  if (!iri.starts_with(kXsdNs) || reader->full(Diagnostic::Severity::kWarning)) return;
  const std::string name(iri.substr(kXsdNs.size()));
  const std::vector<std::string>& known = SchemaDatatypes();
  if (std::find(known.begin(), known.end(), name) != known.end()) return;
  reader
      ->Warning(span, Concat("XML Schema has no datatype xsd:", name),
                reader->DidYouMean(name, known, "e.g. xsd:string, xsd:integer, xsd:decimal or xsd:dateTime"))
      .rule = "undefined-term";
}

}  // namespace docent::xml
