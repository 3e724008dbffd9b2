// What tests of the proxies share: commands, and the reports that come back.
#ifndef DOCENT_TESTS_ROBOT_ADAPTERS_PROXY_PROXY_REPORTS_H_
#define DOCENT_TESTS_ROBOT_ADAPTERS_PROXY_PROXY_REPORTS_H_

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"
#include "gtest/gtest.h"
#include "robot_adapters/proxy/robot_proxies.h"

namespace docent::proxy::test {

using Outcome = CommandReport::Outcome;

inline constexpr char kRobot[] = "http://example.org/r1";

inline bool IsFinalOutcome(Outcome outcome) {
  return outcome == Outcome::kSucceeded || outcome == Outcome::kFailed || outcome == Outcome::kCancelled ||
         outcome == Outcome::kUnknown || outcome == Outcome::kNotBegun;
}

// The reports of the proxies, with waiting.
class Reports {
 public:
  void Take(WriteBatch batch) {
    absl::MutexLock lock(&mutex_);
    for (CommandReport& report : batch.reports) reports_.push_back(std::move(report));
  }
  // The first report of this kind for the command; fails the test after half a minute.
  CommandReport Await(const std::string& command, Outcome outcome) {
    return AwaitMatching(command, [&](const CommandReport& report) { return report.outcome == outcome; });
  }
  CommandReport AwaitFinal(const std::string& command) {
    return AwaitMatching(command, [](const CommandReport& report) { return IsFinalOutcome(report.outcome); });
  }
  std::vector<Outcome> Outcomes(const std::string& command) {
    absl::MutexLock lock(&mutex_);
    std::vector<Outcome> outcomes;
    for (const CommandReport& report : reports_) {
      if (report.command.value() == command) outcomes.push_back(report.outcome);
    }
    return outcomes;
  }

 private:
  CommandReport AwaitMatching(const std::string& command,
                              const std::function<bool(const CommandReport&)>& matches) {
    absl::MutexLock lock(&mutex_);
    CommandReport found;
    auto there = [&]() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
      for (const CommandReport& report : reports_) {
        if (report.command.value() != command || !matches(report)) continue;
        found = report;
        return true;
      }
      return false;
    };
    EXPECT_TRUE(mutex_.AwaitWithTimeout(absl::Condition(&there), absl::Seconds(30)))
        << "no such report for " << command;
    return found;
  }

  absl::Mutex mutex_;
  std::vector<CommandReport> reports_;
};

inline ProxySettings FastSettings() {
  ProxySettings settings;
  settings.first_retry = std::chrono::milliseconds(10);
  settings.last_retry = std::chrono::milliseconds(50);
  settings.grace = std::chrono::milliseconds(100);
  return settings;
}

inline RobotCommand Command(const std::string& id, const std::string& operation, int deadline_ms = 20000) {
  RobotCommand command;
  command.id = CommandId(id);
  command.robot = RobotId(kRobot);
  command.operation = operation;
  command.arguments = {{"booth", Term::Iri("http://example.org/b3")}};
  command.deadline_us = SystemClock().Now() + deadline_ms * int64_t{1000};
  return command;
}

}  // namespace docent::proxy::test

#endif  // DOCENT_TESTS_ROBOT_ADAPTERS_PROXY_PROXY_REPORTS_H_
