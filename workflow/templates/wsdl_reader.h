// Reader of WSDL 1.1 documents (W3C Note, 15 March 2001): their operations as node templates. Pure function; any thread.
#ifndef DOCENT_WORKFLOW_TEMPLATES_WSDL_READER_H_
#define DOCENT_WORKFLOW_TEMPLATES_WSDL_READER_H_

#include <string>
#include <string_view>

#include "graph/base/limits.h"
#include "workflow/templates/node_template.h"

namespace docent::templates {

// One template for each operation of each port type, in the order of the text, at most import_templates. The parts of a message
// become parts; where one is an element (document style), the elements and attributes inside of it do. Types are the
// datatypes of XML Schema, found through simple types; a complex type is named as NAMESPACE#NAME. The endpoint is the address
// of the first port of a service with a binding of the port type.
//
// Nothing else is fetched: what the document imports or includes is named in a warning, and so is what it does not define.
// Errors with places: what xml::ParseXml refuses; a root element that is not that of WSDL 1.1.
ImportedTemplates ReadWsdl(std::string_view text, const std::string& file, const Limits& limits = {});

}  // namespace docent::templates

#endif  // DOCENT_WORKFLOW_TEMPLATES_WSDL_READER_H_
