#include "robot_adapters/sim/commands.h"

#include <iostream>

namespace docent::robot {

int Fail(const absl::Status& status) {
  std::cerr << "docent-robot: " << status.message() << "\n";
  return kExitBad;
}

}  // namespace docent::robot
