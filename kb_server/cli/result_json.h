// A validation result as JSON, the same in all commands. Pure; any thread.
#ifndef DOCENT_KB_SERVER_CLI_RESULT_JSON_H_
#define DOCENT_KB_SERVER_CLI_RESULT_JSON_H_

#include "nlohmann/json_fwd.hpp"
#include "reasoner/shapes/report.h"

namespace docent::server {

// Places are there where they are known.
nlohmann::json ResultJson(const shapes::ResultText& result);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_CLI_RESULT_JSON_H_
