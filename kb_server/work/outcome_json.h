// What a write did, as the JSON that HTTP clients get. Pure; any thread.
#ifndef DOCENT_KB_SERVER_WORK_OUTCOME_JSON_H_
#define DOCENT_KB_SERVER_WORK_OUTCOME_JSON_H_

#include <string>

#include "kb_server/door/inbox.h"

namespace docent::server {

// An object on one line: revision, added, removed, inferred, repeated, and the texts of warnings, if there are any.
std::string OutcomeJson(const BatchOutcome& outcome);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_WORK_OUTCOME_JSON_H_
