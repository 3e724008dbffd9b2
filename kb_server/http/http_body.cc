#include "kb_server/http/http_body.h"

#include "absl/status/statusor.h"
#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "graph/base/gzip.h"
#include "graph/base/overload.h"
#include "graph/base/text.h"

namespace docent::server {
namespace {

bool IsGzipCoding(std::string_view coding) {
  return absl::EqualsIgnoreCase(ToAbsl(coding), "gzip") || absl::EqualsIgnoreCase(ToAbsl(coding), "x-gzip");
}

}  // namespace

std::optional<HttpResponse> RefuseEncoding(std::string_view content_encoding) {
  const absl::string_view coding = absl::StripAsciiWhitespace(ToAbsl(content_encoding));
  if (coding.empty() || IsGzipCoding(FromAbsl(coding)) || absl::EqualsIgnoreCase(coding, "identity"))
    return std::nullopt;
  HttpResponse refusal = TextResponse(415, absl::StrCat("a Content-Encoding of ", coding,
                                                        " is not read; send the body as it is, or as gzip"));
  refusal.headers.emplace_back("Accept-Encoding", "gzip, identity");
  return refusal;
}

bool IsPacked(const HttpRequest& http) {
  const std::string given = http.Header("content-encoding");
  return IsGzipCoding(FromAbsl(absl::StripAsciiWhitespace(given)));
}

void UnpackBody(const HttpRequest& http, size_t most_bytes, std::string_view limit_name, MemoryUse* memory,
                Cancellation* cancellation, HttpBody* body) {
  body->text = http.body;
  if (!IsPacked(http)) return;
  absl::StatusOr<std::string> unpacked = Gunzip(http.body, most_bytes, limit_name, memory, cancellation);
  if (!unpacked.ok()) {
    body->refusal = ErrorResponse(
        WithMessage(unpacked.status(), absl::StrCat("the body: ", unpacked.status().message())));
    return;
  }
  body->unpacked = *std::move(unpacked);
  body->text = body->unpacked;
}

}  // namespace docent::server
