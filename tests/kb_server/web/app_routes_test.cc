#include "kb_server/web/app_routes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "absl/strings/str_cat.h"
#include "graph/base/gzip.h"
#include "tests/kb_server/http/http_client.h"

namespace docent::server {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

class AppRoutesTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        fs::path(::testing::TempDir()) /
        absl::StrCat("app-", getpid(), "-", ::testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_ / "assets");
  }
  void TearDown() override {
    server_.reset();
    fs::remove_all(folder_);
  }
  void Put(const std::string& name, const std::string& text) {
    fs::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }
  void Start() {
    if (fs::exists(folder_ / "index.html")) {
      absl::StatusOr<AppFiles> app = AppFiles::Read(folder_.string());
      ASSERT_TRUE(app.ok()) << app.status();
      app_ = *std::move(app);
    }
    HttpRoutes routes;
    routes.Add("GET", "/healthz",
               [](std::shared_ptr<HttpExchange> e) { e->Respond(TextResponse(200, "ok")); });
    AddAppRoutes(&routes, &app_);
    HttpServerOptions options;
    options.listen = "127.0.0.1:0";
    server_ = *HttpServer::Start(options, std::move(routes));
  }
  HttpReply Get(const std::string& path, const std::string& headers = "", const std::string& method = "GET") {
    return HttpClient(server_->port()).Ask(method, path, headers);
  }

  fs::path folder_;
  AppFiles app_;
  std::unique_ptr<HttpServer> server_;
};

TEST_F(AppRoutesTest, WithoutAnAppThePageSaysSo) {
  Start();
  const HttpReply page = Get("/");
  EXPECT_EQ(page.status, 200);
  EXPECT_EQ(page.headers.at("content-type"), "text/html; charset=utf-8");
  EXPECT_THAT(page.body, HasSubstr("not installed"));
  EXPECT_THAT(page.headers.at("content-security-policy"), HasSubstr("default-src 'none'"));
  EXPECT_EQ(Get("/runs", "Accept: text/html\r\n").status, 404);
  EXPECT_EQ(Get("/healthz").body, "ok\n");
}

TEST_F(AppRoutesTest, FilesHaveTypesTagsAndPackedForms) {
  const std::string script(5000, 'x');
  Put("index.html", "<!doctype html>");
  Put("assets/index-B3xY9_aQ.js", script);
  Put("assets/style.css", "a{}");
  Put("assets/style.css.br", "brotli");
  Put("logo.png", std::string(3000, 'p'));
  Put("visit.html", "visit");
  Put("robot/index.html", "robot");
  Start();
  const HttpReply plain = Get("/assets/index-B3xY9_aQ.js");
  EXPECT_EQ(plain.body, script);
  EXPECT_EQ(plain.headers.at("content-type"), "text/javascript; charset=utf-8");
  EXPECT_EQ(plain.headers.at("cache-control"), "public, max-age=31536000, immutable");
  EXPECT_EQ(plain.headers.at("vary"), "Accept-Encoding");
  const HttpReply packed = Get("/assets/index-B3xY9_aQ.js", "Accept-Encoding: gzip, deflate, br\r\n");
  EXPECT_EQ(packed.headers.at("content-encoding"), "gzip");
  EXPECT_EQ(*Gunzip(packed.body, 1u << 20, "x"), script);
  EXPECT_NE(packed.headers.at("etag"), plain.headers.at("etag"));
  const HttpReply style = Get("/assets/style.css", "Accept-Encoding: gzip, br\r\n");
  EXPECT_EQ(style.headers.at("content-encoding"), "br");
  EXPECT_EQ(style.body, "brotli");
  EXPECT_EQ(style.headers.at("cache-control"), "no-cache");
  EXPECT_EQ(Get("/assets/style.css", "Accept-Encoding: br;q=0\r\n").body, "a{}");
  EXPECT_EQ(Get("/assets/style.css.br").status, 404);
  EXPECT_EQ(Get("/logo.png", "Accept-Encoding: gzip\r\n").headers.count("content-encoding"), 0u);
  EXPECT_EQ(Get("/visit").body, "visit");
  EXPECT_EQ(Get("/robot").body, "robot");
  EXPECT_EQ(Get("/robot/").body, "robot");
  const std::string etag = style.headers.at("etag");
  const HttpReply same =
      Get("/assets/style.css",
          "Connection: close\r\nAccept-Encoding: br\r\nIf-None-Match: \"x\", W/" + etag + "\r\n");
  EXPECT_EQ(same.status, 304);
  EXPECT_EQ(same.headers.at("etag"), etag);
  EXPECT_EQ(same.headers.count("content-length"), 0u);
  EXPECT_EQ(Get("/assets/style.css", "If-None-Match: " + etag + "\r\n").status, 200);  // another form
}

TEST_F(AppRoutesTest, ViewsGetThePageAndProgramsGetAnError) {
  Put("index.html", "<!doctype html>the app");
  Start();
  EXPECT_EQ(Get("/").body, "<!doctype html>the app");
  const HttpReply view =
      Get("/runs/BoothGuide-1?time=7", "Accept: text/html,application/xhtml+xml;q=0.9\r\n");
  EXPECT_EQ(view.status, 200);
  EXPECT_EQ(view.body, "<!doctype html>the app");
  EXPECT_EQ(Get("/runs", "Accept: text/html\r\n", "HEAD").status, 200);
  EXPECT_EQ(Get("/runs").status, 404);
  EXPECT_EQ(Get("/nothing.js", "Accept: text/html\r\n").status, 404);
  EXPECT_EQ(Get("/runs", "Accept: text/html\r\n", "POST").status, 404);
  EXPECT_EQ(Get("/../../etc/passwd").status, 404);
  EXPECT_EQ(Get("/%2e%2e/%2e%2e/etc/passwd").status, 404);
  EXPECT_EQ(Get("/healthz", "Accept: text/html\r\n").body, "ok\n");
}

TEST_F(AppRoutesTest, EachPageHasANonceOfItsOwn) {
  Put("index.html",
      "<meta property=\"csp-nonce\" nonce=\"docent-csp-nonce\"><script nonce=\"docent-csp-nonce\">");
  Start();
  const HttpReply one = Get("/"), other = Get("/");
  EXPECT_NE(one.body, other.body);
  EXPECT_EQ(one.headers.at("cache-control"), "no-store");
  const size_t begin = one.body.find("nonce=\"", 20) + 7;
  const std::string nonce = one.body.substr(begin, one.body.find('"', begin) - begin);
  EXPECT_EQ(nonce.size(), 24u);
  const std::string& policy = one.headers.at("content-security-policy");
  EXPECT_THAT(policy, HasSubstr("script-src 'self' 'nonce-" + nonce + "'"));
  EXPECT_THAT(policy, HasSubstr("style-src 'self' 'nonce-" + nonce + "'"));
  EXPECT_THAT(policy, ::testing::Not(HasSubstr("unsafe")));
}

TEST_F(AppRoutesTest, NamesWithAHashAreKeptForEver) {
  EXPECT_TRUE(IsHashedName("/assets/index-B3xY9_aQ.js"));
  EXPECT_TRUE(IsHashedName("/assets/index.0123abcd.css"));
  EXPECT_TRUE(IsHashedName("/x/assets/a-b-c-DEADBEEF.woff2"));
  EXPECT_FALSE(IsHashedName("/index-B3xY9_aQ.js"));
  EXPECT_FALSE(IsHashedName("/assets/index.js"));
  EXPECT_FALSE(IsHashedName("/assets/style-dark.css"));
  EXPECT_FALSE(IsHashedName("/assets/B3xY9_aQ.js"));
}

TEST_F(AppRoutesTest, AFolderWithoutAnAppIsAnError) {
  EXPECT_TRUE(absl::IsNotFound(AppFiles::Read((folder_ / "none").string()).status()));
  const absl::Status status = AppFiles::Read(folder_.string()).status();
  EXPECT_TRUE(absl::IsNotFound(status));
  EXPECT_THAT(status.message(), HasSubstr("index.html"));
}

TEST_F(AppRoutesTest, MoreThanTheLimitsIsRefused) {
  Put("index.html", "xyz");
  Put("one", "12");
  WebLimits limits;
  limits.web_files = 2;
  limits.web_bytes = 5;
  EXPECT_TRUE(AppFiles::Read(folder_.string(), limits).ok());
  limits.web_bytes = 4;
  EXPECT_THAT(AppFiles::Read(folder_.string(), limits).status().message(), HasSubstr("web_bytes = 4"));
  limits = {};
  limits.web_files = 1;
  const absl::Status status = AppFiles::Read(folder_.string(), limits).status();
  EXPECT_TRUE(absl::IsResourceExhausted(status));
  EXPECT_THAT(status.message(), HasSubstr("web_files = 1"));
}

TEST_F(AppRoutesTest, TheCodeOfAPlaceLeadsToThisHostAlone) {
  Put("index.html", "<!doctype html>");
  Start();
  const std::string host = absl::StrCat("localhost:", server_->port());
  const HttpReply code = Get("/visit/code.svg?at=B05");
  EXPECT_EQ(code.status, 200);
  EXPECT_EQ(code.headers.at("content-type"), "image/svg+xml");
  EXPECT_THAT(code.body, HasSubstr(absl::StrCat("<title>http://", host, "/visit?at=B05</title>")));
  EXPECT_THAT(Get(absl::StrCat("/visit/code.svg?at=B05&base=https://", host)).body,
              HasSubstr("<title>https://"));
  const HttpReply other = Get("/visit/code.svg?at=B05&base=https://elsewhere.example");
  EXPECT_EQ(other.status, 400);
  EXPECT_THAT(other.body, HasSubstr("the host of this request"));
  EXPECT_EQ(Get("/visit/code.svg").status, 400);
}

}  // namespace
}  // namespace docent::server
