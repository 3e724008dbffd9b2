// An activator whose variables have other names is the same one: nothing starts again.
#include <set>
#include <string>

#include "absl/strings/str_cat.h"
#include "gmock/gmock.h"
#include "graph/rdf/docent_iris.h"
#include "gtest/gtest.h"
#include "tests/kb_server/turn/turn_fixture.h"

namespace docent::server {
namespace {

using test::Fact;
using test::Iri;
using test::kSecond;
using test::Put;
using test::Tell;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

std::string Constraint(const std::string& subject, const std::string& verb, const std::string& object) {
  return absl::StrCat("<constraint><subject>", subject, "</subject><verb>", verb, "</verb><object>", object,
                      "</object></constraint>");
}
// Starts a run for each sensor `a` of which it is told that it has a temperature `b`.
std::string Warm(const std::string& a, const std::string& b, const std::string& declared,
                 const std::string& more = "", const std::string& attributes = "") {
  std::string key, variables;
  if (!declared.empty()) key = absl::StrCat("<variable name=\"", declared, "\"/>");
  for (const std::string& name : std::set<std::string>{a, b})
    absl::StrAppend(&variables, "<variable name=\"", name, "\"/>");
  return absl::StrCat(
      "<CAWL name=\"Warm\" xmlns:docent=\"https://w3id.org/docent#\" xmlns:w=\"urn:w:\" "
      "xmlns:ext=\"https://w3id.org/docent/cawl-ext#\"><activator name=\"A\" ",
      attributes, ">", key, "<activate flow=\"F\"/><condition><context><rule", more, ">",
      Constraint("?" + a, "w:temp", "?" + b), "</rule></context></condition></activator>",
      "<flow name=\"F\">", variables, "<source name=\"s0\"/><node name=\"N\"><ext:tell>$", a, " w:seen $", b,
      "</ext:tell></node><node name=\"Wait\"><condition><context><rule>", Constraint("w:all", "w:go", "true"),
      "</rule></context></condition></node><sink name=\"e0\"/><link from=\"s0\" to=\"N\"/><link from=\"N\" "
      "to=\"Wait\"/><link from=\"Wait\" to=\"e0\"/></flow></CAWL>");
}
TermQuad Temp(const std::string& sensor, int value) {
  return Fact(sensor, "temp", Term::Integer(value));
}

class ActivatorNamesTest : public test::TurnTest {
 protected:
  TurnResult Load(const std::string& text) { return Turn(Put(Document::Kind::kCawl, "warm", text)); }
  bool Seen(const std::string& sensor, int value) {
    const auto s = dictionary_.Find(Iri(sensor)), p = dictionary_.Find(Iri("seen")),
               o = dictionary_.Find(Term::Integer(value));
    return s && p && o && stages_->writer.current().Count({*s, *p, *o, {}}) == 1;
  }
};

TEST_F(ActivatorNamesTest, NothingStartsAgainWhereOnlyNamesDiffer) {
  for (const bool declares : {true, false}) {
    stages_ = std::make_unique<Stages>(&dictionary_, &functions_, Limits());
    const auto load = [&](const std::string& a, const std::string& b) {
      return Load(Warm(a, b, declares ? a : ""));
    };
    Turn(Tell({Temp("s1", 30), Temp("s2", 30)}));
    EXPECT_THAT(Started(load("s", "t")), SizeIs(2));
    EXPECT_THAT(Started(load("sensor", "t")), IsEmpty());
    Restart();
    EXPECT_THAT(Started(load("sensor", "degrees")), IsEmpty());
    EXPECT_THAT(Started(load("t", "s")), IsEmpty()) << "each has the other's name";
    EXPECT_THAT(Started(Turn(Tell({Temp("s3", 31)}))), SizeIs(1));
    EXPECT_TRUE(Seen("s3", 31)) << "its run has the values under the new names";
    Restart();
    EXPECT_THAT(Started(Turn(Tell({Temp("s4", 32)}))), SizeIs(1));
    EXPECT_TRUE(Seen("s4", 32));
    EXPECT_THAT(Started(load("s", "t")), IsEmpty()) << "the first names again";
    EXPECT_THAT(Started(Turn(Tell({Temp("s5", 33)}))), SizeIs(1));
    EXPECT_TRUE(Seen("s5", 33));
  }
}

TEST_F(ActivatorNamesTest, AnotherKeyOrAnotherConditionIsAnother) {
  Turn(Tell({Temp("s1", 30)}));
  EXPECT_THAT(Started(Load(Warm("s", "t", "s"))), SizeIs(1));
  EXPECT_THAT(Started(Load(Warm("s", "t", "t"))), SizeIs(1)) << "the key is what was told of it";
  Turn(Tell({Temp("s2", 30)}));
  EXPECT_THAT(Started(Turn(Tell({Temp("s3", 31)}))), SizeIs(1));
  // What two names were is one now.
  EXPECT_THAT(Started(Load(Warm("x", "x", ""))), IsEmpty());
  EXPECT_THAT(Started(Turn(Tell({Temp("s4", 44)}))), IsEmpty()) << "no sensor is its own temperature";
}

TEST_F(ActivatorNamesTest, TheTimesOfRulesGoOn) {
  Turn(Tell({Temp("s1", 30)}));
  Load(Warm("s", "t", "s", " ext:for=\"10s\""));
  now_us_ += 6 * kSecond;
  EXPECT_THAT(Started(Load(Warm("sensor", "t", "sensor", " ext:for=\"10s\""))), IsEmpty());
  Restart();
  now_us_ += 5 * kSecond;
  EXPECT_THAT(Started(Tick()), SizeIs(1)) << "11 s in all";
  EXPECT_TRUE(Seen("s1", 30));
}

TEST_F(ActivatorNamesTest, RunsOfAKeyAreCountedUnderAllItsNames) {
  Load(Warm("s", "t", "s", "", "ext:mode=\"single\""));
  EXPECT_THAT(Started(Turn(Tell({Temp("s1", 30)}))), SizeIs(1));
  Load(Warm("sensor", "t", "sensor", "", "ext:mode=\"single\""));
  Turn(Tell({}, {Temp("s1", 30)}));
  EXPECT_THAT(Started(Turn(Tell({Temp("s1", 30)}))), IsEmpty()) << "its run is live";
}

TEST_F(ActivatorNamesTest, WhatWaitsStartsWithTheNewNames) {
  Load(Warm("s", "t", "s", "", "ext:mode=\"queued\""));
  EXPECT_THAT(Started(Turn(Tell({Temp("s1", 30)}))), ElementsAre("F-1"));
  Turn(Tell({}, {Temp("s1", 30)}));
  EXPECT_THAT(Started(Turn(Tell({Temp("s1", 31)}))), IsEmpty());
  Load(Warm("sensor", "t", "sensor", "", "ext:mode=\"queued\""));
  EXPECT_THAT(Started(Turn(Tell({Fact("all", "go", Term::Boolean(true))}))), ElementsAre("F-2"));
  EXPECT_TRUE(Seen("s1", 31));
}

}  // namespace
}  // namespace docent::server
