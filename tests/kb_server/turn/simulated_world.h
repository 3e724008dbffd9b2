// What is outside of the server in the simulation, besides the robots: a receiver of notifications, and the clock that tells times.
#ifndef DOCENT_TESTS_KB_SERVER_TURN_SIMULATED_WORLD_H_
#define DOCENT_TESTS_KB_SERVER_TURN_SIMULATED_WORLD_H_

#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/match.h"
#include "graph/calendar/time_spec.h"
#include "graph/rdf/docent_iris.h"
#include "graph/store/graph_version.h"
#include "gtest/gtest.h"
#include "kb_server/clock/clock_facts.h"
#include "tests/kb_server/turn/simulation_dice.h"

namespace docent::server::test {

// Delivers notifications, late or in vain; some answers come again.
class Postman {
 public:
  explicit Postman(Dice* dice) : dice_(*dice) {}

  // What a turn decided: each of them once in the life of the data.
  void Send(const Notification& notification, TimeMicros now_us) {
    EXPECT_TRUE(all_.insert(notification.id).second) << notification.id.value() << " is decided again";
    open_[notification.id] = now_us + dice_.Below(6000) * TimeMicros{1000};
  }
  std::vector<CommandReport> Reports(TimeMicros now_us) {
    std::vector<CommandReport> reports;
    for (auto it = open_.begin(); it != open_.end();) {
      if (it->second > now_us) {
        ++it;
        continue;
      }
      const bool fails = dice_.OneIn(4, "failure");
      for (int times = dice_.OneIn(5, "repeat") ? 2 : 1; times > 0; --times)
        reports.push_back({it->first,
                           fails ? CommandReport::Outcome::kFailed : CommandReport::Outcome::kSucceeded,
                           fails ? "no answer" : "",
                           0,
                           "",
                           {}});
      it = open_.erase(it);
    }
    return reports;
  }
  // The server keeps exactly those that were not answered.
  void Check(const std::vector<Notification>& kept) const {
    EXPECT_EQ(kept.size(), open_.size());
    for (const Notification& notification : kept)
      EXPECT_TRUE(open_.contains(notification.id))
          << notification.id.value() << " is kept though it was answered";
  }

 private:
  Dice& dice_;
  std::set<CommandId> all_;
  std::map<CommandId, TimeMicros> open_;  // → when its answer comes
};

// What the clock tells now; no operations: nothing.
inline WriteBatch ClockTells(TimeMicros now_us, const Dictionary& dictionary, const GraphVersion& graph) {
  ClockFacts facts = ClockFactsAt({now_us, now_us}, dictionary, graph);
  WriteBatch batch;
  batch.source = kClockGraph;
  batch.mode = WriteBatch::Mode::kLoad;
  batch.operations = std::move(facts.operations);
  return batch;
}

// Whether the batch tells that the interval (`every`) is over.
inline bool TellsInterval(const WriteBatch& batch, const std::string& every) {
  for (const QuadOperation& operation : batch.operations) {
    if (operation.kind != QuadOperation::Kind::kAdd ||
        operation.quad.predicate.lexical != DocentIri("occurs"))
      continue;
    const auto words = calendar::WordsOfTimeIri(operation.quad.subject.lexical);
    if (words && words->contains("every") && words->at("every") == every) return true;
  }
  return false;
}
// Whether it tells an event of this operation.
inline bool TellsEvent(const WriteBatch& batch, const std::string& operation_name) {
  for (const QuadOperation& operation : batch.operations) {
    if (operation.kind == QuadOperation::Kind::kAdd &&
        operation.quad.predicate.lexical == DocentIri("operation") &&
        operation.quad.object.lexical == operation_name)
      return true;
  }
  return false;
}

}  // namespace docent::server::test

#endif  // DOCENT_TESTS_KB_SERVER_TURN_SIMULATED_WORLD_H_
