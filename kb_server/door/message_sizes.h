// The largest message of each method of the API. Pure functions; any thread.
#ifndef DOCENT_KB_SERVER_DOOR_MESSAGE_SIZES_H_
#define DOCENT_KB_SERVER_DOOR_MESSAGE_SIZES_H_

#include <cstddef>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "graph/base/limits.h"
#include "graph/base/network_limits.h"

namespace docent::server {

struct MessageSize {
  size_t bytes = 0;        // of a message in its binary form
  std::string_view limit;  // the name of what it follows from
};

// `method`: its full name, "docent.v1.Fleet.List". Of one that takes documents or facts it is document_bytes, of an update
// update_text_bytes, both with some room beside the text; of all others request_bytes.
MessageSize LargestMessage(std::string_view method, const Limits& limits, const NetworkLimits& network);
// As JSON: its escapes and names take more.
MessageSize LargestJson(std::string_view method, const Limits& limits, const NetworkLimits& network);

// RESOURCE_EXHAUSTED for a message of `bytes` that is larger than `largest`.
absl::Status CheckMessageSize(std::string_view method, size_t bytes, const MessageSize& largest);

// Full names of the methods that take documents or facts.
const std::vector<std::string_view>& DocumentMethods();

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_DOOR_MESSAGE_SIZES_H_
