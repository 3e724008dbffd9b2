// Prints runs for people. One thread.
#ifndef DOCENT_KB_SERVER_CLI_RUNS_RUN_PRINTER_H_
#define DOCENT_KB_SERVER_CLI_RUNS_RUN_PRINTER_H_

#include <cstdint>
#include <string>

#include "docent/v1/workflows.pb.h"
#include "kb_server/cli/presenter.h"

namespace docent::server {

// In the zone of this computer; empty for 0.
std::string LocalTime(int64_t time_us, const char* format);

// The state of the run; a live run with a pause is "paused", one with an incident is "incident".
std::string StateOf(const v1::Run& run);

// One run with its variables and nodes.
void PrintRun(const v1::Run& run, const Presenter& presenter);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_CLI_RUNS_RUN_PRINTER_H_
