// One message of a tab on a live connection, read. Pure functions.
#ifndef DOCENT_KB_SERVER_LIVE_LIVE_REQUEST_H_
#define DOCENT_KB_SERVER_LIVE_LIVE_REQUEST_H_

#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "graph/base/cancellation.h"

namespace google::protobuf {
class MethodDescriptor;
}  // namespace google::protobuf

namespace docent::server {

struct LiveRequest {
  std::string id;    // as JSON: a number or a string
  bool end = false;  // of the stream `id`; the rest is not set then
  const google::protobuf::MethodDescriptor* method = nullptr;
  std::string_view request;  // as JSON, a part of the text
  std::string resume;
  absl::Duration every;  // of a read that is followed: the least time between two answers
};

// `services`: full names of those that are served. Where the message is not good, INVALID_ARGUMENT, NOT_FOUND (no such
// method) or FAILED_PRECONDITION (one that is not followed); `*id` is what of the id could be read, or "null".
// `cancellation`, if there is one, is looked at all the while: where it is over, its error is the result.
absl::StatusOr<LiveRequest> ReadLiveRequest(std::string_view text, const std::vector<std::string>& services,
                                            std::string* id, Cancellation* cancellation = nullptr);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_LIVE_LIVE_REQUEST_H_
