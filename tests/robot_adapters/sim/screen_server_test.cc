#include "robot_adapters/sim/screen_server.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <memory>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "tests/kb_server/http/http_client.h"

namespace docent::robot {
namespace {

using server::HttpClient;
using server::HttpReply;
using testing::HasSubstr;

class ScreenServerTest : public ::testing::Test {
 protected:
  ScreenServerTest() : screen_(*ScreenServer::Start(0)) { screen_->Show("booth", "<p>B7</p>"); }

  uint16_t port() const { return static_cast<uint16_t>(screen_->port()); }
  HttpReply Ask(const std::string& method, const std::string& target) {
    return HttpClient(port()).Ask(method, target);
  }
  int Status(const std::string& host, const std::string& target = "/") {
    return HttpClient(port()).Ask("GET", target, absl::StrCat("Host: ", host, "\r\n")).status;
  }
  std::string Own() const { return absl::StrCat("localhost:", screen_->port()); }

  std::unique_ptr<ScreenServer> screen_;
};

TEST_F(ScreenServerTest, ShowsPages) {
  EXPECT_EQ(screen_->Show("B03", "<h1>Stairs</h1>"), absl::StrCat("http://127.0.0.1:", port(), "/B03"));
  for (const char* path : {"/", "/B03"}) {
    const HttpReply page = Ask("GET", path);
    EXPECT_EQ(page.status, 200);
    EXPECT_EQ(page.body, "<h1>Stairs</h1>");
    EXPECT_EQ(page.headers.at("content-type"), "text/html; charset=utf-8");
  }
  EXPECT_EQ(Ask("GET", "/booth").body, "<p>B7</p>") << "earlier pages stay";
  EXPECT_EQ(Ask("GET", "/../etc/passwd").status, 404);
  EXPECT_EQ(Ask("POST", "/").status, 405);
  EXPECT_EQ(Ask("HEAD", "/").status, 200);
  HttpClient rubbish(port());
  EXPECT_TRUE(rubbish.Send("rubbish\r\n\r\n"));
  EXPECT_TRUE(rubbish.Ended()) << "without an answer";
}

TEST_F(ScreenServerTest, BeforeThereIsAPageItHasNone) {
  auto empty = ScreenServer::Start(0);
  ASSERT_TRUE(empty.ok()) << empty.status();
  HttpClient client(static_cast<uint16_t>((*empty)->port()));
  EXPECT_EQ(client.Ask("GET", "/").status, 404);
}

TEST_F(ScreenServerTest, APortThatIsTakenIsSaid) {
  EXPECT_TRUE(absl::IsUnavailable(ScreenServer::Start(screen_->port()).status()));
}

TEST_F(ScreenServerTest, SaysWhatTheRobotSpeaksAndThatThePageHasChanged) {
  EXPECT_THAT(Ask("GET", "/-/now").body,
              HasSubstr(R"({"change": 1, "text": "", "language": "", "share": 0.000})"));
  screen_->Show("B03", "<h1>Stairs</h1>");
  screen_->Say("Say \"hello\"\n\xED\x95\x9C", "ko", 0.25);
  const HttpReply now = Ask("GET", "/-/now");
  EXPECT_THAT(now.body, HasSubstr("{\"change\": 2, \"text\": \"Say \\\"hello\\\"\\u000a\xED\x95\x9C\", "
                                  "\"language\": \"ko\", \"share\": 0.250}"));
  EXPECT_EQ(now.headers.at("content-type"), "application/json");
  EXPECT_EQ(Ask("GET", "/-/screen.js").headers.at("content-type"), "text/javascript; charset=utf-8");
}

TEST_F(ScreenServerTest, ItAnswersToItsOwnHostAlone) {
  const std::string port = absl::StrCat(":", screen_->port());
  for (const std::string& own : {Own(), "LOCALHOST" + port, "127.0.0.1" + port, "[::1]" + port,
                                 std::string("localhost"), std::string("127.0.0.1"), std::string("[::1]")})
    EXPECT_EQ(Status(own), 200) << own;
  for (const std::string& other :
       {"rebound.example" + port, std::string("rebound.example"), std::string("localhost:1"),
        "localhost.example" + port, std::string("127.0.0.1.example"), std::string("")})
    EXPECT_EQ(Status(other), 403) << other;
  EXPECT_EQ(Status("rebound.example", "/-/now"), 403);
}

// Those that say nothing would keep it from being seen.
TEST_F(ScreenServerTest, TheOldestConnectionMakesRoom) {
  std::vector<std::unique_ptr<HttpClient>> silent;
  for (size_t i = 0; i < 4 * ScreenServer::kConnectionLimit; ++i)
    silent.push_back(std::make_unique<HttpClient>(port()));
  EXPECT_EQ(Status(Own()), 200);
  EXPECT_FALSE(silent.front()->AwaitAnswer()) << "it is closed";
}

TEST_F(ScreenServerTest, WithoutDescriptorsItWaitsAndGoesOn) {
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &before), 0);
  std::vector<int> taken;
  rlimit few = before;
  few.rlim_cur = 256;
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &few), 0);
  for (int fd = open("/dev/null", O_RDONLY | O_CLOEXEC); fd >= 0;
       fd = open("/dev/null", O_RDONLY | O_CLOEXEC))
    taken.push_back(fd);
  ASSERT_FALSE(taken.empty());
  close(taken.back());
  taken.pop_back();
  HttpClient waiting(port());  // takes the last one; the screen has none for it
  timespec cpu_before{}, cpu_after{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &cpu_before);
  absl::SleepFor(absl::Milliseconds(300));  // in which it tries again a few times
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &cpu_after);
  const double cpu_s = static_cast<double>(cpu_after.tv_sec - cpu_before.tv_sec) +
                       static_cast<double>(cpu_after.tv_nsec - cpu_before.tv_nsec) / 1e9;
  EXPECT_LT(cpu_s, 0.2) << "it does not spin";
  for (const int fd : taken) close(fd);
  EXPECT_EQ(waiting.Ask("GET", "/booth").status, 200);
  setrlimit(RLIMIT_NOFILE, &before);
}

}  // namespace
}  // namespace docent::robot
