#include "kb_server/door/operation_signature.h"

namespace docent::server {

cawl::OperationSignature SignatureOf(const rsel::Plan& plan) {
  cawl::OperationSignature out;
  out.name = plan.process;
  out.inputs = plan.inputs;
  for (const auto& [part, source] : plan.outputs) out.outputs.push_back(part);
  for (const rsel::PlanStep& step : plan.steps) {
    if (step.timeout_ms && (!out.longest_step || *step.timeout_ms > out.longest_step->timeout_ms))
      out.longest_step = {step.operation, *step.timeout_ms};
  }
  out.input_types = plan.input_types;
  return out;
}

}  // namespace docent::server
