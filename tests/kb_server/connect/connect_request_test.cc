#include "kb_server/connect/connect_request.h"

#include <gmock/gmock.h>
#include <google/protobuf/descriptor.h>
#include <gtest/gtest.h>

#include "docent/v1/context.pb.h"
#include "docent/v1/fleet.pb.h"
#include "docent/v1/workflows.pb.h"
#include "graph/base/gzip.h"
#include "graph/base/network_limits.h"
#include "graph/base/overload.h"
#include "kb_server/connect/connect_envelope.h"
#include "kb_server/door/message_sizes.h"

namespace docent::server {
namespace {

using ::testing::HasSubstr;

const google::protobuf::MethodDescriptor& Method(const std::string& service, const std::string& name) {
  (void)v1::AssertRequest::descriptor();  // so that the files are linked
  (void)v1::ListRobotsRequest::descriptor();
  (void)v1::WatchRequest::descriptor();
  return *FindService("docent.v1." + service)->FindMethodByName(name);
}

HttpRequest Post(const std::string& type, const std::string& body, HttpFields more = {}) {
  HttpRequest http;
  http.method = "POST";
  http.headers = {{"content-type", type}};
  http.headers.insert(http.headers.end(), more.begin(), more.end());
  http.body = body;
  return http;
}

HttpRequest Get(HttpFields parameters, HttpFields headers = {}) {
  HttpRequest http;
  http.method = "GET";
  http.parameters = std::move(parameters);
  http.headers = std::move(headers);
  return http;
}

struct Read {
  int status = 0;  // 0: the head is good
  std::string error;
  HttpFields headers;
  ConnectHead head;
  absl::StatusOr<std::vector<std::string>> messages = absl::UnknownError("not read");
};

Read ReadAll(const HttpRequest& http, const google::protobuf::MethodDescriptor& method, Limits limits = {}) {
  Read read;
  if (auto refusal = ReadConnectHead(http, method, &read.head)) {
    read.status = refusal->status;
    read.error = refusal->body;
    read.headers = refusal->headers;
    return read;
  }
  read.messages = ReadConnectMessages(http, method, read.head, limits);
  return read;
}

TEST(ConnectRequestTest, UnaryMessagesInJsonAndBinary) {
  v1::UpdateRequest update;
  update.set_update("INSERT DATA { <urn:ü> <urn:b> \"q\\\"\" }");
  update.set_min_revision(7);
  const std::string binary = update.SerializeAsString();
  const auto& method = Method("Context", "Update");
  const Read json =
      ReadAll(Post("application/json; charset=utf-8",
                   R"({"update":"INSERT DATA { <urn:\u00fc> <urn:b> \"q\\\"\" }","minRevision":"7"})"),
              method);
  ASSERT_TRUE(json.messages.ok()) << json.error << json.messages.status();
  EXPECT_EQ(json.messages->front(), binary);
  const Read proto = ReadAll(Post("application/proto", binary), method);
  ASSERT_TRUE(proto.messages.ok());
  EXPECT_EQ(proto.messages->front(), binary);
  EXPECT_EQ(proto.head.codec, MessageCodec::kProto);
  const Read packed =
      ReadAll(Post("application/proto", Gzip(binary), {{"content-encoding", "gzip"}}), method);
  ASSERT_TRUE(packed.messages.ok());
  EXPECT_EQ(packed.messages->front(), binary);
  EXPECT_EQ(*ReadAll(Post("application/json", ""), method).messages, std::vector<std::string>{""});
}

TEST(ConnectRequestTest, AFieldThatIsNotThereIsAnErrorAndNotDropped) {
  const Read read = ReadAll(Post("application/json", R"({"updat":"x"})"), Method("Context", "Update"));
  EXPECT_TRUE(absl::IsInvalidArgument(read.messages.status()));
  EXPECT_THAT(read.messages.status().message(), HasSubstr("docent.v1.UpdateRequest"));
  EXPECT_THAT(read.messages.status().message(), HasSubstr("updat"));
  for (const char* body :
       {"{", "[]", "7", "{\"update\":7}", "{\"minRevision\":\"x\"}", "{\"update\":\"\xff\"}"}) {
    EXPECT_TRUE(absl::IsInvalidArgument(
        ReadAll(Post("application/json", body), Method("Context", "Update")).messages.status()))
        << body;
  }
  EXPECT_TRUE(absl::IsInvalidArgument(
      ReadAll(Post("application/proto", "\x0a\x7f"), Method("Context", "Update")).messages.status()));
}

TEST(ConnectRequestTest, GetIsForMethodsThatOnlyRead) {
  const auto& list = Method("Workflows", "ListRuns");
  const Read json =
      ReadAll(Get({{"encoding", "json"}, {"message", R"({"liveOnly":true})"}, {"connect", "v1"}}), list);
  ASSERT_TRUE(json.messages.ok()) << json.error;
  v1::ListRunsRequest request;
  ASSERT_TRUE(request.ParseFromString(json.messages->front()));
  EXPECT_TRUE(request.live_only());
  // Base64 in the alphabet of URLs, with and without padding.
  for (const char* message : {"CAE", "CAE="}) {
    const Read proto = ReadAll(Get({{"encoding", "proto"}, {"message", message}, {"base64", "1"}}), list);
    ASSERT_TRUE(proto.messages.ok()) << proto.error << proto.messages.status();
    EXPECT_EQ(proto.messages->front(), request.SerializeAsString());
  }
  const Read writes = ReadAll(Get({{"encoding", "json"}, {"message", "{}"}}), Method("Workflows", "Start"));
  EXPECT_EQ(writes.status, 405);
  EXPECT_EQ(writes.headers.back(), std::make_pair(std::string("Allow"), std::string("POST")));
  EXPECT_EQ(ReadAll(Get({{"encoding", "json"}}), Method("Workflows", "Watch")).status, 405);
  EXPECT_EQ(ReadAll(Get({}), list).status, 400);
  EXPECT_EQ(ReadAll(Get({{"encoding", "json"}, {"connect", "v2"}}), list).status, 400);
  EXPECT_TRUE(absl::IsInvalidArgument(
      ReadAll(Get({{"encoding", "proto"}, {"message", "!!"}, {"base64", "1"}}), list).messages.status()));
  const std::string packed = Gzip("{}");
  EXPECT_TRUE(
      ReadAll(Get({{"encoding", "json"}, {"message", packed}, {"compression", "gzip"}}), list).messages.ok());
}

TEST(ConnectRequestTest, APageOfAnotherSiteGetsNothing) {
  const HttpFields parameters = {{"encoding", "json"}, {"message", "{}"}};
  const auto& list = Method("Fleet", "List");
  EXPECT_EQ(ReadAll(Get(parameters, {{"sec-fetch-site", "cross-site"}}), list).status, 403);
  EXPECT_EQ(ReadAll(Get(parameters, {{"sec-fetch-site", "same-site"}}), list).status, 403);
  EXPECT_EQ(ReadAll(Get(parameters, {{"sec-fetch-site", "same-origin"}}), list).status, 0);
  EXPECT_EQ(ReadAll(Get(parameters, {{"sec-fetch-site", "none"}}), list).status, 0);
  // The guard has let this origin pass.
  EXPECT_EQ(ReadAll(Get(parameters, {{"sec-fetch-site", "cross-site"}, {"origin", "http://a"}}), list).status,
            0);
  // What a form of another page can send.
  for (const char* type : {"text/plain", "application/x-www-form-urlencoded", "multipart/form-data", ""}) {
    const Read read = ReadAll(Post(type, "{}"), list);
    EXPECT_EQ(read.status, 415) << type;
    EXPECT_EQ(read.headers.back(),
              std::make_pair(std::string("Accept-Post"), std::string("application/json, application/proto")));
  }
}

TEST(ConnectRequestTest, StreamsAreEnveloped) {
  const auto& watch = Method("Workflows", "Watch");
  const Read json = ReadAll(Post("application/connect+json", Enveloped(0, R"({"run":"r1"})")), watch);
  ASSERT_TRUE(json.messages.ok()) << json.error << json.messages.status();
  EXPECT_EQ(json.messages->size(), 1u);
  EXPECT_EQ(ReadAll(Post("application/json", "{}"), watch).status, 415);
  EXPECT_EQ(ReadAll(Post("application/connect+json", ""), Method("Fleet", "List")).status, 415);
  EXPECT_TRUE(absl::IsUnimplemented(ReadAll(Post("application/connect+json", ""), watch).messages.status()));
  const std::string two = Enveloped(0, "{}") + Enveloped(0, "{}");
  EXPECT_TRUE(absl::IsUnimplemented(ReadAll(Post("application/connect+json", two), watch).messages.status()));
  const auto& stream = Method("Context", "AssertStream");
  EXPECT_EQ(ReadAll(Post("application/connect+json", two), stream).messages->size(), 2u);
  const std::string packed = Enveloped(kCompressedFlag, Gzip("{}"));
  EXPECT_TRUE(
      absl::IsInvalidArgument(ReadAll(Post("application/connect+json", packed), watch).messages.status()));
  EXPECT_TRUE(ReadAll(Post("application/connect+json", packed, {{"connect-content-encoding", "gzip"}}), watch)
                  .messages.ok());
  for (const std::string& bad : {std::string("\0\0\0", 3), std::string("\0\0\0\0\x05{}", 7),
                                 Enveloped(kEndStreamFlag, "{}"), std::string("\0\xff\xff\xff\xff{}", 7)}) {
    EXPECT_TRUE(
        absl::IsInvalidArgument(ReadAll(Post("application/connect+json", bad), watch).messages.status()));
  }
  Limits limits;
  limits.stream_messages = 1;
  EXPECT_TRUE(absl::IsResourceExhausted(
      ReadAll(Post("application/connect+json", two), stream, limits).messages.status()));
}

TEST(ConnectRequestTest, VersionTimeoutAndCompressionAreChecked) {
  const auto& list = Method("Fleet", "List");
  const auto with = [&](HttpFields more) {
    return ReadAll(Post("application/json", "{}", std::move(more)), list);
  };
  EXPECT_EQ(with({{"connect-protocol-version", "1"}}).status, 0);
  EXPECT_EQ(with({{"connect-protocol-version", "2"}}).status, 400);
  EXPECT_EQ(with({{"connect-timeout-ms", "1500"}}).head.timeout, absl::Milliseconds(1500));
  EXPECT_EQ(with({}).head.timeout, absl::InfiniteDuration());
  for (const char* bad : {"-1", "1s", "12345678901", "1.5"})
    EXPECT_EQ(with({{"connect-timeout-ms", bad}}).status, 400) << bad;
  const Read br = with({{"content-encoding", "br"}});
  EXPECT_EQ(br.status, 501);
  EXPECT_THAT(br.error, HasSubstr("\"code\":\"unimplemented\""));
  EXPECT_EQ(br.headers.back().first, "Accept-Encoding");
  EXPECT_TRUE(with({{"accept-encoding", "br, gzip;q=0.5"}}).head.gzip_reply);
  EXPECT_FALSE(with({{"accept-encoding", "br, gzip;q=0"}}).head.gzip_reply);
  EXPECT_FALSE(with({}).head.gzip_reply);
}

TEST(ConnectRequestTest, WhatUnpacksToTooMuchIsRefusedByTheLimit) {
  Limits limits;
  limits.http_body_bytes = 1000;
  const std::string text = R"({"update":")" + std::string(2000, 'x') + "\"}";
  const Read read = ReadAll(Post("application/json", Gzip(text), {{"content-encoding", "gzip"}}),
                            Method("Context", "Update"), limits);
  EXPECT_TRUE(absl::IsResourceExhausted(read.messages.status()));
  EXPECT_THAT(read.messages.status().message(), HasSubstr("http_body_bytes"));
  const std::string one = Enveloped(1, Gzip(R"({"requestId":")" + std::string(900, 'x') + "\"}"));
  EXPECT_TRUE(absl::IsResourceExhausted(
      ReadAll(Post("application/connect+json", one + one, {{"connect-content-encoding", "gzip"}}),
              Method("Context", "AssertStream"), limits)
          .messages.status()));
}

TEST(ConnectRequestTest, AMessageIsNoLargerThanItsMethodTakes) {
  const auto& list = Method("Fleet", "List");
  const size_t most = LargestJson("docent.v1.Fleet.List", Limits{}, kNetworkLimits).bytes;
  const std::string text = "{" + std::string(most - 2, ' ') + "}";
  EXPECT_TRUE(ReadAll(Post("application/json", text), list).messages.ok());
  const HttpFields gzip = {{"content-encoding", "gzip"}};
  EXPECT_TRUE(ReadAll(Post("application/json", Gzip(text), gzip), list).messages.ok());
  for (const auto& read : {ReadAll(Post("application/json", text + " "), list),
                           ReadAll(Post("application/json", Gzip(text + " "), gzip), list)}) {
    EXPECT_TRUE(absl::IsResourceExhausted(read.messages.status())) << read.messages.status();
    EXPECT_THAT(read.messages.status().message(), HasSubstr("request_bytes"));
  }
}

// "{}," becomes a Quad of some hundred bytes.
TEST(ConnectRequestTest, PartsCountAsTheMemoryThatTheyBecome) {
  const auto& method = Method("Context", "Assert");
  std::string json = R"({"add":[{})";
  for (int i = 0; i < 5000000; ++i) json += ",{}";
  const Read read = ReadAll(Post("application/json", json + "]}"), method);
  EXPECT_TRUE(absl::IsResourceExhausted(read.messages.status())) << read.messages.status();
  EXPECT_THAT(read.messages.status().message(), HasSubstr("request_memory_bytes"));
  std::string binary;
  for (int i = 0; i < 5000000; ++i) binary += std::string("\x1a\0", 2);
  EXPECT_TRUE(
      absl::IsResourceExhausted(ReadAll(Post("application/proto", binary), method).messages.status()));
}

TEST(ConnectRequestTest, WhatIsUnpackedAndConvertedCountsInTheRequestsMemory) {
  const auto& method = Method("Context", "Update");
  MemoryBudget all("some_bytes", 8u << 20);
  const auto read = [&](size_t bytes, MemoryUse* memory) {
    const HttpRequest http =
        Post("application/json", Gzip(R"({"update":")" + std::string(bytes, ' ') + "\"}"),
             {{"content-encoding", "gzip"}});
    ConnectHead head;
    EXPECT_FALSE(ReadConnectHead(http, method, &head));
    return ReadConnectMessages(http, method, head, Limits{}, memory);
  };
  {
    MemoryUse memory(SIZE_MAX, &all);
    const auto messages = read(1u << 20, &memory);
    ASSERT_TRUE(messages.ok()) << messages.status();
    EXPECT_EQ(memory.used(), messages->front().size()) << "the text and the conversion are given back";
  }
  EXPECT_EQ(all.taken(), 0u);
  for (const size_t bytes : {3u << 20, 15u << 20}) {  // its conversion is too much; it is itself
    MemoryUse memory(SIZE_MAX, &all);
    const absl::Status refused = read(bytes, &memory).status();
    EXPECT_TRUE(IsOverload(refused)) << refused;
    EXPECT_THAT(refused.message(), HasSubstr("some_bytes"));
    EXPECT_EQ(memory.used(), 0u);
  }
}

}  // namespace
}  // namespace docent::server
