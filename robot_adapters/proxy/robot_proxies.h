// The server's side of robots: carries each command to its robot's adapter and brings back what became of it.
//
// A command ends in exactly one final report (succeeded, failed, cancelled, unknown), and that is the truth: after it
// the robot does nothing for the command any more, unless it is unknown, where the incarnation that might is gone. A command
// that an adapter may have and whose deadline passes is cancelled, and its end waited for, however long. The adapter never gets
// it twice while the first may still be under way:
//
//   Send ─► (connected) ─► Invoke ──feedback──► accepted, progress …, final report
//             │ connection lost, adapter away: unreachable (once), wait, then
//             ▼
//   Resume ► Attach ──feedback──► as above
//             │ NOT_FOUND: never begun there ─► Invoke again, same id
//             │ FAILED_PRECONDITION (another incarnation, or it died with the adapter) ─► unknown
//             └ still away: wait longer, Attach again …; at the deadline: Cancel, and Attach on
//
// A Cancel may overtake the Invoke, or be lost: it is sent again until the adapter says that it has heard it, or the command's end.
// A command that is cancelled, called back or overdue is not invoked any more. The adapter that it was meant for may answer that it
// does not know it. Then the command is reported as failed if its time is over. Else it is reported as not begun, as soon as the
// adapter has heard the Cancel or ProxySettings::may_begin has passed. A command that was not sent before another incarnation
// joined is reported as not begun, too.
//
// Thread-safe. `Send`, `Resume`, `Cancel` and `SetAdapter` only queue the request for the proxies' own thread
// and never block. Feedback goes out through `report`, called on that thread, one at a time; it should not
// block for long.
#ifndef DOCENT_ROBOT_ADAPTERS_PROXY_ROBOT_PROXIES_H_
#define DOCENT_ROBOT_ADAPTERS_PROXY_ROBOT_PROXIES_H_

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "graph/base/clock.h"
#include "graph/base/ids.h"
#include "graph/store/decisions.h"
#include "graph/store/write_batch.h"

namespace docent::proxy {

struct ProxySettings {
  // How long to wait between attempts to reach an adapter; doubles from the first to the last.
  std::chrono::milliseconds first_retry{100};
  std::chrono::milliseconds last_retry{2000};
  // Progress of one command is reported at most this often (the final report always).
  std::chrono::milliseconds progress_interval{200};
  // An adapter gives up at the deadline by itself; it has this long to say so.
  std::chrono::milliseconds grace{300};
  // An adapter may have read a stopped command that it does not know yet, unless it has heard the Cancel. The Cancel is repeated
  // for this time, at most until the command's deadline. Then the command counts as not begun.
  std::chrono::milliseconds may_begin{30000};
  // Deadline of commands that carry none.
  std::chrono::milliseconds default_deadline{300000};
};

// What is wanted of a command.
enum class CommandWish {
  kDone,      // that it is done
  kNotBegin,  // that it does not begin; if a robot has begun it, that it is done
  kEnd        // that it ends as soon as it is safe
};

class RobotProxies {
 public:
  // `clock` tells how far away deadlines are: one that cannot be set. nullptr: steady time, with the system's at the start. It
  // must outlive the proxies.
  explicit RobotProxies(std::function<void(WriteBatch)> report, const ProxySettings& settings = {},
                        const Clock* clock = nullptr);
  // Drops what is under way; nothing is reported any more when it has returned.
  ~RobotProxies();
  RobotProxies(const RobotProxies&) = delete;
  RobotProxies& operator=(const RobotProxies&) = delete;

  // Where the robot's adapter serves, HOST:PORT, or "" for nowhere, and which incarnation of it has joined there; "": not known.
  // Commands under way move to the new address, and what another incarnation began is asked of the one that is there; the
  // same address again says that the adapter is back, so that those that wait try at once.
  void SetAdapter(const RobotId& robot, const std::string& address, const std::string& incarnation);

  // A command that was never sent before. Nothing happens if this id is under way.
  void Send(const RobotCommand& command);
  // A command that was cancelled or called back in the turn that decided it: it is reported as not begun.
  void NeverSend(const RobotCommand& command);
  // A command that may have been sent before this process began: asks for its state first. Where it is under way, `wish` counts
  // all the same.
  void Resume(const RobotCommand& command, CommandWish wish = CommandWish::kDone);
  // Ends the command as soon as it is safe; the final report comes as for any command. Nothing happens if the
  // id is not under way.
  void Cancel(const CommandId& command);
  // The command does not begin any more, and is then reported as not begun; one that the robot has begun goes on. Nothing happens
  // if the id is not under way.
  void Recall(const CommandId& command);
  // Messages of adapters that were refused since the start: about another command, of another incarnation, after the end, with
  // a state, progress or result that cannot be. Each is logged; the first about a command is reported (kRefused).
  uint64_t refused_feedback() const;
  // Commands that have no final report yet.
  size_t open() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace docent::proxy

#endif  // DOCENT_ROBOT_ADAPTERS_PROXY_ROBOT_PROXIES_H_
