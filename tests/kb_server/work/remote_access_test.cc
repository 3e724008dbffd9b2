#include "kb_server/work/remote_access.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sys/stat.h>

#include <filesystem>
#include <fstream>

#include "absl/synchronization/notification.h"
#include "absl/time/clock.h"
#include "kb_server/door/worker_pool.h"
#include "kb_server/http/http_server.h"
#include "kb_server/work/http_fetch.h"

namespace docent::server {
namespace {

using ::testing::HasSubstr;

TEST(RemoteAccess, OnlyWhatIsBelowAnAllowedAddressIsReached) {
  const RemoteAccess remote({"http://data.example/a", "https://data.example", "file:///srv/rdf/"}, Limits{});
  for (const char* url : {"http://data.example/a", "http://data.example/a/b?q", "HTTP://Data.Example:80/a#x",
                          "https://data.example/any/thing", "file:///srv/rdf/x.ttl"}) {
    EXPECT_TRUE(remote.IsAllowed(url)) << url;
  }
  for (const char* url :
       {"http://data.example/ab", "http://data.example/", "http://data.example:8080/a",
        "http://data.example.evil/a", "http://data.example@evil/a", "http://u@data.example/a",
        "http://data.example/a/../b", "http://data.example/a/%2e%2e/b", "http://data.example/a/..%2fb",
        "https://other.example/", "ftp://data.example/a", "file:///srv/rdf/../x", "file:///srv/rdfx",
        "file://host/srv/rdf/x", "/srv/rdf/x", ""}) {
    EXPECT_FALSE(remote.IsAllowed(url)) << url;
  }
  EXPECT_FALSE(RemoteAccess({}, Limits{}).IsAllowed("http://localhost/"));
}

TEST(RemoteAccess, AnEntryThatIsNoAddressIsRefused) {
  EXPECT_TRUE(RemoteAccess::CheckAllowed("https://data.example/x").ok());
  EXPECT_TRUE(RemoteAccess::CheckAllowed("file:///srv").ok());
  for (const char* entry : {"data.example", "http://", "file://srv", "file:///a/../b", "*"}) {
    EXPECT_FALSE(RemoteAccess::CheckAllowed(entry).ok()) << entry;
  }
}

TEST(RemoteAccess, WhatIsNoFileOrLiesElsewhereIsNotLoaded) {
  const auto folder = std::filesystem::temp_directory_path() / ("docent-links-" + std::to_string(getpid()));
  std::filesystem::create_directories(folder / "open");
  std::ofstream(folder / "secret.ttl") << "<urn:a> <urn:p> 1 .";
  std::ofstream(folder / "open/a.ttl") << "<urn:a> <urn:p> 1 .";
  std::filesystem::create_symlink("a.ttl", folder / "open/inside.ttl");
  std::filesystem::create_symlink("../secret.ttl", folder / "open/outside.ttl");
  std::filesystem::create_directory_symlink("..", folder / "open/up");
  std::filesystem::create_directory_symlink("open", folder / "alias");
  ASSERT_EQ(mkfifo((folder / "open/pipe.ttl").c_str(), 0600), 0);
  const std::string base = "file://" + folder.string();
  const RemoteAccess remote({base + "/open", base + "/alias"}, Limits{});
  const auto load = [&](const std::string& name) { return remote.Load(base + name, nullptr).status(); };
  EXPECT_TRUE(load("/open/a.ttl").ok());
  EXPECT_TRUE(load("/open/inside.ttl").ok());
  EXPECT_TRUE(load("/alias/a.ttl").ok()) << "the folder itself may be named by a link";
  EXPECT_EQ(load("/open/outside.ttl").code(), absl::StatusCode::kPermissionDenied);
  EXPECT_EQ(load("/open/up/secret.ttl").code(), absl::StatusCode::kPermissionDenied);
  EXPECT_EQ(load("/open/pipe.ttl").code(), absl::StatusCode::kInvalidArgument) << "it would wait for ever";
  EXPECT_EQ(load("/open").code(), absl::StatusCode::kInvalidArgument);
  std::filesystem::remove_all(folder);
}

TEST(RemoteAccess, AFileIsLoadedByItsName) {
  const auto folder = std::filesystem::temp_directory_path() / ("docent-remote-" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "a.ttl") << "<b> <urn:p> 1 .";
  std::ofstream(folder / "bad.ttl") << "<b> <urn:p> .";
  Limits limits;
  limits.remote_bytes = 100;
  std::ofstream(folder / "long.ttl") << std::string(101, ' ');
  const std::string base = "file://" + folder.string();
  const RemoteAccess remote({base}, limits);
  auto quads = remote.Load(base + "/a.ttl", nullptr);
  ASSERT_TRUE(quads.ok()) << quads.status();
  EXPECT_EQ((*quads)[0].subject.lexical, base + "/b");
  EXPECT_EQ(remote.Load(base + "/none.ttl", nullptr).status().code(), absl::StatusCode::kNotFound);
  EXPECT_THAT(std::string(remote.Load(base + "/bad.ttl", nullptr).status().message()),
              HasSubstr("bad.ttl:1:"));
  EXPECT_THAT(std::string(remote.Load(base + "/long.ttl", nullptr).status().message()),
              HasSubstr("remote_bytes = 100"));
  EXPECT_EQ(remote.Load("file:///etc/hostname", nullptr).status().code(),
            absl::StatusCode::kPermissionDenied);
  std::filesystem::remove_all(folder);
}

// A server that answers with what a test wants.
class RemoteAccessHttpTest : public ::testing::Test {
 protected:
  void Serve(HttpHandler handler) {
    HttpRoutes routes;
    routes.Add("POST", "/sparql", handler);
    routes.Add("GET", "/doc", handler);
    HttpServerOptions options;
    options.listen = "127.0.0.1:0";
    auto server = HttpServer::Start(options, std::move(routes));
    ASSERT_TRUE(server.ok()) << server.status();
    server_ = *std::move(server);
    base_ = "http://" + server_->address();
  }
  absl::StatusOr<sparql::ServiceAnswer> Select(Limits limits = {}, Cancellation* cancellation = nullptr,
                                               bool silent = false) {
    return RemoteAccess({base_}, limits).Select(base_ + "/sparql", "SELECT * {}", silent, cancellation);
  }
  static HttpHandler Json(const std::string& text) {
    return [text](std::shared_ptr<HttpExchange> e) {
      HttpResponse response = TextResponse(200, text);
      response.content_type = "application/sparql-results+json";
      e->Respond(std::move(response));
    };
  }
  std::unique_ptr<HttpServer> server_;
  std::string base_;
};

TEST_F(RemoteAccessHttpTest, RowsAreReadFromJson) {
  Serve(Json(R"({"head":{"vars":["a","b"]},"results":{"bindings":[
      {"a":{"type":"uri","value":"urn:x"},"b":{"type":"literal","value":"hi","xml:lang":"EN"}},
      {"b":{"type":"literal","value":"1","datatype":"http://www.w3.org/2001/XMLSchema#integer"}},
      {"a":{"type":"bnode","value":"n1"}}]}})"));
  auto answer = Select();
  ASSERT_TRUE(answer.ok()) << answer.status();
  ASSERT_EQ(answer->rows.size(), 3u);
  EXPECT_EQ(answer->rows[0][0], Term::Iri("urn:x"));
  EXPECT_EQ(answer->rows[0][1], Term::LangString("hi", "en"));
  EXPECT_EQ(answer->rows[1][0], std::nullopt);
  EXPECT_EQ(answer->rows[1][1], Term::Integer(1));
  EXPECT_EQ(answer->rows[2][0], Term::Blank("n1"));
}

TEST_F(RemoteAccessHttpTest, WhatIsNoAnswerIsAnError) {
  for (const char* text :
       {"", "<html>", "[]", "{\"head\":{},\"boolean\":true}",
        "{\"head\":{\"vars\":[\"a\"]},\"results\":{\"bindings\":[{\"a\":{\"type\":\"?\"}}]}}",
        "{\"head\":{\"vars\":[\"a\"]},\"results\":{\"bindings\":[{\"a\":7}]}}",
        "{\"head\":{\"vars\":[\"a\"]},\"results\":{\"bindings\":[{\"a\":{\"type\":\"uri\",\"value\":\"not an "
        "iri\"}}]}}"}) {
    server_.reset();
    Serve(Json(text));
    EXPECT_EQ(Select().status().code(), absl::StatusCode::kUnknown) << text;
  }
}

TEST_F(RemoteAccessHttpTest, LimitsAndTimeoutsAreKept) {
  const std::string row = R"({"a":{"type":"uri","value":"urn:x"}})";
  Serve(Json(R"({"head":{"vars":["a"]},"results":{"bindings":[)" + row + "," + row + "]}}"));
  Limits limits;
  limits.remote_rows = 2;
  EXPECT_TRUE(Select(limits).ok());
  limits.remote_rows = 1;
  EXPECT_THAT(std::string(Select(limits).status().message()), HasSubstr("remote_rows = 1"));
  limits = {};
  limits.remote_bytes = 50;
  EXPECT_THAT(std::string(Select(limits).status().message()), HasSubstr("remote_bytes = 50"));

  std::shared_ptr<HttpExchange> kept;
  server_.reset();
  Serve([&kept](std::shared_ptr<HttpExchange> e) { kept = std::move(e); });
  limits = {};
  limits.query_timeout_ms = 100;
  EXPECT_EQ(Select(limits).status().code(), absl::StatusCode::kDeadlineExceeded);
  Cancellation cancellation;
  cancellation.Cancel();
  EXPECT_EQ(Select({}, &cancellation).status().code(), absl::StatusCode::kCancelled);
  server_.reset();
  EXPECT_EQ(Select().status().code(), absl::StatusCode::kUnknown) << "nobody listens";
}

TEST_F(RemoteAccessHttpTest, TheQuerysOwnTimeHoldsForAnEndpointThatIsSlow) {
  std::vector<std::shared_ptr<HttpExchange>> kept;
  Serve([&kept](std::shared_ptr<HttpExchange> e) { kept.push_back(std::move(e)); });
  const auto ended = [&](bool silent) {
    Cancellation cancellation(std::chrono::milliseconds(2000));
    const absl::Status status = Select({}, &cancellation, silent).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kDeadlineExceeded);
    return std::string(status.message());
  };
  EXPECT_THAT(ended(false), HasSubstr("query_timeout_ms = 2000"));
  EXPECT_THAT(ended(true), HasSubstr("half of the time that the query had left")) << "of a SILENT one";
  server_.reset();
}

TEST_F(RemoteAccessHttpTest, WhoWaitsForAnotherServerLetsOthersRun) {
  absl::Notification asked, go;
  WorkerPool pool({1, 2, 10});
  std::shared_ptr<HttpExchange> kept;
  Serve([&](std::shared_ptr<HttpExchange> e) {
    kept = std::move(e);
    asked.Notify();
  });
  RemoteAccess slow({base_}, Limits{});
  Cancellation cancellation;
  pool.Submit({.run =
                   [&] {
                     const auto answer = slow.Select(base_ + "/sparql", "SELECT * {}", false, &cancellation);
                     EXPECT_EQ(answer.status().code(), absl::StatusCode::kCancelled);
                     go.Notify();
                   },
               .refuse = nullptr});
  asked.WaitForNotification();
  absl::Notification ran;
  pool.Submit({.run = [&] { ran.Notify(); }, .refuse = nullptr});
  EXPECT_TRUE(ran.WaitForNotificationWithTimeout(absl::Seconds(20)));
  cancellation.Cancel();
  go.WaitForNotification();
  server_.reset();
}

TEST_F(RemoteAccessHttpTest, RedirectsAreFollowedToWhatIsAllowed) {
  std::string location = "doc?two=2";
  int status = 303;
  Serve([&](std::shared_ptr<HttpExchange> e) {
    const bool there = !e->request().parameters.empty();
    HttpResponse response = TextResponse(there ? 200 : status, "<a> <p> 1 .");
    if (there) response.content_type = "text/turtle";
    if (!there) response.headers.emplace_back("Location", location);
    e->Respond(std::move(response));
  });
  const auto load = [this] { return RemoteAccess({base_}, Limits{}).Load(base_ + "/doc", nullptr); };
  for (status = 301; status <= 308; ++status) {
    const auto quads = load();
    if (status >= 304 && status <= 306) {
      EXPECT_EQ(quads.status().code(), absl::StatusCode::kUnknown) << status;
      continue;
    }
    ASSERT_TRUE(quads.ok()) << quads.status();
    EXPECT_EQ((*quads)[0].subject, Term::Iri(base_ + "/a")) << "the base is where it was found";
  }
  status = 302;
  location = "http://other.example/doc";
  EXPECT_EQ(load().status().code(), absl::StatusCode::kPermissionDenied);
  location = "doc";
  EXPECT_EQ(load().status().code(), absl::StatusCode::kUnknown) << "round and round";
}

TEST_F(RemoteAccessHttpTest, ADocumentIsReadInItsType) {
  Serve([](std::shared_ptr<HttpExchange> e) {
    HttpResponse response = TextResponse(200, "<urn:a> <urn:p> <urn:b> .");
    response.content_type = "application/n-triples";
    e->Respond(std::move(response));
  });
  auto quads = RemoteAccess({base_}, Limits{}).Load(base_ + "/doc", nullptr);
  ASSERT_TRUE(quads.ok()) << quads.status();
  EXPECT_EQ(quads->size(), 1u);
  EXPECT_EQ(RemoteAccess({base_}, Limits{}).Load(base_ + "/none", nullptr).status().code(),
            absl::StatusCode::kUnknown);
}

}  // namespace
}  // namespace docent::server
