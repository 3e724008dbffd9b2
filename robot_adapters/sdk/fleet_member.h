// Keeps the robot's lease: calls Fleet.Join again and again, well before each lease runs out, and goes on for
// ever when the server is away. At the end in order it says that the robot leaves. One thread of its own; thread-safe.
#ifndef DOCENT_ROBOT_ADAPTERS_SDK_FLEET_MEMBER_H_
#define DOCENT_ROBOT_ADAPTERS_SDK_FLEET_MEMBER_H_

#include <functional>
#include <set>
#include <string>
#include <thread>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"
#include "docent/v1/fleet.pb.h"
#include "robot_adapters/sdk/server_link.h"

namespace docent::robot {

class FleetMember {
 public:
  // `link` must outlive it. `on_return` is called after the first Join, after each that follows a failed one, and where the
  // server says that it wants all states.
  FleetMember(ServerLink* link, v1::JoinRequest request, std::function<void()> on_return);
  ~FleetMember() { Stop(); }
  // Joins no more, and tells the server that the robot leaves where it has joined. Waits for at most `timeout`; where the server
  // does not take it, the robot is offline when its lease has run out.
  void Leave(absl::Duration timeout);
  // Joins no more. The link should have been shut down, or a call may keep this waiting for its timeout.
  void Stop();

  bool joined() const;

 private:
  void Run();
  void SayWarnings(const v1::JoinReply& reply);

  ServerLink* const link_;
  const v1::JoinRequest request_;
  const std::function<void()> on_return_;
  mutable absl::Mutex mutex_;
  bool joining_ ABSL_GUARDED_BY(mutex_) = false;  // a Join is under way
  bool joined_ ABSL_GUARDED_BY(mutex_) = false;
  bool stopped_ ABSL_GUARDED_BY(mutex_) = false;
  std::set<std::string> warnings_;  // that were logged; the thread's
  std::thread thread_;
};

}  // namespace docent::robot

#endif  // DOCENT_ROBOT_ADAPTERS_SDK_FLEET_MEMBER_H_
