#include "kb_server/work/outcome_json.h"

#include <nlohmann/json.hpp>

#include "graph/base/text.h"

namespace docent::server {

std::string OutcomeJson(const BatchOutcome& outcome) {
  nlohmann::ordered_json json = {{"revision", outcome.offset},
                                 {"added", outcome.added},
                                 {"removed", outcome.removed},
                                 {"inferred", outcome.inferred},
                                 {"repeated", outcome.repeated}};
  for (const Diagnostic& warning : outcome.warnings) {
    json["warnings"].push_back(warning.hint.empty() ? warning.message
                                                    : Concat(warning.message, "; ", warning.hint));
  }
  return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace docent::server
