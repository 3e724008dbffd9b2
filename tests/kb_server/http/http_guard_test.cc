#include "kb_server/http/http_guard.h"

#include <gtest/gtest.h>

namespace docent::server {
namespace {

TEST(HttpGuardTest, AnOriginIsSchemeHostAndPort) {
  for (const char* good :
       {"http://localhost:5173", "https://app.example.org", "http://127.0.0.1", "http://[::1]:80"})
    EXPECT_TRUE(HttpGuard::CheckOrigin(good).ok()) << good;
  for (const char* bad : {"", "*", "null", "localhost:5173", "ftp://a", "http://", "http://a/", "http://a/b",
                          "http://u@a", "http://a b", "http://*.example.org", "http://a,http://b",
                          "http://https://a", "http://a:x", "http://a:99999"})
    EXPECT_TRUE(absl::IsInvalidArgument(HttpGuard::CheckOrigin(bad))) << bad;
}

TEST(HttpGuardTest, ANameIsAHostWithOrWithoutPort) {
  for (const char* good : {"robots.example.org", "robots:7480", "192.0.2.1", "[2001:db8::1]:80"})
    EXPECT_TRUE(HttpGuard::CheckName(good).ok()) << good;
  for (const char* bad : {"", "http://x/", "x/", "u@x", "a b", "*.example.org", "x:", "x:y", ":80"})
    EXPECT_TRUE(absl::IsInvalidArgument(HttpGuard::CheckName(bad))) << bad;
}

HttpRequest From(const std::string& origin, const std::string& method = "GET") {
  HttpRequest request;
  request.method = method;
  request.headers = {{"host", "localhost:7480"}};
  if (!origin.empty()) request.headers.emplace_back("origin", origin);
  return request;
}

TEST(HttpGuardTest, APageOfAnotherSiteThatSendsNoOriginIsToldByItsBrowser) {
  HttpRequest request = From("");
  EXPECT_FALSE(RefuseAnotherSite(request));
  for (const auto& [site, refused] : {std::pair("cross-site", true), std::pair("same-site", true),
                                      std::pair("same-origin", false), std::pair("none", false)}) {
    request.headers = {{"host", "localhost:7480"}, {"sec-fetch-site", site}};
    EXPECT_EQ(RefuseAnotherSite(request).has_value(), refused) << site;
    request.headers.emplace_back("origin", "http://a");  // which Refuse looks at
    EXPECT_FALSE(RefuseAnotherSite(request)) << site;
  }
}

TEST(HttpGuardTest, OnlyTheOriginsThatAreAllowedShareAnswers) {
  const HttpGuard guard(7480, {}, {"http://app.example:5173"});
  EXPECT_FALSE(guard.Refuse(From("http://app.example:5173")));
  EXPECT_EQ(guard.SharedWith(From("http://app.example:5173")).front().second, "http://app.example:5173");
  EXPECT_TRUE(guard.Refuse(From("http://app.example")));
  EXPECT_TRUE(guard.Refuse(From("https://app.example:5173")));
  EXPECT_TRUE(guard.Refuse(From("null")));
  EXPECT_TRUE(guard.SharedWith(From("http://localhost:7480")).empty());  // its own page needs nothing
  EXPECT_TRUE(guard.SharedWith(From("")).empty());
  EXPECT_TRUE(HttpGuard(7480, {}).SharedWith(From("http://app.example:5173")).empty());
}

TEST(HttpGuardTest, PreflightsAreAnsweredForThem) {
  const HttpGuard guard(7480, {}, {"http://a"});
  HttpRequest asks = From("http://a", "OPTIONS");
  EXPECT_FALSE(guard.Preflight(asks));  // no preflight
  asks.headers.emplace_back("access-control-request-method", "POST");
  ASSERT_TRUE(guard.Preflight(asks));
  EXPECT_EQ(guard.Preflight(asks)->status, 200);
  asks.method = "GET";
  EXPECT_FALSE(guard.Preflight(asks));
  HttpRequest own = From("http://localhost:7480", "OPTIONS");
  own.headers.emplace_back("access-control-request-method", "POST");
  EXPECT_FALSE(guard.Preflight(own));
}

}  // namespace
}  // namespace docent::server
