// The body of a request as it was before it was packed (Content-Encoding, RFC 9110 section 8.4). Pure functions.
#ifndef DOCENT_KB_SERVER_HTTP_HTTP_BODY_H_
#define DOCENT_KB_SERVER_HTTP_HTTP_BODY_H_

#include <optional>
#include <string>
#include <string_view>

#include "graph/base/cancellation.h"
#include "graph/base/memory_budget.h"
#include "kb_server/work/http_message.h"

namespace docent::server {

// 415 for a coding that is not read: all but gzip and identity. nullopt: go on.
std::optional<HttpResponse> RefuseEncoding(std::string_view content_encoding);

struct HttpBody {
  std::optional<HttpResponse>
      refusal;            // 400: it is damaged; 413: unpacked it exceeds the limit; 503: no room for it now
  std::string_view text;  // of the request, or of `unpacked`
  std::string unpacked;
};
// Fills *body for a request that RefuseEncoding let pass. Unpacking takes time: for a worker, where IsPacked. `memory`: of
// the request, which counts what is unpacked until it ends; null: it is not counted.
// `cancellation`, if there is one, ends it.
void UnpackBody(const HttpRequest& http, size_t most_bytes, std::string_view limit_name, MemoryUse* memory,
                Cancellation* cancellation, HttpBody* body);
bool IsPacked(const HttpRequest& http);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_HTTP_HTTP_BODY_H_
