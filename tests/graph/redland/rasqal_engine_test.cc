#include "graph/redland/rasqal_engine.h"

#include <gmock/gmock.h>

#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include "graph/redland/rasqal_guard.h"
#include "tests/graph/redland/two_engines.h"

namespace docent::redland {
namespace {

using ::testing::HasSubstr;

std::string Numbers(int count) {
  std::string trig;
  for (int i = 0; i < count; ++i) trig += "ex:s" + std::to_string(i) + " ex:p " + std::to_string(i) + " .\n";
  return trig;
}

absl::Status StatusOf(const TwoEngines& engines, const std::string& query, Cancellation* cancellation,
                      const Limits& limits = {}) {
  return RunRasqal(engines.Parse(query), engines.dictionary(), engines.version(), cancellation, limits)
      .status();
}

TEST(RasqalEngineTest, AnswersEachFormOfQuery) {
  const TwoEngines engines("ex:a ex:p 1 . ex:g { ex:a ex:p 1 . ex:b ex:q \"x\"@en }");
  EXPECT_EQ(engines.Rasqal("SELECT ?s ?u { ?s ex:p 1 OPTIONAL { ?s ex:q ?u } }"), "a -") << "the union, once";
  EXPECT_EQ(engines.Rasqal("ASK { ex:b ex:q \"x\"@en }"), "yes");
  EXPECT_EQ(engines.Rasqal("ASK { ex:b ex:q \"x\" }"), "no");
  EXPECT_EQ(engines.Rasqal("CONSTRUCT { ?o ex:r ?s } WHERE { ?s ex:p ?o . }"), "");
  EXPECT_EQ(engines.Rasqal("CONSTRUCT { ?s ex:r ?o } WHERE { ?s ex:p ?o . }"), "a r 1");
  EXPECT_EQ(engines.Rasqal("SELECT ?x { VALUES ?x { 1 2 3 } }"), "1 | 2 | 3")
      << "the short form, written long";
  EXPECT_EQ(engines.Rasqal("SELECT ?s { ?s <http://example.org/none> ?o }"), "");
}

TEST(RasqalEngineTest, WhatItsFunctionsMakeIsATermOrAnError) {
  const TwoEngines engines("ex:a ex:p 1 .");
  for (const char* made : {"STRLANG(\"x\", \"en . <x> <y> <z>\")", "IRI(\"http://e/a b\")",
                           "STRDT(\"x\", IRI(\"http://e/a b\"))"}) {
    for (const char* query : {"SELECT ?x { ?s ex:p ?o BIND(%s AS ?x) }",
                              "CONSTRUCT { ?s ex:q ?x } WHERE { ?s ex:p ?o BIND(%s AS ?x) }"}) {
      std::string text = query;
      text.replace(text.find("%s"), 2, made);
      const absl::Status status = StatusOf(engines, text, nullptr);
      EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << text;
      EXPECT_THAT(std::string(status.message()), HasSubstr("no RDF term")) << text;
    }
  }
}

TEST(RasqalEngineTest, RowsAreLimited) {
  const TwoEngines engines(Numbers(5));
  Limits limits;
  limits.rasqal_rows = 5;
  EXPECT_TRUE(StatusOf(engines, "SELECT ?s { ?s ex:p ?o }", nullptr, limits).ok());
  limits.rasqal_rows = 4;
  for (const char* query : {"SELECT ?s { ?s ex:p ?o }", "CONSTRUCT { ?s ex:q ?o } WHERE { ?s ex:p ?o }"}) {
    absl::Status status = StatusOf(engines, query, nullptr, limits);
    EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
    EXPECT_THAT(std::string(status.message()), HasSubstr("rasqal_rows = 4"));
  }
}

TEST(RasqalEngineTest, AQueryThatTakesTooLongEndsAtItsLimitAndIsNoAnswer) {
  const TwoEngines engines(Numbers(200));
  const std::string bomb =
      "SELECT ?a { ?a ex:p ?x . ?b ex:p ?y . ?c ex:p ?z . ?d ex:p ?w FILTER(?x + ?y + ?z + ?w < 0) }";
  Cancellation slow(std::chrono::milliseconds(200));
  absl::Status status = StatusOf(engines, bomb, &slow);
  EXPECT_EQ(status.code(), absl::StatusCode::kDeadlineExceeded) << status;
  EXPECT_THAT(std::string(status.message()), HasSubstr("query_timeout_ms = 200"));

  Cancellation cancelled;
  std::thread canceller([&cancelled] {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    cancelled.Cancel();
  });
  EXPECT_EQ(StatusOf(engines, bomb, &cancelled).code(), absl::StatusCode::kCancelled);
  canceller.join();
}

TEST(RasqalEngineTest, NestedOptionalIsLimited) {
  const auto nested = [](int depth) {
    std::string text = "?s ex:p ?o0 ";
    for (int i = 1; i <= depth; ++i) text += "OPTIONAL { ?s ex:q ?o" + std::to_string(i) + " ";
    return "SELECT ?s { " + text + std::string(static_cast<size_t>(depth), '}') + " }";
  };
  const TwoEngines engines("ex:a ex:p 1 .");
  const int limit = Limits().rasqal_optional_nesting;
  EXPECT_EQ(engines.Rasqal(nested(limit)), "a");
  EXPECT_THAT(engines.Rasqal(nested(limit + 1)),
              HasSubstr("rasqal_optional_nesting = " + std::to_string(limit)));
  std::string beside = "SELECT ?s { ?s ex:p ?o ";
  for (int i = 0; i < 20; ++i) beside += "OPTIONAL { ?s ex:q ?p" + std::to_string(i) + " } ";
  EXPECT_EQ(engines.Rasqal(beside + "}"), "a") << "one after the other is no nesting";
}

TEST(RasqalEngineTest, ManyThreadsAskAtTheSameTime) {
  const TwoEngines engines(Numbers(50));
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&engines, t] {
      for (int i = 0; i < 20; ++i) {
        const std::string number = std::to_string((t * 20 + i) % 50);
        EXPECT_EQ(engines.Rasqal("SELECT ?s { ?s ex:p " + number + " }"), "s" + number);
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
}

}  // namespace
}  // namespace docent::redland
