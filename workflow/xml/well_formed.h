// Well-formedness check of XML texts by libxml2, with places. Any thread.
#ifndef DOCENT_WORKFLOW_XML_WELL_FORMED_H_
#define DOCENT_WORKFLOW_XML_WELL_FORMED_H_

#include <string>
#include <string_view>

#include "graph/base/diagnostic.h"
#include "graph/base/limits.h"

namespace docent::xml {

// Nothing when the text is well-formed UTF-8 XML without a document type definition, within the limits on nesting.
Diagnostics CheckWellFormed(std::string_view text, const std::string& file, const Limits& limits);

}  // namespace docent::xml

#endif  // DOCENT_WORKFLOW_XML_WELL_FORMED_H_
