// Cost warnings for a workflow's conditions: those that are evaluated whole when something changes, and how long that
// takes now. They are accepted, with a warning.
#ifndef DOCENT_KB_SERVER_WORK_CONDITION_COST_H_
#define DOCENT_KB_SERVER_WORK_CONDITION_COST_H_

#include <string>

#include "graph/base/cancellation.h"
#include "graph/base/diagnostic.h"
#include "kb_server/door/ports.h"
#include "reasoner/matching/trigger_analysis.h"
#include "workflow/cawl/check/check.h"

namespace docent::server {

// Why changes do not narrow a query, so that it is evaluated whole; empty: they do.
std::string WhyWhole(const matching::TriggerAnalysis& analysis);

// A warning for each such condition of a correct document, at its place, with its cost as measured on the newest
// version (on the calling thread, for at most 100 ms altogether). `file`: as diagnostics name it. It ends early by `cancellation`.
Diagnostics CostWarnings(const cawl::CheckReport& report, const std::string& file, const ReadPorts& ports,
                         Cancellation* cancellation);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_WORK_CONDITION_COST_H_
