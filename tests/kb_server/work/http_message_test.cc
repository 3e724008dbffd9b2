#include "kb_server/work/http_message.h"
#include "graph/base/overload.h"

#include <gtest/gtest.h>

namespace docent::server {
namespace {

using Types = std::vector<std::string_view>;

TEST(HttpMessageTest, PercentDecoding) {
  EXPECT_EQ(PercentDecode("a%20b+c", false), "a b+c");
  EXPECT_EQ(PercentDecode("a%20b+c", true), "a b c");
  EXPECT_EQ(PercentDecode("%e2%82%AC", true), "€");
  for (const char* bad : {"%", "%4", "%g0", "%0g", "%00"})
    EXPECT_EQ(PercentDecode(bad, true), std::nullopt) << bad;
}

TEST(HttpMessageTest, Forms) {
  EXPECT_EQ(*ParseForm(""), HttpFields{});
  EXPECT_EQ(*ParseForm("a=1&&b=x%3Dy&a=&c"), (HttpFields{{"a", "1"}, {"b", "x=y"}, {"a", ""}, {"c", ""}}));
  EXPECT_EQ(ParseForm("a=1&b=%").status().message(), "there is a broken %-escape");
  EXPECT_EQ(ParseForm("a&b&c", 3)->size(), 3u);
  EXPECT_EQ(ParseForm("a&b&c", 2).status().message(),
            "there are more parameters than the limit http_parameters = 2");
}

TEST(HttpMessageTest, HeadersOfOneNameAreJoined) {
  HttpRequest request;
  request.headers = {{"accept", "text/csv"}, {"host", "h"}, {"accept", "*/*"}};
  EXPECT_EQ(request.Header("accept"), "text/csv, */*");
  EXPECT_EQ(request.Header("origin"), "");
}

TEST(HttpMessageTest, MediaTypes) {
  EXPECT_EQ(MediaTypeOnly("Text/Turtle ; charset=UTF-8"), "text/turtle");
  EXPECT_EQ(MediaTypeOnly(""), "");
}

TEST(HttpMessageTest, ContentNegotiation) {
  const Types offered = {"application/sparql-results+json", "text/csv", "application/xml"};
  EXPECT_EQ(ChooseMediaType("", offered), 0u);
  EXPECT_EQ(ChooseMediaType("*/*", offered), 0u);
  EXPECT_EQ(ChooseMediaType("text/csv", offered), 1u);
  EXPECT_EQ(ChooseMediaType("TEXT/CSV", offered), 1u);
  EXPECT_EQ(ChooseMediaType("text/*", offered), 1u);
  EXPECT_EQ(ChooseMediaType("application/*;q=0.2, text/csv;q=0.1", offered), 0u);
  EXPECT_EQ(ChooseMediaType("text/csv;q=0.5, application/xml;q=0.9", offered), 2u);
  EXPECT_EQ(ChooseMediaType("*/*;q=0.1, application/xml", offered), 2u);
  // The more specific range decides, not the wildcard.
  EXPECT_EQ(ChooseMediaType("*/*, application/sparql-results+json;q=0", offered), 1u);
  EXPECT_EQ(ChooseMediaType("image/png", offered), std::nullopt);
  EXPECT_EQ(ChooseMediaType("text/csv;q=0", offered), std::nullopt);
  EXPECT_EQ(ChooseMediaType("text/csv;q=x", offered), std::nullopt);
  EXPECT_EQ(ChooseMediaType("", {}), std::nullopt);
  // What a browser sends.
  EXPECT_EQ(ChooseMediaType("text/html,application/xhtml+xml,application/xml;q=0.9,*/*;q=0.8", offered), 2u);
}

TEST(HttpMessageTest, StatusCodes) {
  EXPECT_EQ(ErrorResponse(absl::InvalidArgumentError("line 1")).status, 400);
  EXPECT_EQ(ErrorResponse(absl::InvalidArgumentError("line 1")).body, "line 1\n");
  EXPECT_EQ(ErrorResponse(absl::DeadlineExceededError("")).status, 504);
  EXPECT_EQ(ErrorResponse(absl::ResourceExhaustedError("")).status, 413);
  EXPECT_EQ(ErrorResponse(OverloadError("")).status, 503);
  EXPECT_EQ(ErrorResponse(OverloadError("")).headers, (HttpFields{{"Retry-After", "1"}}));
  EXPECT_EQ(ErrorResponse(absl::UnimplementedError("")).status, 501);
  EXPECT_EQ(ErrorResponse(absl::InternalError("")).status, 500);
}

}  // namespace
}  // namespace docent::server
