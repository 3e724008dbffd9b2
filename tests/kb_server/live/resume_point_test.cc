#include "kb_server/live/resume_point.h"

#include <google/protobuf/descriptor.h>
#include <gtest/gtest.h>

#include "docent/v1/context.pb.h"
#include "docent/v1/workflows.pb.h"
#include "kb_server/connect/message_codec.h"

namespace docent::server {
namespace {

const google::protobuf::MethodDescriptor& Method(const std::string& service, const std::string& name) {
  (void)v1::SubscribeRequest::descriptor();
  (void)v1::WatchRequest::descriptor();
  return *FindService("docent.v1." + service)->FindMethodByName(name);
}

// What a stream of turns {1 event in turn 3, 4 in turn 7, 2 in turn 9} says after `after`.
std::vector<v1::RunEvent> EventsAfter(uint64_t after) {
  std::vector<v1::RunEvent> events;
  for (const auto& [revision, count] : std::vector<std::pair<uint64_t, int>>{{3, 1}, {7, 4}, {9, 2}}) {
    for (int i = 0; i < count && revision > after; ++i) {
      events.emplace_back().set_revision(revision);
      events.back().set_detail(std::to_string(revision) + "." + std::to_string(i));
    }
  }
  return events;
}

// Wherever the connection is lost, nothing is lost and nothing comes twice.
TEST(ResumePointTest, TurnsGoOnAfterEachEvent) {
  const auto& watch = Method("Workflows", "Watch");
  const std::vector<v1::RunEvent> all = EventsAfter(2);
  for (size_t cut = 0; cut <= all.size(); ++cut) {
    for (size_t again = cut; again <= all.size(); ++again) {  // it is lost a second time
      std::string got, place;
      size_t seen = 0;
      for (const size_t until : {cut, again, all.size()}) {
        v1::WatchRequest request;
        ResumePoint point(watch);
        ASSERT_TRUE(point.Begin(place, /*newest=*/2, &request).ok());
        place = *point.first();
        for (const v1::RunEvent& event : EventsAfter(request.after())) {
          if (seen == until) break;
          if (!point.IsNew(event)) continue;
          got += event.detail() + " ";
          place = *point.Next(event);
          ++seen;
        }
      }
      EXPECT_EQ(got, "3.0 7.0 7.1 7.2 7.3 9.0 9.1 ") << cut << " " << again;
    }
  }
}

TEST(ResumePointTest, AStreamOfTurnsBeginsAtTheNewestOrWhereItIsAsked) {
  const auto& watch = Method("Workflows", "Watch");
  v1::WatchRequest request;
  ResumePoint point(watch);
  ASSERT_TRUE(point.Begin("", 41, &request).ok());
  EXPECT_EQ(request.after(), 41u);
  EXPECT_EQ(*point.first(), "41:0");
  request.set_after(7);
  ResumePoint asked(watch);
  ASSERT_TRUE(asked.Begin("", 41, &request).ok());
  EXPECT_EQ(*asked.first(), "7:0");
  for (const char* bad : {"x", "1", "1:2:3", "1:-1", ":", "1:18446744073709551616"})
    EXPECT_TRUE(absl::IsInvalidArgument(ResumePoint(watch).Begin(bad, 41, &request))) << bad;
}

TEST(ResumePointTest, SubscriptionsHaveTheirOwnPlaces) {
  const auto& subscribe = Method("Context", "Subscribe");
  v1::SubscribeRequest request;
  ResumePoint point(subscribe);
  ASSERT_TRUE(point.Begin("there", 41, &request).ok());
  EXPECT_EQ(request.resume(), "there");
  EXPECT_FALSE(point.first());
  v1::SubscribeReply reply;
  reply.set_resume("here");
  EXPECT_TRUE(point.IsNew(reply));
  EXPECT_EQ(*point.Next(reply), "here");
  reply.set_more(true);  // a change is whole with its last part
  EXPECT_FALSE(point.Next(reply));
}

TEST(ResumePointTest, OthersHaveNone) {
  v1::QueryRequest request;
  ResumePoint point(Method("Context", "Query"));
  ASSERT_TRUE(point.Begin("x", 41, &request).ok());
  EXPECT_FALSE(point.first());
  EXPECT_FALSE(point.Next(v1::QueryReply()));
}

}  // namespace
}  // namespace docent::server
