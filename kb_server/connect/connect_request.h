// A request of the Connect protocol, read from HTTP: unary POST, unary GET, and enveloped streams. Pure functions.
//
// The head is checked first, which is quick; the body, which may have to be unpacked and parsed, then, where there is time
// for it.
#ifndef DOCENT_KB_SERVER_CONNECT_CONNECT_REQUEST_H_
#define DOCENT_KB_SERVER_CONNECT_CONNECT_REQUEST_H_

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "graph/base/limits.h"
#include "graph/base/memory_budget.h"
#include "kb_server/connect/message_codec.h"
#include "kb_server/work/http_message.h"

namespace google::protobuf {
class MethodDescriptor;
}  // namespace google::protobuf

namespace docent::server {

struct ConnectHead {
  bool stream = false;  // enveloped; otherwise unary
  MessageCodec codec = MessageCodec::kJson;
  absl::Duration timeout = absl::InfiniteDuration();
  bool gzip_request = false;  // unary: the body; stream: messages with the flag
  bool gzip_reply = false;    // the client can read it

  // "application/connect+json"
  std::string_view ContentType() const;
};

// True if the method may be called with GET: one answer, and nothing is changed.
bool IsRead(const google::protobuf::MethodDescriptor& method);

// Fills `*head`; or the refusal, which is the whole answer.
std::optional<HttpResponse> ReadConnectHead(const HttpRequest& http,
                                            const google::protobuf::MethodDescriptor& method,
                                            ConnectHead* head);

// The messages of a request whose head is good, in their binary form. INVALID_ARGUMENT, UNIMPLEMENTED (more than one for a
// method that takes one), RESOURCE_EXHAUSTED (larger than the method's largest message, unpacked; all together larger than
// http_body_bytes; no room for them at the moment). `memory`: of the request, which counts them; null: they are not counted. `cancellation`: its
// error, where it is over; null: none.
absl::StatusOr<std::vector<std::string>> ReadConnectMessages(const HttpRequest& http,
                                                             const google::protobuf::MethodDescriptor& method,
                                                             const ConnectHead& head, const Limits& limits,
                                                             MemoryUse* memory = nullptr,
                                                             Cancellation* cancellation = nullptr);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_CONNECT_CONNECT_REQUEST_H_
