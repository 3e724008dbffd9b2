// Reads how an activator counts its runs: ext:mode and ext:max. Private to this folder. Function without state.
#ifndef DOCENT_WORKFLOW_CAWL_MODE_READER_H_
#define DOCENT_WORKFLOW_CAWL_MODE_READER_H_

#include "workflow/cawl/ast.h"
#include "workflow/xml/element_reader.h"

namespace docent::cawl {

// What is wrong is reported; an ext:max that the mode does not look at is a warning.
void ReadMode(const xml::Element& element, xml::ElementReader* reader, Activator* activator);

}  // namespace docent::cawl

#endif  // DOCENT_WORKFLOW_CAWL_MODE_READER_H_
