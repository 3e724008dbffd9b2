// The answers that robots gave in a recorded life, by command. A report is given to the replay in its recorded turn, if the
// replay has sent the same command in the same turn; else after the same time. A command of the run is answered as the recorded
// one of the same node and operation was, first one with the same robot and values, else the next one that is left; a command of
// another run as that of the same attempt.
//
// One thread.
#ifndef DOCENT_KB_SERVER_REPLAY_ANSWER_BOOK_H_
#define DOCENT_KB_SERVER_REPLAY_ANSWER_BOOK_H_

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "kb_server/replay/run_case.h"

namespace docent::server {

// A report that is to be given to the replay at a time of its own.
struct DueReport {
  TimeMicros time_us = 0;
  CommandReport report;
};

class AnswerBook {
 public:
  // `recorded` must outlive it.
  explicit AnswerBook(const RunCase& recorded);

  // The run has sent this command; the ids are those of the replay. What is not answered in the recorded turns is added to
  // `due`. False: there is no recorded command that was not used.
  bool Answer(const Decision& command, std::vector<DueReport>* due);
  // Another run has.
  void AnswerOther(const RobotCommand& command, TimeMicros now_us, std::vector<DueReport>* due);
  // What the replay is to be told where this report was recorded; nullopt: nothing.
  std::optional<CommandReport> Told(const CommandReport& recorded) const;
  // The replay has ended this command: what was recorded of it is told no more.
  void Drop(const CommandId& played);
  // Whether the recorded run cancelled the command that answered this one.
  bool WasCancelled(const CommandId& played) const;

 private:
  using Reports = std::vector<std::pair<const CaseTurn*, const CommandReport*>>;
  struct Recorded {
    const Decision* command = nullptr;
    bool used = false;
    bool cancelled = false;
  };
  std::map<CommandId, Reports> reports_;
  std::map<std::pair<std::string, std::string>, std::vector<Recorded>> commands_;  // by node and operation
  std::set<CommandId> own_;                // recorded commands of the run
  std::map<CommandId, CommandId> played_;  // recorded → of the replay, which is answered in the same turns
  std::map<std::string, CommandId> others_;  // attempt → recorded command of another run
  std::set<CommandId> cancelled_;            // ids of the replay
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_REPLAY_ANSWER_BOOK_H_
