// The answers that robots gave in a recorded life, by command: a command of a replay is answered as the recorded command of the
// same node and operation was, first one with the same robot and values, else the next one that is left.
//
// One thread.
#ifndef DOCENT_KB_SERVER_REPLAY_ANSWER_BOOK_H_
#define DOCENT_KB_SERVER_REPLAY_ANSWER_BOOK_H_

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "kb_server/replay/run_case.h"

namespace docent::server {

// A report that is to be given to the replay.
struct DueReport {
  uint64_t offset = 0;  // with this recorded turn; 0: at the time
  TimeMicros time_us = 0;
  CommandReport report;
};

class AnswerBook {
 public:
  // `recorded` must outlive it.
  explicit AnswerBook(const RunCase& recorded);

  // What was reported of the command that answers this one; the ids are those of the replay. One that was sent in the same turn
  // is answered in the same turns, another one after the same times. False: there is none that was not used.
  bool Answer(const Decision& command, std::vector<DueReport>* due);
  // Whether the recorded run cancelled the command that answered this one.
  bool WasCancelled(const CommandId& played) const;

 private:
  struct Recorded {
    const Decision* command = nullptr;
    std::vector<std::pair<const CaseTurn*, const CommandReport*>> reports;
    bool used = false;
    bool cancelled = false;
  };
  std::map<std::pair<std::string, std::string>, std::vector<Recorded>> commands_;  // by node and operation
  std::set<CommandId> cancelled_;                                                  // ids of the replay
};

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_REPLAY_ANSWER_BOOK_H_
