// What becomes of notifications that cannot be delivered.
#include "kb_server/work/notifier.h"

#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/synchronization/mutex.h"
#include "absl/synchronization/notification.h"
#include "absl/time/clock.h"
#include "gmock/gmock.h"
#include "graph/rdf/vocabulary.h"
#include "gtest/gtest.h"
#include "kb_server/http/http_server.h"
#include "kb_server/work/cloud_event.h"
#include "kb_server/work/http_fetch.h"

namespace docent::server {
namespace {

using ::testing::HasSubstr;

Notification To(const std::string& target) {
  Notification one;
  one.id = CommandId("F-1/A/0/notify.0.0@1");
  one.target = target;
  one.source = "urn:docent:run:F-1";
  one.type = "org.example.x";
  return one;
}

// The report of the one notification, and how often it was offered before it was taken.
CommandReport ReportOf(Notifier::Settings settings, const Notification& notification, int refusals = 0) {
  settings.first_pause = std::chrono::milliseconds(1);
  CommandReport report;
  absl::Notification taken;
  int offered = 0;
  Notifier notifier(std::move(settings), [&](WriteBatch batch, const std::function<void(bool)>& done) {
    report = batch.reports.at(0);
    const bool takes = offered++ == refusals;
    done(takes);
    if (takes) taken.Notify();
  });
  notifier.Send(notification);
  EXPECT_TRUE(taken.WaitForNotificationWithTimeout(absl::Seconds(60)));
  EXPECT_EQ(offered, refusals + 1);
  return report;
}

TEST(NotifierTest, ItIsGivenUpAfterTheLimitOfAttempts) {
  Notifier::Settings settings;
  settings.allow = {"http://127.0.0.1:1/"};
  settings.attempts = 3;
  const CommandReport report = ReportOf(settings, To("http://127.0.0.1:1/hook"));
  EXPECT_EQ(report.outcome, CommandReport::Outcome::kFailed);
  EXPECT_EQ(report.command.value(), "F-1/A/0/notify.0.0@1");
  EXPECT_THAT(report.message, HasSubstr("given up after 3 attempts (the limit notify_attempts is 3)"));
}

TEST(NotifierTest, AnAnswerOf2xxIsADeliveryHoweverLongItIs) {
  const std::string whole(size_t{3} << 20, 'x');
  HttpRoutes routes;
  for (const auto& [path, status] : {std::pair("/hook", 200), {"/bad", 500}}) {
    routes.Add("POST", path, [&whole, status = status](const std::shared_ptr<HttpExchange>& exchange) {
      exchange->Respond(TextResponse(status, whole));
    });
  }
  HttpServerOptions options;
  options.listen = "127.0.0.1:0";
  auto server = HttpServer::Start(options, std::move(routes));
  ASSERT_TRUE(server.ok()) << server.status();
  const std::string base = "http://" + (*server)->address();
  Notifier::Settings settings;
  settings.allow = {base};
  settings.attempts = 1;
  const CommandReport report = ReportOf(settings, To(base + "/hook"));
  EXPECT_EQ(report.outcome, CommandReport::Outcome::kSucceeded) << report.message;
  EXPECT_THAT(ReportOf(settings, To(base + "/bad")).message, HasSubstr("answered 500"));
}

std::unique_ptr<HttpServer> ServeHooks(const HttpHandler& handler) {
  HttpRoutes routes;
  routes.Add("POST", "/hook", handler);
  HttpServerOptions options;
  options.listen = "127.0.0.1:0";
  auto server = HttpServer::Start(options, std::move(routes));
  EXPECT_TRUE(server.ok()) << server.status();
  return *std::move(server);
}

std::string AddressOf(const HttpServer& server) {
  return "http://" + server.address();
}

TEST(NotifierTest, AReceiverThatDoesNotAnswerHoldsUpNoOther) {
  absl::Mutex mutex;
  std::vector<std::shared_ptr<HttpExchange>> kept;
  const auto silent = ServeHooks([&](std::shared_ptr<HttpExchange> exchange) {
    absl::MutexLock lock(&mutex);
    kept.push_back(std::move(exchange));
  });
  const auto quick = ServeHooks(
      [](const std::shared_ptr<HttpExchange>& exchange) { exchange->Respond(TextResponse(200, "taken")); });
  Notifier::Settings settings;
  settings.allow = {AddressOf(*silent), AddressOf(*quick)};
  settings.timeout = std::chrono::hours(1);
  absl::Notification told;
  Notifier notifier(settings, [&](const WriteBatch& batch, const std::function<void(bool)>& done) {
    EXPECT_EQ(batch.reports.at(0).outcome, CommandReport::Outcome::kSucceeded) << batch.reports.at(0).message;
    done(true);
    told.Notify();
  });
  for (int i = 0; i < 40; ++i) notifier.Send(To(AddressOf(*silent) + "/hook"));
  const auto asked = [&]() ABSL_NO_THREAD_SAFETY_ANALYSIS { return kept.size() >= 4; };
  mutex.LockWhen(absl::Condition(&asked));
  mutex.Unlock();
  notifier.Send(To(AddressOf(*quick) + "/hook"));
  told.WaitForNotification();
}

TEST(NotifierTest, AReceiverThatAsksForTimeGetsIt) {
  std::atomic<int> asked = 0;
  absl::Time first;
  const auto server = ServeHooks([&](const std::shared_ptr<HttpExchange>& exchange) {
    HttpResponse answer = TextResponse(asked == 0 ? 503 : 200, "");
    if (asked++ == 0) {
      first = absl::Now();
      answer.headers.emplace_back("Retry-After", "1");
    } else {
      EXPECT_GE(absl::Now() - first, absl::Seconds(1));
    }
    exchange->Respond(std::move(answer));
  });
  Notifier::Settings settings;
  settings.allow = {AddressOf(*server)};
  EXPECT_EQ(ReportOf(settings, To(AddressOf(*server) + "/hook")).outcome, CommandReport::Outcome::kSucceeded);
  EXPECT_EQ(asked, 2);
}

TEST(NotifierTest, NoReceiverGetsMoreTimeThanTheLimit) {
  std::atomic<int> asked = 0;
  const auto server = ServeHooks([&](const std::shared_ptr<HttpExchange>& exchange) {
    HttpResponse answer = TextResponse(asked++ == 0 ? 429 : 200, "");
    answer.headers.emplace_back("Retry-After", "1000000");
    exchange->Respond(std::move(answer));
  });
  Notifier::Settings settings;
  settings.allow = {AddressOf(*server)};
  settings.longest_retry_after = std::chrono::milliseconds(10);
  EXPECT_EQ(ReportOf(settings, To(AddressOf(*server) + "/hook")).outcome, CommandReport::Outcome::kSucceeded);
}

TEST(RetryAfterTest, IsANumberOfSecondsOrADate) {
  const absl::Time now = absl::FromUnixSeconds(784111777);  // Sun, 06 Nov 1994 08:49:37 GMT
  EXPECT_EQ(RetryAfterOf({{"retry-after", "120"}}, now), absl::Seconds(120));
  EXPECT_EQ(RetryAfterOf({{"retry-after", "Sun, 06 Nov 1994 08:50:07 GMT"}}, now), absl::Seconds(30));
  EXPECT_EQ(RetryAfterOf({{"retry-after", "Sun, 06 Nov 1994 08:00:00 GMT"}}, now), absl::ZeroDuration());
  EXPECT_EQ(RetryAfterOf({{"retry-after", "soon"}}, now), std::nullopt);
  EXPECT_EQ(RetryAfterOf({{"retry-after", "-1"}}, now), std::nullopt);
  EXPECT_EQ(RetryAfterOf({}, now), std::nullopt);
}

TEST(NotifierTest, AnAddressThatIsNotAllowedIsNotReached) {
  EXPECT_THAT(ReportOf({}, To("http://127.0.0.1:1/hook")).message, HasSubstr("--notify"));
  EXPECT_THAT(ReportOf({}, To("mqtt:a/b")).message, HasSubstr("--mqtt"));
}

TEST(NotifierTest, AReportThatTheDoorDoesNotTakeComesAgain) {
  EXPECT_EQ(ReportOf({}, To("http://127.0.0.1:1/hook"), 3).outcome, CommandReport::Outcome::kFailed);
}

TEST(NotifierTest, NoBrokerIsAFailureOfTheAttempt) {
  Notifier::Settings settings;
  settings.mqtt = "127.0.0.1:1";
  settings.attempts = 1;
  EXPECT_THAT(ReportOf(settings, To("mqtt:a/b")).message,
              HasSubstr("the MQTT broker at 127.0.0.1:1: connecting"));
}

TEST(CloudEventTest, TermsAreJson) {
  Notification one = To("http://h/");
  one.subject = "urn:w:John";
  one.data = {{"iri", Term::Iri("urn:w:John")},
              {"text", Term::Literal("a \"b\"\n")},
              {"tagged", Term::LangString("hallo", "de")},
              {"whole", Term::Integer(7)},
              {"nan", Term::Literal("NaN", std::string(kXsdNs) + "double")},
              {"yes", Term::Boolean(true)},
              {"blank", Term::Blank("b1")},
              {"nothing", std::nullopt}};
  EXPECT_EQ(ToCloudEvent(one),
            "{\"specversion\":\"1.0\",\"id\":\"F-1/A/0/"
            "notify.0.0@1\",\"source\":\"urn:docent:run:F-1\",\"type\":\"org.example.x\","
            "\"subject\":\"urn:w:John\",\"time\":\"1970-01-01T00:00:00Z\",\"datacontenttype\":\"application/"
            "json\",\"data\":{"
            "\"iri\":\"urn:w:John\",\"text\":\"a "
            "\\\"b\\\"\\n\",\"tagged\":{\"value\":\"hallo\",\"language\":\"de\"},\"whole\":7,"
            "\"nan\":\"NaN\",\"yes\":true,\"blank\":\"_:b1\",\"nothing\":null}}");
}

}  // namespace
}  // namespace docent::server
