// An HTTP request and response as plain values, and the small texts of HTTP: percent-encoding, forms, media
// types. Any thread.
#ifndef DOCENT_KB_SERVER_WORK_HTTP_MESSAGE_H_
#define DOCENT_KB_SERVER_WORK_HTTP_MESSAGE_H_

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "graph/base/limits.h"

namespace docent::server {

using HttpFields = std::vector<std::pair<std::string, std::string>>;

struct HttpRequest {
  std::string method;     // "GET", "POST", …
  std::string path;       // decoded, without the query: "/sparql"
  std::string raw_path;   // as it was sent
  HttpFields parameters;  // of the query string, decoded, in order
  HttpFields headers;     // names in lower case, in order
  std::string body;

  // The value of header `name` (lower case); several are joined by ", ". Empty: not there.
  std::string Header(std::string_view name) const;
};

struct HttpResponse {
  int status = 200;
  std::string content_type = "text/plain; charset=utf-8";
  std::string body;
  HttpFields headers;  // further ones
};

// A plain-text response: `text` ends with a line break.
HttpResponse TextResponse(int status, std::string text);

// 400 for a parameter that is nearly one of `known` (asof, as-of): it was meant, and would be passed over. nullopt for one
// of another name, which clients may send for others.
std::optional<HttpResponse> MisspeltParameter(const std::string& name, const std::vector<std::string>& known);

// The HTTP status that fits a status code (INVALID_ARGUMENT 400, NOT_FOUND 404, RESOURCE_EXHAUSTED 413 for a limit of the
// request itself and 503 for an overload, DEADLINE_EXCEEDED 504, …), its message as the text.
HttpResponse ErrorResponse(const absl::Status& status);

// "%41+b" → "A b" where `plus_is_space`; nullopt for a broken escape or an escape of U+0000.
std::optional<std::string> PercentDecode(std::string_view text, bool plus_is_space);

// "a=1&b=%20" (application/x-www-form-urlencoded, a query string) → pairs in order. INVALID_ARGUMENT for a broken
// escape, and for more pairs than `limit`.
absl::StatusOr<HttpFields> ParseForm(std::string_view text, size_t limit = Limits{}.http_parameters);

// "text/turtle; charset=UTF-8" → "text/turtle", in lower case.
std::string MediaTypeOnly(std::string_view content_type);

// "text/turtle; charset=\"UTF-8\"" → "utf-8"; empty: none is given.
std::string CharsetOf(std::string_view content_type);

// 415 for "…; charset=UTF-16" and the like: SPARQL (protocol, section 2.1.3) and the RDF formats are UTF-8. nullopt: go on.
std::optional<HttpResponse> RefuseCharset(std::string_view content_type);

// Which of `offered` (media types without parameters, best first) a client wants that sent `accept` (RFC 9110
// section 12.5.1: quality values; a more specific range wins over a wildcard; equal quality: the first
// offered). An empty `accept` takes anything. nullopt: none of them.
std::optional<size_t> ChooseMediaType(std::string_view accept, const std::vector<std::string_view>& offered);

// "host:port", "[v6]:port" or a host alone → host (without brackets, lower case) and port. nullopt: not of
// that form.
struct HostAndPort {
  std::string host;
  std::optional<uint16_t> port;
};
std::optional<HostAndPort> SplitHostAndPort(std::string_view text);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_WORK_HTTP_MESSAGE_H_
