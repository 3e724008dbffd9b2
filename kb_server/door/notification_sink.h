// Where notifications go once their turn is durable.
#ifndef DOCENT_KB_SERVER_DOOR_NOTIFICATION_SINK_H_
#define DOCENT_KB_SERVER_DOOR_NOTIFICATION_SINK_H_

#include "graph/store/notification.h"

namespace docent::server {

class NotificationSink {
 public:
  virtual ~NotificationSink() = default;
  // Does not wait. What becomes of it comes through the door as a report of its id. Any thread.
  virtual void Send(const Notification& notification) = 0;
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_DOOR_NOTIFICATION_SINK_H_
