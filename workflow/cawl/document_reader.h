// The element tree of a CAWL document → its syntax tree: which element may stand where, which attributes it has,
// names, words and expressions. What needs more than one place of the document is the business of structure_checks.h.
#ifndef DOCENT_WORKFLOW_CAWL_DOCUMENT_READER_H_
#define DOCENT_WORKFLOW_CAWL_DOCUMENT_READER_H_

#include "graph/base/limits.h"
#include "workflow/cawl/ast.h"
#include "workflow/xml/element_reader.h"

namespace docent::cawl {

// Fills `document` (whose file and source are set) from `root`. Mistakes go to `reader`. False: the root is not CAWL.
bool ReadDocument(const xml::Element& root, const Limits& limits, xml::ElementReader* reader,
                  Document* document);

}  // namespace docent::cawl

#endif  // DOCENT_WORKFLOW_CAWL_DOCUMENT_READER_H_
