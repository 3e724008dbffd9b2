// What the simulated guide robot can do: its operations as it describes them, without the functions that do them. Values; any
// thread.
#ifndef DOCENT_ROBOT_ADAPTERS_SIM_GUIDE_OPERATIONS_H_
#define DOCENT_ROBOT_ADAPTERS_SIM_GUIDE_OPERATIONS_H_

#include <string>
#include <vector>

#include "robot_adapters/sdk/operation.h"

namespace docent::robot {

std::vector<Operation> GuideOperations();

// The operations as a table for people. Columns are two blanks apart or more, within them there is one; "-" is nothing.
// scripts/reference reads it.
std::string OperationsTable(const std::vector<Operation>& operations);

}  // namespace docent::robot

#endif  // DOCENT_ROBOT_ADAPTERS_SIM_GUIDE_OPERATIONS_H_
