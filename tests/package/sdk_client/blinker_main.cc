// A robot that blinks, as in the SDK's header: uses every public header and library.
#include <iostream>
#include <string>

#include "docent/v1/robot_adapter.grpc.pb.h"
#include "graph/rdf/vocabulary.h"
#include "graph/wire/term_proto.h"
#include "robot_adapters/sdk/decimal.h"
#include "robot_adapters/sdk/robot_adapter.h"

int main() {
  docent::robot::AdapterOptions options;
  options.robot = "https://w3id.org/docent/expo#R07";
  docent::robot::Operation blink;
  blink.name = "blink";
  blink.inputs = {"times"};
  blink.run = [](docent::robot::OperationContext& context) -> absl::StatusOr<docent::robot::NamedTerms> {
    absl::StatusOr<docent::Term> times = context.Argument("times");
    if (!times.ok()) return times.status();
    for (int i = 0, n = std::stoi(times->lexical); i < n; ++i) {
      if (!context.SleepFor(std::chrono::milliseconds(1))) return absl::CancelledError("stopped");
    }
    return docent::robot::NamedTerms{};
  };
  auto adapter = docent::robot::RobotAdapter::Start(options, {blink});
  if (!adapter.ok()) {
    std::cerr << adapter.status() << "\n";
    return 2;
  }
  (*adapter)->SetState(docent::DocentIri("battery"), docent::Term::Integer(87));
  std::cout << "listening " << (*adapter)->address() << std::endl;
  std::cin.get();
  return 0;
}
