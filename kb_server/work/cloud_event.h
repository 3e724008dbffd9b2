// A notification as a CloudEvent 1.0 in its JSON format (https://github.com/cloudevents/spec, v1.0.2). Pure function.
#ifndef DOCENT_KB_SERVER_WORK_CLOUD_EVENT_H_
#define DOCENT_KB_SERVER_WORK_CLOUD_EVENT_H_

#include <string>

#include "graph/store/notification.h"

namespace docent::server {

inline constexpr char kCloudEventsJson[] = "application/cloudevents+json; charset=utf-8";

// Structured mode. `data` has a member for each value: resources and texts are strings, numbers and truth values are themselves,
// text with a language is {"value", "language"}, another literal {"value", "datatype"}; NaN and infinite numbers are strings; what
// has no value is null.
std::string ToCloudEvent(const Notification& notification);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_WORK_CLOUD_EVENT_H_
