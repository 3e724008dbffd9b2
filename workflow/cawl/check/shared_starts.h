// Activators of two workflows that start on one occasion: each starts a run for it, and robots serve it twice. Any thread.
#ifndef DOCENT_WORKFLOW_CAWL_CHECK_SHARED_STARTS_H_
#define DOCENT_WORKFLOW_CAWL_CHECK_SHARED_STARTS_H_

#include <vector>

#include "graph/base/cancellation.h"
#include "workflow/cawl/ast.h"
#include "workflow/xml/element_reader.h"

namespace docent::cawl {

// Beyond, further workflows are not compared with the document: steps of comparing one constraint with another.
inline constexpr size_t kMaxSharedStartSteps = 200'000;

// A warning for each workflow of `beside` that also starts on a wish (docent:chose), on an event, or in a situation on which
// the document's activator starts, unless their conditions exclude each other as far as their texts say. Those of the
// document's own name are left out: it takes their place. `cancellation`: ends it early; null: nothing does.
void CheckSharedStarts(const Document& document, const std::vector<DocumentPtr>& beside,
                       xml::ElementReader* reader, Cancellation* cancellation = nullptr);

}  // namespace docent::cawl

#endif  // DOCENT_WORKFLOW_CAWL_CHECK_SHARED_STARTS_H_
