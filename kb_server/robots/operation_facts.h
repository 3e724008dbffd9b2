// What a robot says of an operation that it offers, read from the robot's own graph: other robots may do an operation of that name
// otherwise. The reading side of the operations in robot_facts.h. Values; any thread.
#ifndef DOCENT_KB_SERVER_ROBOTS_OPERATION_FACTS_H_
#define DOCENT_KB_SERVER_ROBOTS_OPERATION_FACTS_H_

#include <optional>
#include <string>
#include <vector>

#include "graph/store/graph_reader.h"
#include "workflow/engine/state/ports.h"
#include "workflow/rsel/part_types.h"

namespace docent::server {

class OperationFacts {
 public:
  // `graph` reads all graphs and must outlive this; `robot` and `operation` are IRIs.
  OperationFacts(const GraphReader& graph, const std::string& robot, std::string operation);

  std::vector<std::string> Capabilities() const;           // IRIs of classes
  std::optional<std::vector<std::string>> Inputs() const;  // nullopt: it does not say which it takes
  std::vector<std::string> Outputs() const;
  rsel::PartTypes InputTypes() const;
  rsel::PartTypes OutputTypes() const;
  engine::Occupation Occupies() const;
  std::string Description() const;
  // Of a robot that does not say it, what others tell, where they agree.
  bool Idempotent() const;

 private:
  std::vector<std::string> All(std::string_view local) const;
  rsel::PartTypes Types(std::string_view local) const;

  const GraphReader& graph_;
  const GraphReader own_;
  const std::string operation_;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_ROBOTS_OPERATION_FACTS_H_
