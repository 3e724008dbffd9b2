// Any bytes as an RSEL document: sound diagnostics, or plans whose runs end.
#include <cstddef>
#include <cstdint>

#include "tests/fuzz/fuzz_check.h"
#include "workflow/rsel/instruction_handler.h"
#include "workflow/rsel/parser.h"
#include "workflow/rsel/type_checks.h"

namespace {

// Each step once, every third attempt failing.
void RunToTheEnd(const docent::rsel::PlanPtr& plan) {
  using namespace docent;
  rsel::Arguments arguments;
  for (const std::string& input : plan->inputs) arguments[input] = Term::Iri("urn:x");
  absl::StatusOr<rsel::InstructionHandler> handler = rsel::InstructionHandler::Start(plan, arguments);
  fuzz::Require(handler.ok(), "a plan that cannot start");
  size_t attempts = 0, most = 0;
  for (const rsel::PlanStep& step : plan->steps) most += 1 + static_cast<size_t>(step.retry);
  while (!handler->ended()) {
    std::vector<rsel::Instruction> ready = handler->TakeReady();
    fuzz::Require(handler->ended() || !ready.empty(), "a run that waits for nothing");
    for (const rsel::Instruction& i : ready) {
      fuzz::Require(++attempts <= most, "more attempts than the plan allows");
      if (attempts % 3 == 0) {
        handler->Failed(i.step, i.attempt, "x");
      } else {
        handler->Succeeded(i.step, i.attempt, {});
      }
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace docent;
  std::string_view text(reinterpret_cast<const char*>(data), size);
  rsel::ParsedRsel parsed = rsel::ParseRsel(text, "f");
  fuzz::RequireSound(parsed.diagnostics, text);
  fuzz::RequireSoundFixes(parsed.diagnostics, text);
  fuzz::Require(parsed.document != nullptr || HasErrors(parsed.diagnostics), "refused without a word");
  if (!parsed.ok()) return 0;
  rsel::ServiceRegistry registry;
  Diagnostics diagnostics = registry.Put(parsed.document);
  fuzz::RequireSound(diagnostics, text);
  fuzz::Require(HasErrors(diagnostics) || registry.Plans().size() == parsed.document->processes.size(),
                "a process without plan");
  if (HasErrors(diagnostics)) return 0;
  fuzz::RequireSound(rsel::CheckTypes(*parsed.document, registry, {}), text);
  for (const rsel::PlanPtr& plan : registry.Plans()) RunToTheEnd(plan);
  return 0;
}
