// SubscribeStream over gRPC: many queries on one stream, begun and ended one by one.
#include <atomic>
#include <map>
#include <set>
#include <thread>

#include "gmock/gmock.h"
#include "tests/kb_server/http/http_client.h"
#include "tests/kb_server/server_world.h"

namespace docent::server::test {
namespace {

using ::testing::HasSubstr;

class ServerSubscribeStreamTest : public ServerTest {
 protected:
  using Stream = grpc::ClientReaderWriter<v1::SubscribeStreamRequest, v1::SubscribeStreamReply>;

  ~ServerSubscribeStreamTest() override { CloseStream(); }

  void OpenStream() {
    stream_context_ = std::make_unique<grpc::ClientContext>();
    Limit(stream_context_.get());
    stream_ = context_->SubscribeStream(stream_context_.get());
    reply_.Clear();
    next_ = 0;
  }
  void CloseStream() {
    if (stream_ == nullptr) return;
    stream_context_->TryCancel();
    v1::SubscribeStreamReply rest;
    while (stream_->Read(&rest)) {
    }
    stream_->Finish();
    stream_.reset();
  }
  void Begin(uint64_t tag, const std::string& query, const std::string& resume = "",
             uint32_t interval_ms = 0) {
    v1::SubscribeStreamRequest request;
    request.set_tag(tag);
    request.mutable_begin()->set_query("PREFIX : <urn:w:> " + query);
    request.mutable_begin()->set_resume(resume);
    request.mutable_begin()->set_min_interval_ms(interval_ms);
    ASSERT_TRUE(stream_->Write(request));
  }
  void End(uint64_t tag) {
    v1::SubscribeStreamRequest request;
    request.set_tag(tag);
    request.mutable_end();
    ASSERT_TRUE(stream_->Write(request));
  }
  // The next part of any query; a part without a tag: the stream has ended.
  v1::SubscribeStreamReply::Part Next() {
    while (next_ == reply_.parts_size()) {
      next_ = 0;
      if (!stream_->Read(&reply_)) return {};
      ++replies_;
    }
    return reply_.parts(next_++);
  }
  // A client that leaves is noticed a moment later.
  bool OpenSubscriptionsBecome(int wanted) {
    const std::string line = absl::StrCat("docent_subscriptions ", wanted, "\n");
    for (const absl::Time end = absl::Now() + absl::Seconds(10); absl::Now() < end;) {
      if (HttpClient(http_port()).Ask("GET", "/metrics").body.find(line) != std::string::npos) return true;
      absl::SleepFor(absl::Milliseconds(5));
    }
    return false;
  }

  std::unique_ptr<grpc::ClientContext> stream_context_;
  std::unique_ptr<Stream> stream_;
  v1::SubscribeStreamReply reply_;
  int next_ = 0;
  int replies_ = 0;
};

TEST_F(ServerSubscribeStreamTest, EachQueryHasItsAnswerAndItsChangesInOrder) {
  StartServer();
  MustTell(":a :p 1 .");
  OpenStream();
  Begin(7, "SELECT ?v { :a :p ?v }");
  Begin(8, "ASK { :a :p 3 }");
  std::map<uint64_t, uint64_t> sequences;
  for (int i = 0; i < 2; ++i) {
    const auto part = Next();
    ASSERT_TRUE(part.has_reply());
    EXPECT_TRUE(part.reply().reset());
    sequences[part.tag()] = part.reply().sequence();
  }
  EXPECT_EQ(sequences, (std::map<uint64_t, uint64_t>{{7, 1}, {8, 1}}));
  for (int i = 2; i < 20; ++i) MustTell(absl::StrCat(":a :p ", i, " ."));
  uint64_t rows = 1;
  bool held = false;
  while (rows < 19 || !held) {
    const auto part = Next();
    ASSERT_TRUE(part.has_reply());
    EXPECT_EQ(part.reply().sequence(), ++sequences[part.tag()]);
    EXPECT_FALSE(part.reply().reset());
    rows += static_cast<uint64_t>(part.reply().appeared_size());
    held = held || part.reply().boolean();
  }
  EXPECT_EQ(sequences[7], 19u);
  EXPECT_EQ(sequences[8], 2u);
}

TEST_F(ServerSubscribeStreamTest, WhatMustLastIsToldByTheClockAlone) {
  StartServer();
  OpenStream();
  v1::SubscribeStreamRequest request;
  request.set_tag(1);
  request.mutable_begin()->set_query("SELECT ?v { <urn:w:a> <urn:w:p> ?v }");
  request.mutable_begin()->set_at_least_ms(300);
  ASSERT_TRUE(stream_->Write(request));
  EXPECT_EQ(Next().reply().appeared_size(), 0);
  const absl::Time told = absl::Now();
  MustTell(":a :p 1 .");
  const auto part = Next();
  ASSERT_EQ(part.reply().appeared_size(), 1);
  EXPECT_GE(absl::Now() - told, absl::Milliseconds(300));
  EXPECT_LE(absl::Now() - told, absl::Seconds(5));
}

TEST_F(ServerSubscribeStreamTest, WhoEndsHearsSoAndMayUseTheTagAgain) {
  StartServer();
  OpenStream();
  Begin(1, "ASK { :a :on true }");
  EXPECT_TRUE(Next().reply().reset());
  End(1);
  End(2);  // never begun: nothing happens
  auto part = Next();
  EXPECT_EQ(part.tag(), 1u);
  ASSERT_TRUE(part.has_ended());
  EXPECT_EQ(part.ended().code(), 0);
  MustTell(":a :on true . :b :on true .");  // of which nobody hears
  Begin(1, "ASK { :b :on true }");
  part = Next();
  EXPECT_EQ(part.tag(), 1u);
  EXPECT_TRUE(part.reply().reset());
  EXPECT_TRUE(part.reply().boolean());
}

TEST_F(ServerSubscribeStreamTest, ARefusedQueryEndsAloneWithItsPlace) {
  StartServer();
  OpenStream();
  Begin(1, "SELECT ?v { :a :p ?v ");
  Begin(2, "CONSTRUCT WHERE { :a :p ?v }");
  Begin(3, "ASK { :a :p 1 }");
  std::map<uint64_t, v1::SubscribeStreamReply::Part> parts;
  for (int i = 0; i < 3; ++i) {
    const auto part = Next();
    parts[part.tag()] = part;
  }
  EXPECT_EQ(parts[1].ended().code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_THAT(parts[1].ended().message(), HasSubstr("1:"));
  EXPECT_EQ(parts[2].ended().code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_TRUE(parts[3].reply().reset());
  MustTell(":a :p 1 .");
  EXPECT_TRUE(Next().reply().boolean());
}

TEST_F(ServerSubscribeStreamTest, ATagInUseAndAnEmptyRequestEndTheStream) {
  StartServer();
  OpenStream();
  Begin(1, "ASK { :a :p 1 }");
  EXPECT_TRUE(Next().reply().reset());
  Begin(1, "ASK { :a :p 2 }");
  EXPECT_EQ(Next().tag(), 0u);
  grpc::Status status = stream_->Finish();
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(status.error_message(), "tag 1 is in use");
  stream_.reset();
  EXPECT_TRUE(OpenSubscriptionsBecome(0));

  OpenStream();
  ASSERT_TRUE(stream_->Write({}));
  EXPECT_EQ(Next().tag(), 0u);
  status = stream_->Finish();
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  stream_.reset();
}

TEST_F(ServerSubscribeStreamTest, TheStreamOutlivesTheLastRequestAndEndsWithTheLastQuery) {
  settings_.subscription_limits.subscription_rows = 3;
  StartServer();
  OpenStream();
  Begin(5, "SELECT ?v { :a :p ?v }");
  ASSERT_TRUE(stream_->WritesDone());
  EXPECT_TRUE(Next().reply().reset());
  MustTell(":a :p 1 .");
  EXPECT_EQ(Next().reply().appeared_size(), 1);
  MustTell(":a :p 2, 3, 4 .");
  const auto part = Next();
  EXPECT_EQ(part.tag(), 5u);
  EXPECT_EQ(part.ended().code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_THAT(part.ended().message(), HasSubstr("subscription_rows"));
  EXPECT_EQ(Next().tag(), 0u);
  EXPECT_TRUE(stream_->Finish().ok());
  stream_.reset();
}

TEST_F(ServerSubscribeStreamTest, WhoComesBackHearsWhatWasMissedAndNothingTwice) {
  StartServer();
  OpenStream();
  Begin(1, "SELECT ?v { :a :p ?v }");
  EXPECT_TRUE(Next().reply().reset());
  MustTell(":a :p 1 .");
  const auto first = Next().reply();
  CloseStream();
  MustTell(":a :p 2 .");
  MustTell(":a :p 3 .");
  OpenStream();
  Begin(9, "SELECT ?v { :a :p ?v }", first.resume());
  std::set<std::string> ids = {first.id()};
  for (int i = 0; i < 2; ++i) {
    const auto part = Next();
    EXPECT_EQ(part.tag(), 9u);
    EXPECT_FALSE(part.reply().reset());
    EXPECT_TRUE(ids.insert(part.reply().id()).second);
  }
}

TEST_F(ServerSubscribeStreamTest, ThousandsOnOneStreamComeTogetherAndGoTogether) {
  StartServer();
  OpenStream();
  constexpr uint64_t kQueries = 2000;
  for (uint64_t tag = 1; tag <= kQueries; ++tag) Begin(tag, absl::StrCat("ASK { :x", tag, " :on true }"));
  for (uint64_t i = 0; i < kQueries; ++i) ASSERT_TRUE(Next().reply().reset());
  EXPECT_TRUE(OpenSubscriptionsBecome(kQueries));
  replies_ = 0;
  std::string facts;
  for (uint64_t tag = 1; tag <= kQueries; ++tag) absl::StrAppend(&facts, ":x", tag, " :on true . ");
  MustTell(facts);
  std::set<uint64_t> heard;
  for (uint64_t i = 0; i < kQueries; ++i) {
    const auto part = Next();
    EXPECT_TRUE(part.reply().boolean());
    heard.insert(part.tag());
  }
  EXPECT_EQ(heard.size(), kQueries);
  EXPECT_LT(replies_, 500);
  CloseStream();
  EXPECT_TRUE(OpenSubscriptionsBecome(0));
}

TEST_F(ServerSubscribeStreamTest, WhoEndsWhatCannotBeAnsweredCostsNoPlace) {
  settings_.subscription_limits.subscription_rows = 10;
  StartServer();
  std::string facts;
  for (int i = 0; i < 2000; ++i) absl::StrAppend(&facts, ":a :p ", i, " . ");
  MustTell(facts);
  OpenStream();
  for (uint64_t tag = 1; tag <= 600; ++tag) {
    Begin(tag, absl::StrCat("SELECT ?v { :a :p ?v, ?w FILTER(?v > ", tag, " && ?w > ?v) }"));
    End(tag);
  }
  Begin(1000, "ASK { :a :p 1 }");
  ASSERT_TRUE(stream_->WritesDone());
  std::set<uint64_t> ended;
  bool answered = false;
  while (ended.size() < 600 || !answered) {
    const auto part = Next();
    ASSERT_NE(part.tag(), 0u);
    if (part.has_ended()) {
      EXPECT_TRUE(ended.insert(part.tag()).second);
    }
    answered = answered || part.tag() == 1000;
  }
}

TEST_F(ServerSubscribeStreamTest, WhoDoesNotReadIsNotReadFrom) {
  StartServer();
  OpenStream();
  constexpr uint64_t kRequests = 6000;
  const std::string refused = "ASK { ?s " + std::string(8000, 'x') + ":p ?o }";  // the answer names it
  std::atomic<uint64_t> written{0};
  std::thread writer([&] {
    for (; written < kRequests; ++written) Begin(written + 1, refused);
    stream_->WritesDone();
  });
  uint64_t seen = 0;
  do {  // until nothing more goes through
    seen = written;
    absl::SleepFor(absl::Milliseconds(300));
  } while (written != seen);
  EXPECT_LT(written, kRequests / 2) << written;
  for (uint64_t i = 0; i < kRequests; ++i) ASSERT_TRUE(Next().has_ended()) << i;
  EXPECT_EQ(Next().tag(), 0u);
  writer.join();
  EXPECT_TRUE(stream_->Finish().ok());
  stream_.reset();
}

TEST_F(ServerSubscribeStreamTest, ThrottledChangesAreAddedUpAlsoWhereTheyAreNoLongerKept) {
  settings_.subscription_limits.subscription_changes_kept = 4;
  StartServer();
  OpenStream();
  const absl::Time begin = absl::Now();
  Begin(1, "SELECT ?v { :a :p ?v }", "",
        2000);  // long enough for thirty turns of a slow build on a busy machine
  EXPECT_TRUE(Next().reply().reset());
  for (int i = 0; i < 3; ++i) MustTell(absl::StrCat(":a :p ", i, " ."));
  auto part = Next();
  EXPECT_FALSE(part.reply().reset());
  EXPECT_EQ(part.reply().appeared_size(), 3);
  for (int i = 3; i < 30; ++i) MustTell(absl::StrCat(":a :p ", i, " ."));
  part = Next();
  EXPECT_TRUE(part.reply().reset());
  EXPECT_EQ(part.reply().appeared_size(), 30);
  EXPECT_GE(absl::Now() - begin, absl::Milliseconds(4000));
}

TEST_F(ServerSubscribeStreamTest, OneThatIsThrottledHoldsNobodyUp) {
  StartServer();
  OpenStream();
  Begin(1, "SELECT ?v { :a :p ?v }", "", 60000);
  Begin(2, "SELECT ?v { :a :p ?v }");
  for (int i = 0; i < 2; ++i) EXPECT_TRUE(Next().reply().reset());
  for (int i = 0; i < 10; ++i) {
    MustTell(absl::StrCat(":a :p ", i, " ."));
    EXPECT_EQ(Next().tag(), 2u);
  }
}

}  // namespace
}  // namespace docent::server::test
