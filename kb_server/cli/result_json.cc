#include "kb_server/cli/result_json.h"

#include "nlohmann/json.hpp"

namespace docent::server {

nlohmann::json ResultJson(const shapes::ResultText& r) {
  nlohmann::json object = {{"severity", r.severity}, {"focus", r.focus},    {"path", r.path},
                           {"value", r.value},       {"shape", r.shape},    {"constraint", r.component},
                           {"message", r.message},   {"details", r.details}};
  if (!r.file.empty()) {
    object["file"] = r.file;
    object["line"] = r.line;
    object["column"] = r.column;
  }
  if (!r.shape_file.empty()) {
    object["shape_file"] = r.shape_file;
    object["shape_line"] = r.shape_line;
    object["shape_column"] = r.shape_column;
  }
  return object;
}

}  // namespace docent::server
