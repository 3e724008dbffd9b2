// docent query --engine rasqal: one query by Redland's engine on a copy of a server's graph.
#ifndef DOCENT_KB_SERVER_CLI_QUERY_WITH_RASQAL_H_
#define DOCENT_KB_SERVER_CLI_QUERY_WITH_RASQAL_H_

#include <cstdint>
#include <string>

#include "kb_server/cli/presenter.h"

namespace docent::server {

// Copies the graph of the server at `address` (one revision, at most `rasqal_quads`), runs the query on it in
// this process, so that Rasqal cannot harm the server, and prints the answer. `timeout_ms`: of Rasqal's part;
// 0: query_timeout_ms. The process ends with the limit's name where Rasqal does not end by itself soon after.
// The exit code (client.h).
int QueryWithRasqal(const std::string& query, const std::string& address, const std::string& format,
                    const Presenter& presenter, uint32_t timeout_ms);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_CLI_QUERY_WITH_RASQAL_H_
