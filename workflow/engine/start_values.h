// Values that a run has to have from its beginning on. Private to this folder.
#ifndef DOCENT_WORKFLOW_ENGINE_START_VALUES_H_
#define DOCENT_WORKFLOW_ENGINE_START_VALUES_H_

#include <string>
#include <vector>

#include "workflow/engine/engine_core.h"

namespace docent::engine {

// Variables ("user" or "request.booth") with ext:required that the flow sees and that have no value, in order of the document.
std::vector<std::string> RequiredWithoutValue(const cawl::Document& document, const cawl::Flow& flow,
                                              const TermBinding& values);

// Of a start on request: these, and what the flow's activator would give with a match, nothing in the flow gives, and some node
// cannot do without: to tell it, or as an input of what it invokes.
std::vector<std::string> NeededWithoutValue(const Engine::Core& core, const cawl::Document& document,
                                            const cawl::Flow& flow, const TermBinding& values,
                                            const RobotDirectory& robots);

// "a run of flow F needs a value of $user and $place".
std::string NeedsText(const cawl::Flow& flow, const std::vector<std::string>& names);

}  // namespace docent::engine

#endif  // DOCENT_WORKFLOW_ENGINE_START_VALUES_H_
