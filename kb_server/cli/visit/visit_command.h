// docent visit: what is printed for the visitors' page of the browser app.
#ifndef DOCENT_KB_SERVER_CLI_VISIT_VISIT_COMMAND_H_
#define DOCENT_KB_SERVER_CLI_VISIT_VISIT_COMMAND_H_

#include "CLI/App.hpp"

namespace docent::server {

// `docent visit qr`: the codes that hang at booths.
void AddVisitCommand(CLI::App* app, int* exit_code);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_CLI_VISIT_VISIT_COMMAND_H_
