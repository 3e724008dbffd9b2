// When attempts of nodes begin, in the simulation: the time of a node (ext:timeout) is that of each attempt, and begins when all
// commands of the attempt before have ended.
#ifndef DOCENT_TESTS_KB_SERVER_TURN_ATTEMPT_MODEL_H_
#define DOCENT_TESTS_KB_SERVER_TURN_ATTEMPT_MODEL_H_

#include <cstddef>
#include <cstdio>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "absl/strings/str_split.h"
#include "graph/base/clock.h"
#include "graph/base/ids.h"
#include "graph/store/decisions.h"
#include "gtest/gtest.h"

namespace docent::server::test {

class AttemptModel {
 public:
  // The final report of a command came.
  void Ended(const CommandId& command, TimeMicros now_us) {
    for (auto& [node, attempt] : attempts_) {
      if (attempt.awaited.erase(command) > 0) attempt.since_us = now_us;
    }
  }

  // `under_way`: commands without a final report, before those that this turn sends.
  void Take(const std::vector<Transition>& transitions, const std::vector<CommandId>& under_way,
            TimeMicros now_us) {
    for (const Transition& t : transitions) {
      const std::vector<std::string> parts = absl::StrSplit(t.subject, '/');
      if (parts.size() != 2) continue;  // of a node
      CheckTime(t, now_us);
      if (t.to != "running" || (t.from == t.to && !t.cause.starts_with("attempt "))) continue;
      Attempt& next = attempts_[t.subject] = {now_us, {}};
      for (const CommandId& id : under_way) {
        if (id.value().starts_with(t.subject + "/")) next.awaited.insert(id);
      }
    }
  }

  // Nodes whose time was over.
  size_t timed_out() const { return timed_out_; }

 private:
  struct Attempt {
    TimeMicros since_us = 0;
    std::set<CommandId> awaited;  // commands of the attempt before
  };

  void CheckTime(const Transition& t, TimeMicros now_us) {
    const size_t within = t.cause.find("it was not done within ");
    const auto attempt = attempts_.find(t.subject);
    int seconds = 0;
    const bool over = within != std::string::npos && attempt != attempts_.end() &&
                      std::sscanf(t.cause.c_str() + within, "it was not done within %d s", &seconds) == 1 &&
                      (t.to == "failed" || t.to == "incident" || t.from == t.to);
    if (!over) return;
    ++timed_out_;
    EXPECT_GE(now_us - attempt->second.since_us, seconds * TimeMicros{1'000'000})
        << t.subject << ": " << t.cause;
  }

  std::map<std::string, Attempt> attempts_;  // by RUN/NODE
  size_t timed_out_ = 0;
};

}  // namespace docent::server::test

#endif  // DOCENT_TESTS_KB_SERVER_TURN_ATTEMPT_MODEL_H_
