// One HTTP/1.1 request to another server, http or https (certificates are checked), and its whole answer.
// Blocks; never call it on a network thread or the writer's. Any thread.
#ifndef DOCENT_KB_SERVER_WORK_HTTP_FETCH_H_
#define DOCENT_KB_SERVER_WORK_HTTP_FETCH_H_

#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "graph/base/cancellation.h"
#include "kb_server/work/http_message.h"

namespace docent::server {

// "https://host:8443/a?b" → its parts. nullopt: not an http or https URL, or one with a user name in it.
struct HttpUrl {
  bool tls = false;
  std::string host;  // lower case; of IPv6 without brackets
  std::string port;
  std::string target;  // path and query, "/" at least; a fragment is dropped
};
std::optional<HttpUrl> ParseHttpUrl(std::string_view url);

// What an answer says in Retry-After (RFC 9110, section 10.2.3): seconds, or a date. `headers`: names in lower case.
std::optional<absl::Duration> RetryAfterOf(const HttpFields& headers, absl::Time now);

struct FetchRequest {
  std::string method = "GET";
  std::string url;
  HttpFields headers;
  std::string body;
  std::chrono::milliseconds timeout{30000};  // for all of it
  size_t max_bytes = 0;                      // of the answer's body
  bool reads_body = true;                    // false: status and headers are all that counts, and end it
  // Told of each piece of the answer's body, in bytes, also of one that leads elsewhere: its error ends it. Null: none.
  std::function<absl::Status(size_t more)> count;
  bool half_time = false;  // no longer than half of the time that the cancellation leaves
};

// The answer, whatever its status. INVALID_ARGUMENT (the URL), UNAVAILABLE (no such host, refused, cut off, a
// bad certificate), DEADLINE_EXCEEDED, CANCELLED (looked at several times a second), RESOURCE_EXHAUSTED
// beyond `max_bytes`, the error of `count`.
absl::StatusOr<HttpResponse> Fetch(const FetchRequest& request, Cancellation* cancellation);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_WORK_HTTP_FETCH_H_
