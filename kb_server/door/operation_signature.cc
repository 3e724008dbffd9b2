#include "kb_server/door/operation_signature.h"

namespace docent::server {

cawl::OperationSignature SignatureOf(const rsel::Plan& plan, const rsel::ServiceRegistry& registry) {
  cawl::OperationSignature out;
  out.name = plan.process;
  out.inputs = plan.inputs;
  for (const auto& [part, source] : plan.outputs) out.outputs.push_back(part);
  for (const rsel::PlanStep& step : plan.steps) {
    if (step.timeout_ms && (!out.longest_step || *step.timeout_ms > out.longest_step->timeout_ms))
      out.longest_step = {step.operation, *step.timeout_ms};
  }
  for (const rsel::DocumentPtr& document : registry.Documents()) {
    if (document->name.value != plan.document) continue;
    const rsel::Process* process = document->FindProcess(plan.process);
    const rsel::Message* message = process != nullptr ? document->FindMessage(process->input.value) : nullptr;
    if (message == nullptr) continue;
    for (const rsel::Part& part : message->parts) {
      if (part.type_term && part.type_term->IsIri())
        out.input_types[part.name.value] = part.type_term->lexical;
    }
  }
  return out;
}

}  // namespace docent::server
