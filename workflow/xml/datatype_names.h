// Datatypes of XML Schema, by which an unknown name in the namespace xsd: is told from a known one. Functions; any thread.
#ifndef DOCENT_WORKFLOW_XML_DATATYPE_NAMES_H_
#define DOCENT_WORKFLOW_XML_DATATYPE_NAMES_H_

#include <string>
#include <string_view>
#include <vector>

#include "graph/base/diagnostic.h"
#include "workflow/xml/element_reader.h"

namespace docent::xml {

// Local names: "integer", "string" … (XML Schema 1.1 part 2, section 3).
const std::vector<std::string>& SchemaDatatypes();

// Warns, as undefined-term, where `iri` is in the namespace of XML Schema and no datatype of it.
void CheckDatatype(std::string_view iri, const SourceSpan& span, ElementReader* reader);

}  // namespace docent::xml

#endif  // DOCENT_WORKFLOW_XML_DATATYPE_NAMES_H_
