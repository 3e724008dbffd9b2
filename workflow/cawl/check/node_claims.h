// What a node takes for itself while it is active, as far as its text says: robots that it commands, variables that it sets. Pure
// functions; any thread.
#ifndef DOCENT_WORKFLOW_CAWL_CHECK_NODE_CLAIMS_H_
#define DOCENT_WORKFLOW_CAWL_CHECK_NODE_CLAIMS_H_

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "workflow/cawl/ast.h"

namespace docent::cawl {

inline constexpr char kRobot[] = "robot";

using Names = std::set<std::string>;

bool Declares(const std::vector<Variable>& variables, const std::string& name);

// What the node's own condition binds.
Names Bound(const Node& node);

// The robot that an invoke names, as it is written: "expo:R1", "$guide"; empty: that of the run. `uses`: its variables.
std::string RobotOf(const Invoke& invoke, Names* uses);

bool Meet(const Names& a, const Names& b);

// How a node sets a variable.
struct Setting {
  std::optional<Term> constant = {};  // always to this
  bool counts_on = false;             // from its own value: $n + 1
};

// Two that leave the variable as it is wanted, in whichever order they come.
bool Agree(const Setting& a, const Setting& b);

// By the name of the variable, or "name.part": those of ext:assign and ext:output, without the node's own variables.
std::map<std::string, Setting> SettingsOf(const Node& node);

}  // namespace docent::cawl

#endif  // DOCENT_WORKFLOW_CAWL_CHECK_NODE_CLAIMS_H_
