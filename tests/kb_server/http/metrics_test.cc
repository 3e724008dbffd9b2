#include "kb_server/door/metrics.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>

#include "kb_server/http/http_health.h"
#include "tests/kb_server/http/http_client.h"

namespace docent::server {
namespace {

using ::testing::HasSubstr;

TEST(MetricsTest, WholePage) {
  Metrics metrics;
  Histogram& seconds =
      metrics.AddHistogram("docent_query_seconds", "How long queries take.", {0.5, 2}, {{"form", "ask"}});
  metrics.AddCounter("docent_turns_total", "Turns.").Add(3);
  metrics.AddCounter("docent_answers_total", "Answers.", {{"code", "200"}}).Add();
  metrics.AddCounter("docent_answers_total", "Answers.", {{"code", "4\"\\\n"}}).Add(2);
  metrics.AddGaugeFunction("docent_load", "Load\nnow.", [] { return 0.1; });
  metrics.AddGaugeFunction("docent_quads", "Quads.", [] { return 1e6; });
  for (const double value : {0.25, 0.5, 0.75, 7.0}) seconds.Observe(value);
  EXPECT_EQ(metrics.Render(),
            "# HELP docent_answers_total Answers.\n"
            "# TYPE docent_answers_total counter\n"
            "docent_answers_total{code=\"200\"} 1\n"
            "docent_answers_total{code=\"4\\\"\\\\\\n\"} 2\n"
            "# HELP docent_load Load\\nnow.\n"
            "# TYPE docent_load gauge\n"
            "docent_load 0.1\n"
            "# HELP docent_quads Quads.\n"
            "# TYPE docent_quads gauge\n"
            "docent_quads 1e+06\n"
            "# HELP docent_query_seconds How long queries take.\n"
            "# TYPE docent_query_seconds histogram\n"
            "docent_query_seconds_bucket{form=\"ask\",le=\"0.5\"} 2\n"
            "docent_query_seconds_bucket{form=\"ask\",le=\"2\"} 3\n"
            "docent_query_seconds_bucket{form=\"ask\",le=\"+Inf\"} 4\n"
            "docent_query_seconds_sum{form=\"ask\"} 8.5\n"
            "docent_query_seconds_count{form=\"ask\"} 4\n"
            "# HELP docent_turns_total Turns.\n"
            "# TYPE docent_turns_total counter\n"
            "docent_turns_total 3\n");
}

TEST(MetricsTest, ADeprecatedNameHasTheSameSeries) {
  Metrics metrics;
  metrics.AddCounter("docent_new_total", "New.", {{"code", "200"}}).Add(7);
  metrics.AddDeprecatedName("docent_old_total", "docent_new_total");
  metrics.AddDeprecatedName("docent_gone_total", "docent_nothing_total");
  EXPECT_EQ(metrics.Render(),
            "# HELP docent_new_total New.\n"
            "# TYPE docent_new_total counter\n"
            "docent_new_total{code=\"200\"} 7\n"
            "# HELP docent_old_total Deprecated: use docent_new_total\n"
            "# TYPE docent_old_total counter\n"
            "docent_old_total{code=\"200\"} 7\n");
}

TEST(MetricsTest, SameNameAndLabelsIsTheSameSeries) {
  Metrics metrics;
  Counter& first = metrics.AddCounter("a_total", "A.", {{"x", "1"}});
  EXPECT_EQ(&first, &metrics.AddCounter("a_total", "A.", {{"x", "1"}}));
  EXPECT_NE(&first, &metrics.AddCounter("a_total", "A.", {{"x", "2"}}));
}

TEST(MetricsTest, ManyThreadsCount) {
  Metrics metrics;
  Counter& counter = metrics.AddCounter("a_total", "A.");
  Histogram& histogram = metrics.AddHistogram("b_seconds", "B.", Metrics::LatencyBounds());
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&] {
      for (int i = 0; i < 10000; ++i) {
        counter.Add();
        histogram.Observe(0.25);
      }
    });
  }
  metrics.Render();
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(counter.value(), 40000u);
  EXPECT_EQ(histogram.CountUpTo(histogram.bounds().size()), 40000u);
  EXPECT_DOUBLE_EQ(histogram.sum(), 10000);
}

TEST(HttpHealthTest, PagesAreServed) {
  Metrics metrics;
  metrics.AddCounter("docent_turns_total", "Turns.").Add(7);
  absl::Status health;
  HttpRoutes routes;
  AddMetricsRoute(&routes, &metrics);
  AddHealthRoute(&routes, [&] { return health; });
  HttpServerOptions options;
  options.listen = "127.0.0.1:0";
  auto server = HttpServer::Start(options, std::move(routes));
  ASSERT_TRUE(server.ok()) << server.status();
  AddHttpMetrics(&metrics, server->get());
  HttpClient client((*server)->port());
  EXPECT_EQ(client.Ask("GET", "/healthz").body, "ok\n");
  health = absl::UnavailableError("the log cannot be written: disk full");
  const HttpReply sick = client.Ask("GET", "/healthz");
  EXPECT_EQ(sick.status, 503);
  EXPECT_EQ(sick.body, "the log cannot be written: disk full\n");
  const HttpReply page = client.Ask("GET", "/metrics");
  EXPECT_EQ(page.headers.at("content-type"), "text/plain; version=0.0.4; charset=utf-8");
  EXPECT_THAT(page.body, HasSubstr("docent_turns_total 7\n"));
  EXPECT_THAT(page.body, HasSubstr("docent_http_connections 1\n"));
  EXPECT_THAT(page.body, HasSubstr("docent_http_requests_total 2\n"));
}

}  // namespace
}  // namespace docent::server
