// multipart/form-data (RFC 7578): a body of several files. Pure function.
#ifndef DOCENT_KB_SERVER_HTTP_HTTP_MULTIPART_H_
#define DOCENT_KB_SERVER_HTTP_HTTP_MULTIPART_H_

#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "graph/base/limits.h"

namespace docent::server {

struct HttpPart {
  std::string content_type;  // as sent; empty: none
  std::string file;          // its name; empty: none
  std::string_view body;     // points into the whole
};

// The parts of `body`, whose boundary stands in `content_type`. INVALID_ARGUMENT where there is no boundary or no end,
// and for more parts than `limit`. Lines may end with LF alone.
absl::StatusOr<std::vector<HttpPart>> ParseMultipart(std::string_view content_type, std::string_view body,
                                                     size_t limit = Limits{}.http_parameters);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_HTTP_HTTP_MULTIPART_H_
