#include "kb_server/grpc/write_pump.h"

#include <gtest/gtest.h>

#include <deque>
#include <string>
#include <thread>
#include <vector>

#include "absl/time/clock.h"
#include "docent/v1/workflows.pb.h"

namespace docent::server {
namespace {

using Message = v1::RunEvent;

// Stands in for gRPC's reactors, and records their calls.
class FakeReactor {
 public:
  virtual ~FakeReactor() = default;
  virtual void OnWriteDone(bool) {}
  virtual void OnCancel() {}
  virtual void OnDone() {}
  void StartWrite(const Message* message, grpc::WriteOptions) {
    EXPECT_FALSE(on_its_way) << "one at a time";
    on_its_way = true;
    written.push_back(message->run());
  }
  void Finish(const grpc::Status& status) {
    EXPECT_FALSE(on_its_way) << "the end comes after the message";
    finished.push_back(status);
  }
  bool on_its_way = false;
  std::vector<std::string> written;
  std::vector<grpc::Status> finished;
};

class Numbers final : public WritePump<FakeReactor, Message> {
 public:
  explicit Numbers(SendBudget* budget = nullptr) : WritePump(nullptr, budget) {}
  void Push(const std::string& text) {
    absl::MutexLock lock(&link()->mutex);
    queue.push_back(text);
    Advance();
  }
  void EndAll(bool at_once) {
    absl::MutexLock lock(&link()->mutex);
    end_when_idle = true;
    if (at_once) {
      End(grpc::Status::OK);
    } else {
      Advance();
    }
  }
  void CutNow() {
    absl::MutexLock lock(&link()->mutex);
    Cut({grpc::StatusCode::RESOURCE_EXHAUSTED, "too slow"});
  }
  // As gRPC calls it.
  void Done(bool ok) {
    on_its_way = false;
    OnWriteDone(ok);
  }

  bool FillNext(Message* message, grpc::WriteOptions*) override {
    EXPECT_EQ(message->ByteSizeLong(), 0u) << "it is empty";
    if (queue.empty()) return false;
    message->set_run(queue.front());
    queue.pop_front();
    return true;
  }
  void OnIdle() override {
    if (end_when_idle) End(grpc::Status::OK);
  }
  void OnEnding() override { queue.clear(); }
  void OnGone() override { ++gone_told; }
  void CancelCall(const grpc::Status& status) override { cancelled.push_back(status.error_code()); }
  void OnEnd() override {
    if (deleted != nullptr) *deleted = true;
  }

  std::deque<std::string> queue;
  std::vector<grpc::StatusCode> cancelled;
  bool end_when_idle = false;
  int gone_told = 0;
  bool* deleted = nullptr;
};

using Texts = std::vector<std::string>;

TEST(WritePump, TheNextMessageIsMadeWhenTheOneBeforeIsTaken) {
  auto* pump = new Numbers;
  pump->Push("1");
  pump->Push("2");
  pump->Push("3");
  EXPECT_EQ(pump->written, Texts({"1"}));
  EXPECT_EQ(pump->queue.size(), 2u);
  pump->Done(true);
  pump->Done(true);
  EXPECT_EQ(pump->written, Texts({"1", "2", "3"}));
  pump->Done(true);
  EXPECT_TRUE(pump->finished.empty());
  pump->EndAll(false);
  ASSERT_EQ(pump->finished.size(), 1u);
  EXPECT_TRUE(pump->finished[0].ok());
  pump->OnDone();
}

TEST(WritePump, TheEndComesAfterTheMessageThatIsOnItsWay) {
  auto* pump = new Numbers;
  pump->Push("1");
  pump->Push("2");
  pump->EndAll(true);
  EXPECT_TRUE(pump->finished.empty());
  pump->Done(true);
  EXPECT_EQ(pump->finished.size(), 1u);
  EXPECT_EQ(pump->written, Texts({"1"}));
  pump->Push("3");
  EXPECT_EQ(pump->written, Texts({"1"}));
  pump->OnDone();
}

TEST(WritePump, OfAClientThatGoesTheEndIsToldOnce) {
  auto* pump = new Numbers;
  pump->Push("1");
  pump->OnCancel();
  EXPECT_EQ(pump->gone_told, 1);
  EXPECT_TRUE(pump->finished.empty());
  pump->Done(false);
  ASSERT_EQ(pump->finished.size(), 1u);
  EXPECT_EQ(pump->finished[0].error_code(), grpc::StatusCode::CANCELLED);
  pump->CutNow();
  pump->EndAll(true);
  EXPECT_EQ(pump->finished.size(), 1u);
  EXPECT_TRUE(pump->cancelled.empty());
  pump->OnDone();
}

TEST(WritePump, AFailedWriteIsTheEnd) {
  auto* pump = new Numbers;
  pump->Push("1");
  pump->Push("2");
  pump->Done(false);
  ASSERT_EQ(pump->finished.size(), 1u);
  EXPECT_EQ(pump->finished[0].error_code(), grpc::StatusCode::CANCELLED);
  EXPECT_EQ(pump->written, Texts({"1"}));
  pump->OnDone();
}

TEST(WritePump, ACutStreamEndsAlthoughAMessageIsOnItsWay) {
  auto* pump = new Numbers;
  pump->Push("1");
  pump->CutNow();
  EXPECT_EQ(pump->cancelled, std::vector{grpc::StatusCode::RESOURCE_EXHAUSTED});
  pump->OnCancel();
  pump->Done(false);
  ASSERT_EQ(pump->finished.size(), 1u);
  EXPECT_EQ(pump->finished[0].error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  pump->OnDone();

  auto* idle = new Numbers;
  idle->CutNow();
  EXPECT_TRUE(idle->cancelled.empty()) << "nothing is on its way: the status is enough";
  ASSERT_EQ(idle->finished.size(), 1u);
  EXPECT_EQ(idle->finished[0].error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  idle->OnDone();
}

TEST(WritePump, WhatIsOnItsWayCountsUntilItIsTaken) {
  SendBudget budget(1 << 20);
  auto* pump = new Numbers(&budget);
  pump->Push(std::string(10000, 'x'));
  EXPECT_GT(budget.taken(), 10000u);
  pump->Done(true);
  EXPECT_EQ(budget.taken(), 0u);
  pump->Push(std::string(10000, 'x'));
  pump->OnCancel();
  pump->Done(false);
  EXPECT_EQ(budget.taken(), 0u);
  pump->OnDone();
}

TEST(WritePump, WhereAllStreamsHoldTooMuchTheLargestIsCut) {
  SendBudget budget(50000);
  auto* small = new Numbers(&budget);
  auto* large = new Numbers(&budget);
  small->Push(std::string(5000, 'x'));
  large->Push(std::string(30000, 'x'));
  const auto is_cut = [large] { return !large->cancelled.empty(); };
  {
    absl::MutexLock lock(&large->link()->mutex);
    ASSERT_TRUE(large->link()->mutex.AwaitWithTimeout(absl::Condition(&is_cut), absl::Minutes(1)));
  }
  EXPECT_EQ(large->cancelled, std::vector{grpc::StatusCode::RESOURCE_EXHAUSTED});
  large->Done(false);
  EXPECT_EQ(large->finished[0].error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_TRUE(small->cancelled.empty());
  small->Done(true);
  for (Numbers* pump : {small, large}) {
    pump->EndAll(true);
    pump->OnDone();
  }
  EXPECT_EQ(budget.taken(), 0u);
}

TEST(WritePump, TheLinkOutlivesTheStream) {
  bool deleted = false;
  auto* pump = new Numbers;
  pump->deleted = &deleted;
  const auto link = pump->link();
  EXPECT_EQ(link->pump, pump);
  pump->EndAll(true);
  pump->OnDone();
  EXPECT_TRUE(deleted);
  absl::MutexLock lock(&link->mutex);
  EXPECT_EQ(link->pump, nullptr);
}

}  // namespace
}  // namespace docent::server
