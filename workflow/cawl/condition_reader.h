// <condition> and what stands in it: the part of document_reader.h that is about context. Any thread.
#ifndef DOCENT_WORKFLOW_CAWL_CONDITION_READER_H_
#define DOCENT_WORKFLOW_CAWL_CONDITION_READER_H_

#include <functional>
#include <string_view>
#include <utility>
#include <vector>

#include "kb_server/base/limits.h"
#include "workflow/cawl/ast.h"
#include "workflow/xml/element_reader.h"

namespace docent::cawl {

Condition ReadCondition(const xml::Element& element, const Limits& limits, xml::ElementReader* reader);

// Calls the function of each child's name. An unknown child is reported; <documentation> may stand anywhere; text
// beside the children is reported.
using ChildTable = std::vector<std::pair<std::string_view, std::function<void(const xml::Element&)>>>;
void ReadChildren(const xml::Element& element, xml::ElementReader* reader, const ChildTable& table);

}  // namespace docent::cawl

#endif  // DOCENT_WORKFLOW_CAWL_CONDITION_READER_H_
