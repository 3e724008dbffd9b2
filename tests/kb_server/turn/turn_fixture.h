// Stages that take turns one after the other, as the writer does, and can be saved and restored in between.
#ifndef DOCENT_TESTS_KB_SERVER_TURN_TURN_FIXTURE_H_
#define DOCENT_TESTS_KB_SERVER_TURN_TURN_FIXTURE_H_

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "gtest/gtest.h"
#include "kb_server/turn/turn.h"
#include "kb_server/writer/server_state.h"
#include "tests/kb_server/test_world.h"

namespace docent::server::test {

inline constexpr TimeMicros kSecond = 1'000'000;

class TurnTest : public ::testing::Test {
 protected:
  TurnResult Turn(WriteBatch batch) {
    batch.time_us = now_us_ += 1000;
    auto result = RunTurn(stages_.get(), std::move(batch), head_ + 1);
    EXPECT_TRUE(result.ok()) << result.status();
    if (result.ok()) ++head_;
    return result.ok() ? *std::move(result) : TurnResult();
  }
  // The clock's turns, as long as one is due.
  void Settle() {
    for (int i = 0; i < 10 && stages_->NextDeadline() && *stages_->NextDeadline() <= now_us_; ++i) Tick();
  }
  TurnResult Tick() {
    WriteBatch tick;
    tick.clock_tick = true;
    return Turn(std::move(tick));
  }
  ServerState State() const {
    return TakeState(*stages_, RequestMemory(10), stages_->writer.Freeze(Revision(head_)), now_us_);
  }
  void Restart() {
    auto bytes = EncodeState(State(), dictionary_);
    ASSERT_TRUE(bytes.ok()) << bytes.status();
    RestartFrom(*bytes);
  }
  void RestartFrom(const std::string& bytes) {
    auto state = DecodeState(bytes, &dictionary_, &functions_, Limits());
    ASSERT_TRUE(state.ok()) << state.status();
    stages_ = std::move(state->stages);
  }
  // Runs that the turn started.
  static std::vector<std::string> Started(const TurnResult& result) {
    std::vector<std::string> runs;
    for (const Transition& t : result.record.transitions) {
      if (t.from.empty() && t.to == "running") runs.push_back(t.subject);
    }
    return runs;
  }
  size_t Count(const std::string& predicate) const {
    const auto p = dictionary_.FindIri(test::Name(predicate));
    return p ? stages_->writer.current().Count({{}, *p, {}, {}}) : 0;
  }
  Dictionary dictionary_;
  sparql::FunctionRegistry functions_;
  std::unique_ptr<Stages> stages_ = std::make_unique<Stages>(&dictionary_, &functions_, Limits());
  uint64_t head_ = 0;
  TimeMicros now_us_ = 1'700'000'000'000'000;
};

}  // namespace docent::server::test

#endif  // DOCENT_TESTS_KB_SERVER_TURN_TURN_FIXTURE_H_
