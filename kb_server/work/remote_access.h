// Access to other servers, by an allow-list: SERVICE asks SPARQL endpoints, LOAD reads
// documents. Only addresses on the allow-list are reached, by default none, so that a query cannot make the
// server touch what its sender could not. Redirects are followed to such addresses, too. Thread-safe.
#ifndef DOCENT_KB_SERVER_WORK_REMOTE_ACCESS_H_
#define DOCENT_KB_SERVER_WORK_REMOTE_ACCESS_H_

#include <chrono>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "graph/base/cancellation.h"
#include "graph/base/limits.h"
#include "graph/rdf/term.h"
#include "graph/sparql/run/federation.h"
#include "kb_server/work/http_fetch.h"

namespace docent::server {

class RemoteAccess final : public sparql::ServiceClient {
 public:
  // Who fetches on a worker gives its place up meanwhile. `allowed`: "http://host:port/path", "https://…" or "file:///folder":
  // that address and all below it (whole path segments). See CheckAllowed.
  RemoteAccess(std::vector<std::string> allowed, const Limits& limits)
      : allowed_(std::move(allowed)), limits_(limits) {}

  // INVALID_ARGUMENT for an entry that is not of one of these forms.
  static absl::Status CheckAllowed(const std::string& entry);
  // Whether the list has `url`, or something above it. Scheme, host and port must be the same; a path with
  // ".." or
  // %-escapes of '.' or '/' is never on it.
  bool IsAllowed(std::string_view url) const;
  bool allows_any() const { return !allowed_.empty(); }

  // For SERVICE: POST of the query, answer in SPARQL JSON or XML.
  absl::StatusOr<sparql::ServiceAnswer> Select(const std::string& endpoint, const std::string& query,
                                               bool silent, Cancellation* cancellation,
                                               MemoryUse* memory) override;
  // For LOAD: the document's quads, in the format that its Content-Type or name says. `memory` counts them, which stay
  // counted, and meanwhile the text.
  absl::StatusOr<std::vector<TermQuad>> Load(const std::string& url, Cancellation* cancellation,
                                             MemoryUse* memory) const;

 private:
  bool IsAllowedPath(const std::string& real_path) const;
  absl::Status Refuse(std::string_view url) const;
  // While what does not fit is still counted.
  absl::Status TooMuch(const std::string& url, const MemoryUse& memory) const;
  // The answer with status 200, and in request->url where it came from. UNKNOWN: what the other server did instead.
  absl::StatusOr<HttpResponse> Get(FetchRequest* request, Cancellation* cancellation) const;

  const std::vector<std::string> allowed_;
  const Limits limits_;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_WORK_REMOTE_ACCESS_H_
