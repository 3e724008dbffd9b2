#include "robot_adapters/proxy/event_loop.h"

#include <gmock/gmock.h>

#include <string>

#include "absl/synchronization/notification.h"

namespace docent::proxy {
namespace {

TEST(EventLoopTest, RunsTimersWhenTheyAreDueAndNoneThatWasTakenBack) {
  std::string order;
  absl::Notification last;
  EventLoop loop;
  loop.Post([&] {
    loop.PostAfter(absl::Milliseconds(20), [&] {
      order += 'c';
      last.Notify();
    });
    loop.PostAfter(absl::Milliseconds(5), [&] { order += 'b'; });
    const EventLoop::Timer taken_back = loop.PostAfter(absl::Milliseconds(5), [&] { order += 'x'; });
    order += 'a';
    loop.Cancel(taken_back);
    loop.Cancel(taken_back);
  });
  last.WaitForNotification();
  EXPECT_EQ(order, "abc");
}

}  // namespace
}  // namespace docent::proxy
