// Tells the world of turns that are durable: robots their commands, watchers the events, clients the outcome.
//
// It does so on a thread of its own, in the order of the turns, so that the writer decides the next ones
// meanwhile: waking an adapter or a client costs about as much as a turn.
#ifndef DOCENT_KB_SERVER_APP_TURN_TELLER_H_
#define DOCENT_KB_SERVER_APP_TURN_TELLER_H_

#include <deque>
#include <thread>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"
#include "kb_server/app/turn.h"
#include "kb_server/door/inbox.h"
#include "kb_server/rdf/dictionary.h"
#include "kb_server/service/run_feed.h"
#include "robot_adapters/proxy/robot_proxies.h"

namespace docent {

struct DurableTurn {
  TurnResult result;
  BatchOutcome outcome;
  BatchCallback done;
};

// Tell and WaitUntilTold: one thread, the writer.
class TurnTeller {
 public:
  // `proxies` may be null (nothing is sent). Everything must outlive the teller.
  TurnTeller(RunFeed* feed, RobotProxies* proxies, const Dictionary* dictionary);
  ~TurnTeller();  // when all is told
  TurnTeller(const TurnTeller&) = delete;
  TurnTeller& operator=(const TurnTeller&) = delete;

  // Waits while kGroupsAhead groups are still to be told.
  void Tell(std::vector<DurableTurn> group);
  void WaitUntilTold();
  // Where the proxies find the adapters of this version. Returns when they know.
  void TellAddresses(const GraphVersion& version);

 private:
  static constexpr size_t kGroupsAhead = 4;

  void Loop();
  void TellTurn(DurableTurn* turn);
  void TellAddress(const Quad& fact);

  RunFeed& feed_;
  RobotProxies* const proxies_;
  const Dictionary& dictionary_;

  absl::Mutex mutex_;
  std::deque<std::vector<DurableTurn>> groups_ ABSL_GUARDED_BY(mutex_);  // the first is being told
  bool ending_ ABSL_GUARDED_BY(mutex_) = false;
  std::thread thread_;
};

}  // namespace docent

#endif  // DOCENT_KB_SERVER_APP_TURN_TELLER_H_
