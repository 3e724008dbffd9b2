// The RSEL generator: from what robots can do, the document that a person starts from. Any thread.
#ifndef DOCENT_WORKFLOW_RSEL_GENERATOR_H_
#define DOCENT_WORKFLOW_RSEL_GENERATOR_H_

#include <string>
#include <vector>

#include "workflow/rsel/feasibility.h"

namespace docent::rsel {

// A document with one message and one process for each operation (each name once; of two robots' operations of the
// same name the first stands), in order of their names. It parses without errors and runs as it is.
// `name` is the document's name.
std::string GenerateRsel(const std::string& name, const std::vector<OfferedOperation>& operations);

}  // namespace docent::rsel

#endif  // DOCENT_WORKFLOW_RSEL_GENERATOR_H_
