// RSEL generator: from the operations that robots describe, a document that a person starts from. Any thread.
#ifndef DOCENT_WORKFLOW_RSEL_GENERATOR_H_
#define DOCENT_WORKFLOW_RSEL_GENERATOR_H_

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "workflow/rsel/feasibility.h"

namespace docent::rsel {

struct GeneratorRequest {
  std::string name;     // of the document
  std::string process;  // of its one process; empty: as the document
  std::vector<std::string>
      operations;  // in order, also registered services; empty: a process for each described operation
  RobotId robot;   // only what this robot describes; empty: any robot
};

// The document: messages with types, and processes whose parts are mapped. It parses without errors, runs as it is, and has the
// layout of `docent fmt`.
//
// In a process of several operations, an input is the result of an earlier one if that has the same name and may be of its
// type; otherwise it is a part of the input message, one for all operations that take it. A part whose name stands for
// something of another type gets the name of its operation in front. Each result is a part of the output message.
//
// INVALID_ARGUMENT: a name that cannot stand in a document. NOT_FOUND: an operation that `offered` (of the robot) and
// `registry` do not have, with the nearest; nothing is described.
absl::StatusOr<std::string> GenerateDocument(const GeneratorRequest& request,
                                             const std::vector<OfferedOperation>& offered,
                                             const ServiceRegistry& registry);

// A document with one process for each operation: GenerateDocument without operations. Operations whose names cannot stand in a
// document are named in a <documentation> instead.
std::string GenerateRsel(const std::string& name, const std::vector<OfferedOperation>& operations);

}  // namespace docent::rsel

#endif  // DOCENT_WORKFLOW_RSEL_GENERATOR_H_
