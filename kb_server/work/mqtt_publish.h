// One message to a topic of an MQTT 3.1.1 broker, with QoS 1: it returns when the broker has it. A connection for each
// message, without TLS. Blocks; never call it on a network thread or the writer's. Any thread.
#ifndef DOCENT_KB_SERVER_WORK_MQTT_PUBLISH_H_
#define DOCENT_KB_SERVER_WORK_MQTT_PUBLISH_H_

#include <chrono>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "graph/base/cancellation.h"

namespace docent::server {

// `broker`: HOST:PORT. INVALID_ARGUMENT: the address or topic is none. UNAVAILABLE: no such host, refused, cut off, or the
// broker does not take it. DEADLINE_EXCEEDED, CANCELLED (looked at several times a second).
absl::Status PublishToMqtt(const std::string& broker, std::string_view topic, std::string_view payload,
                           std::chrono::milliseconds timeout, Cancellation* cancellation);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_WORK_MQTT_PUBLISH_H_
