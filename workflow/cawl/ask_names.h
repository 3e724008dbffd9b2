// Whether two compiled conditions ask the same under other names. Functions without state; any thread.
#ifndef DOCENT_WORKFLOW_CAWL_ASK_NAMES_H_
#define DOCENT_WORKFLOW_CAWL_ASK_NAMES_H_

#include <map>
#include <string>

#include "workflow/cawl/ask_compiler.h"

namespace docent::cawl {

// A variable's name in one condition → its name in another, each name once on either side.
using NameMap = std::map<std::string, std::string>;

// The other name; the name itself where there is none.
const std::string& NameIn(const NameMap& names, const std::string& name);

// Whether two alternatives hold for the same reasons, whatever they and their variables are called. `names`: what the variables of
// `a` are called in `b`; what it has already counts, and the variables of these two are added.
bool AskTheSame(const CompiledAsk& a, const CompiledAsk& b, NameMap* names);

}  // namespace docent::cawl

#endif  // DOCENT_WORKFLOW_CAWL_ASK_NAMES_H_
