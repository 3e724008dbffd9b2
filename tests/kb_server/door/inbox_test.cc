#include "kb_server/door/inbox.h"

#include "kb_server/door/parsed_document.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "graph/store/graph_writer.h"
#include "kb_server/door/query_port.h"
#include "kb_server/door/request_memory.h"

namespace docent::server {
namespace {

using testing::HasSubstr;

WriteBatch BatchOf(size_t operations, size_t text = 1) {
  WriteBatch batch;
  for (size_t i = 0; i < operations; ++i) {
    batch.operations.push_back(
        {QuadOperation::Kind::kAdd, {Term::Literal(std::string(text, 'x')), {}, {}, {}}});
  }
  return batch;
}

// The immediate answer of Push; OK if there is none.
std::string Answer(Inbox* inbox, WriteBatch batch) {
  std::string answer = "OK";
  inbox->Push(std::move(batch),
              [&answer](const absl::StatusOr<BatchOutcome>& o) { answer = o.status().ToString(); });
  return answer;
}

TEST(InboxTest, BatchesComeInOrderStampedWithGrowingTime) {
  ManualClock clock(100);
  Inbox inbox(&clock, Limits());
  for (size_t i = 1; i <= 3; ++i) inbox.Push(BatchOf(i), nullptr);
  EXPECT_EQ(inbox.size(), 3u);
  std::vector<PendingBatch> first = inbox.PopAll(std::nullopt, 2);
  ASSERT_EQ(first.size(), 2u);
  EXPECT_EQ(first[0].batch.operations.size(), 1u);
  EXPECT_EQ(first[1].batch.operations.size(), 2u);
  EXPECT_EQ(first[0].batch.time_us, 100);
  first[0].done(BatchOutcome{});  // a null callback was replaced
  clock.Set(50);                  // the wall clock went back
  EXPECT_EQ(inbox.PopAll(std::nullopt, 9)[0].batch.time_us, 100);
  inbox.StartAfter(500);
  inbox.Push(BatchOf(1), nullptr);
  EXPECT_EQ(inbox.PopAll(std::nullopt, 9)[0].batch.time_us, 500);
}

TEST(InboxTest, AtEachLimitAndOnePast) {
  ManualClock clock;
  Limits limits;
  limits.inbox_batches = 2;
  limits.batch_operations = 3;
  limits.load_operations = 5;
  limits.batch_bytes = 30;
  limits.document_bytes = 40;
  Inbox inbox(&clock, limits);
  auto pop = [&inbox] { inbox.PopAll(0, 99); };
  EXPECT_EQ(Answer(&inbox, BatchOf(3)), "OK");
  EXPECT_THAT(Answer(&inbox, BatchOf(4)),
              HasSubstr("RESOURCE_EXHAUSTED: the batch has operations: 4; the limit batch_operations is 3"));
  EXPECT_EQ(Answer(&inbox, BatchOf(3, 10)), "OK");
  EXPECT_THAT(Answer(&inbox, BatchOf(1)), HasSubstr("the limit inbox_batches is 2"));
  pop();
  EXPECT_THAT(Answer(&inbox, BatchOf(1, 31)), HasSubstr("the limit batch_bytes is 30"));
  WriteBatch load = BatchOf(5, 100);
  load.mode = WriteBatch::Mode::kLoad;
  EXPECT_EQ(Answer(&inbox, load), "OK");
  load.operations.push_back(load.operations[0]);
  EXPECT_THAT(Answer(&inbox, load), HasSubstr("the limit load_operations is 5"));
  WriteBatch document;
  document.documents.push_back({Document::Kind::kRules, Document::Action::kPut, "r", std::string(40, 'x')});
  EXPECT_EQ(Answer(&inbox, document), "OK");
  document.documents[0].text += "x";
  EXPECT_THAT(Answer(&inbox, document), HasSubstr("the limit document_bytes is 40"));
}

TEST(InboxTest, WhatCannotNameADocumentIsRefusedWhenItIsPutAndStillRemoved) {
  ManualClock clock;
  Inbox inbox(&clock, {});
  for (const Document::Kind kind : {Document::Kind::kRules, Document::Kind::kOntology}) {
    for (const std::string& name : {std::string("a\nb"), std::string("a\0b", 3), std::string(257, 'x'),
                                    std::string(".."), std::string()}) {
      WriteBatch batch;
      batch.documents.push_back({kind, Document::Action::kPut, name, ""});
      EXPECT_THAT(Answer(&inbox, batch),
                  HasSubstr(kind == Document::Kind::kRules ? "INVALID_ARGUMENT: the name of the rule set "
                                                           : "INVALID_ARGUMENT: the name of the ontology "))
          << name;
      batch.documents[0].action = Document::Action::kRemove;
      EXPECT_EQ(Answer(&inbox, batch), "OK") << "an earlier version took it";
    }
  }
}

TEST(InboxTest, WorkflowsAndServicesAreNamedByTheirTexts) {
  ManualClock clock;
  Inbox inbox(&clock, {});
  auto workflow = std::make_shared<cawl::Document>();
  workflow->name.value = "..";
  WriteBatch batch;
  batch.documents.push_back({Document::Kind::kCawl, Document::Action::kPut, "a\nfile", "",
                             std::make_shared<ParsedDocument>(cawl::DocumentPtr(workflow))});
  EXPECT_THAT(Answer(&inbox, batch), HasSubstr("INVALID_ARGUMENT: the name of the workflow has the part .."));
  auto services = std::make_shared<rsel::Document>();
  services->name.value = "S";
  services->processes.emplace_back().name.value = "a/..";
  batch.documents[0] = {Document::Kind::kRsel, Document::Action::kPut, "a\nfile", "",
                        std::make_shared<ParsedDocument>(rsel::DocumentPtr(services))};
  EXPECT_THAT(Answer(&inbox, batch), HasSubstr("INVALID_ARGUMENT: the name of the process has the part .."));
}

TEST(InboxTest, BytesThatWaitAreBounded) {
  ManualClock clock;
  Limits limits;
  limits.inbox_bytes = 100;
  Inbox inbox(&clock, limits);
  EXPECT_EQ(Answer(&inbox, BatchOf(1, 150)), "OK");  // alone it may be larger
  EXPECT_THAT(Answer(&inbox, BatchOf(1, 1)), HasSubstr("the limit inbox_bytes is 100"));
  inbox.PopAll(0, 1);
  EXPECT_EQ(Answer(&inbox, BatchOf(1, 60)), "OK");
  EXPECT_EQ(Answer(&inbox, BatchOf(1, 40)), "OK");
  EXPECT_THAT(Answer(&inbox, BatchOf(1, 1)), HasSubstr("bytes of text that would wait: 101"));
}

TEST(InboxTest, PopWaitsForItsDeadlineOnly) {
  SystemClock clock;
  Inbox inbox(&clock, Limits());
  EXPECT_TRUE(inbox.PopAll(clock.Now() + 2000, 10).empty());
  std::thread later([&inbox] { inbox.Push(BatchOf(1), nullptr); });
  EXPECT_EQ(inbox.PopAll(std::nullopt, 10).size(), 1u);
  later.join();
}

TEST(InboxTest, WakeEndsOneWait) {
  SystemClock clock;
  Inbox inbox(&clock, Limits());
  inbox.Wake();
  EXPECT_TRUE(inbox.PopAll(std::nullopt, 10).empty());
  std::thread later([&inbox] { inbox.Wake(); });
  EXPECT_TRUE(inbox.PopAll(std::nullopt, 10).empty());
  later.join();
  inbox.Wake();
  inbox.Push(BatchOf(1), nullptr);
  EXPECT_EQ(inbox.PopAll(std::nullopt, 10).size(), 1u);
  EXPECT_FALSE(inbox.Passed(clock.Now() + 1'000'000'000));
  EXPECT_TRUE(inbox.Passed(clock.Now()));
}

TEST(InboxTest, AVisitStandsInItsPlaceAmongTheBatchesAndIsBoundedAsTheyAre) {
  ManualClock clock;
  Limits limits;
  limits.inbox_batches = 3;
  Inbox inbox(&clock, limits);
  std::string answer = "none";
  const auto visit = [&] {
    inbox.Visit([](Stages*, Revision) {}, [&](const absl::Status& status) { answer = status.ToString(); });
  };
  inbox.Push(BatchOf(1), nullptr);
  visit();
  inbox.Push(BatchOf(1), nullptr);
  EXPECT_EQ(answer, "none");
  visit();
  EXPECT_THAT(answer, HasSubstr("inbox_batches is 3"));
  std::vector<PendingBatch> taken = inbox.PopAll(std::nullopt, 9);
  ASSERT_EQ(taken.size(), 3u);
  EXPECT_FALSE(taken[0].visit);
  EXPECT_TRUE(taken[1].visit);
  EXPECT_FALSE(taken[2].visit);
  taken[1].done(BatchOutcome{});
  EXPECT_EQ(answer, "OK");
  inbox.Close();
  visit();
  EXPECT_THAT(answer, HasSubstr("UNAVAILABLE"));
}

TEST(InboxTest, AClosedInboxRefusesButGivesWhatWaits) {
  ManualClock clock;
  Inbox inbox(&clock, Limits());
  inbox.Push(BatchOf(1), nullptr);
  inbox.Close();
  EXPECT_TRUE(inbox.closed());
  EXPECT_THAT(Answer(&inbox, BatchOf(1)), HasSubstr("UNAVAILABLE"));
  EXPECT_EQ(inbox.PopAll(std::nullopt, 10).size(), 1u);
  EXPECT_TRUE(inbox.PopAll(std::nullopt, 10).empty());  // does not wait
}

TEST(InboxTest, EveryBatchOfManyThreadsIsTakenOnce) {
  SystemClock clock;
  Inbox inbox(&clock, Limits());
  std::vector<std::thread> threads;
  std::atomic<int> answered{0};
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&] {
      for (int i = 0; i < 500; ++i)
        inbox.Push(BatchOf(1), [&](const absl::StatusOr<BatchOutcome>&) { ++answered; });
    });
  }
  size_t taken = 0;
  TimeMicros last_us = 0;
  while (taken < 2000) {
    for (PendingBatch& pending : inbox.PopAll(std::nullopt, 64)) {
      EXPECT_GE(pending.batch.time_us, last_us);
      last_us = pending.batch.time_us;
      pending.done(BatchOutcome{});
      ++taken;
    }
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(answered, 2000);
  EXPECT_EQ(inbox.size(), 0u);
}

TEST(RequestMemoryTest, RemembersTheNewest) {
  RequestMemory memory(2);
  memory.Remember("a", {1});
  memory.Remember("", {2});
  EXPECT_EQ(memory.Find(""), nullptr);
  memory.Remember("b", {3});
  ASSERT_NE(memory.Find("a"), nullptr);
  EXPECT_EQ(memory.Find("a")->outcome.offset, 1u);
  memory.Remember("c", {4});
  EXPECT_EQ(memory.Find("a"), nullptr);
  ASSERT_NE(memory.Find("b"), nullptr);
  EXPECT_EQ(memory.Find("c")->outcome.offset, 4u);
}

TEST(RequestMemoryTest, AnotherRequestOfTheSameIdIsNoRepeat) {
  RequestMemory memory(3);
  BatchOutcome started;
  started.started.emplace_back("W-1");
  memory.Remember("start", started, 5);
  memory.Remember("old facts", {2});
  memory.Remember("old start", started);
  WriteBatch batch;
  batch.request_digest = 5;
  batch.run_requests.emplace_back();
  EXPECT_TRUE(memory.Find("start")->IsRepeatedBy(batch));
  EXPECT_TRUE(memory.Find("old start")->IsRepeatedBy(batch));
  EXPECT_FALSE(memory.Find("old facts")->IsRepeatedBy(batch)) << "of which no run came";
  batch.request_digest = 6;
  EXPECT_FALSE(memory.Find("start")->IsRepeatedBy(batch));
  batch.run_requests.clear();
  EXPECT_TRUE(memory.Find("old facts")->IsRepeatedBy(batch));
  EXPECT_FALSE(memory.Find("old start")->IsRepeatedBy(batch));
}

TEST(QueryPortTest, GivesTheNewestAndWaits) {
  QueryPort port;
  EXPECT_EQ(port.Newest()->revision(), Revision(0));
  EXPECT_TRUE(port.WaitForRevision(Revision(0), absl::InfinitePast()).ok());
  absl::Status late = port.WaitForRevision(Revision(3), absl::Now() + absl::Milliseconds(5)).status();
  EXPECT_EQ(late.code(), absl::StatusCode::kDeadlineExceeded);
  EXPECT_THAT(std::string(late.message()), HasSubstr("revision 3 is not here yet; the newest is 0"));
}

TEST(QueryPortTest, AWaiterSeesThePublication) {
  QueryPort port;
  GraphWriter writer(nullptr);
  std::thread waiter([&port] {
    auto version = port.WaitForRevision(Revision(2), absl::InfiniteFuture());
    ASSERT_TRUE(version.ok());
    EXPECT_GE((*version)->revision(), Revision(2));
  });
  for (uint64_t revision = 1; revision <= 3; ++revision) port.Publish(writer.Freeze(Revision(revision)));
  waiter.join();
  EXPECT_EQ(port.Newest()->revision(), Revision(3));
}

}  // namespace
}  // namespace docent::server
