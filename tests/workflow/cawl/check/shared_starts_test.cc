#include "workflow/cawl/check/shared_starts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/workflow/cawl/documents.h"
#include "workflow/cawl/check/check.h"
#include "workflow/cawl/parser.h"
#include "workflow/cawl/rule_names.h"

namespace docent::cawl {
namespace {

using ::testing::HasSubstr;

std::string Workflow(const std::string& name, const std::string& condition) {
  return "<CAWL name=\"" + name +
         "\" xmlns:expo=\"https://w3id.org/docent/expo#\" "
         "xmlns:ext=\"https://w3id.org/docent/cawl-ext#\"><activator name=\"a\"><activate flow=\"F\"/>" +
         condition +
         "</activator><flow name=\"F\"><source name=\"s\"/><sink name=\"t\"/><link from=\"s\" "
         "to=\"t\"/></flow>"
         "</CAWL>";
}

std::string Chose(const std::string& user, const std::string& service) {
  return ConstraintText("wish", user, "docent:chose", service);
}

// The messages about shared starts of a workflow Mine beside one that is deployed.
std::vector<std::string> Told(const std::string& mine, const std::string& deployed,
                              const std::string& name = "Theirs") {
  const ParsedCawl other = ParseCawl(Workflow(name, deployed), "other");
  EXPECT_TRUE(other.ok());
  const CheckReport report = CheckDocument(Workflow("Mine", mine), "f", nullptr, {}, {other.document});
  EXPECT_TRUE(report.ok());
  std::vector<std::string> told;
  for (const Diagnostic& d : report.diagnostics) {
    if (d.rule != kSharedStart) continue;
    EXPECT_EQ(d.severity, Diagnostic::Severity::kWarning);
    told.push_back(d.message);
  }
  return told;
}
bool Both(const std::string& mine, const std::string& deployed) {
  const bool both = !Told(mine, deployed).empty();
  EXPECT_EQ(both, !Told(deployed, mine).empty()) << "either way round";
  return both;
}

TEST(SharedStarts, OneWishThatTwoWorkflowsServeIsTold) {
  const std::vector<std::string> told =
      Told(ConditionOf(Chose("?user", "expo:Guide")),
           ConditionOf(Chose("?who", "expo:Guide") + ConstraintText("at", "?who", "docent:isAt", "?place")));
  ASSERT_EQ(told.size(), 1u);
  EXPECT_THAT(told[0], HasSubstr("workflow Theirs starts a run then, too"));
}

TEST(SharedStarts, AnyServiceIsAlsoThisOne) {
  EXPECT_TRUE(Both(ConditionOf(Chose("?user", "?service")), ConditionOf(Chose("?u", "expo:Guide"))));
  EXPECT_TRUE(Both(ConditionOf(Chose("?user", "!= expo:Tour")), ConditionOf(Chose("?user", "expo:Guide"))));
  EXPECT_FALSE(Both(ConditionOf(Chose("?user", "!= expo:Guide")), ConditionOf(Chose("?user", "expo:Guide"))));
}

TEST(SharedStarts, OtherWishesAndOtherVisitorsAreOtherOccasions) {
  EXPECT_FALSE(Both(ConditionOf(Chose("?user", "expo:Guide")), ConditionOf(Chose("?user", "expo:Tour"))));
  EXPECT_FALSE(
      Both(ConditionOf(Chose("expo:John", "expo:Guide")), ConditionOf(Chose("expo:Ann", "expo:Guide"))));
  EXPECT_FALSE(Both(ConditionOf(Chose("?user", "expo:Guide")),
                    ConditionOf(ConstraintText("at", "?user", "docent:isAt", "expo:Hall"))));
}

TEST(SharedStarts, WhatOneDeniesAndTheOtherSaysKeepsThemApart) {
  const std::string wish = Chose("?user", "expo:Guide");
  const std::string guest = Chose("?guest", "expo:Guide");
  const std::string of_user = ConstraintText("member", "?user", "expo:member", "true");
  const std::string of_guest = ConstraintText("member", "?guest", "expo:member", "true");
  EXPECT_FALSE(Both(ConditionOf(wish + of_user), ConditionOf(guest + of_guest, "wish and not member")));
  EXPECT_FALSE(Both(ConditionOf(wish + of_user),
                    ConditionOf(guest + ConstraintText("member", "?guest", "expo:member", "false"))));
  EXPECT_TRUE(Both(ConditionOf(wish), ConditionOf(guest + of_guest, "wish and not member")));
  const auto age = [](const std::string& who, const std::string& limit) {
    return Chose(who, "expo:Guide") + ConstraintText("age", who, "expo:age", limit);
  };
  EXPECT_FALSE(Both(ConditionOf(age("?u", "&lt; 18")), ConditionOf(age("?v", ">= 18"))));
  EXPECT_TRUE(Both(ConditionOf(age("?u", "&lt;= 18")), ConditionOf(age("?v", ">= 18"))));
  EXPECT_TRUE(Both(ConditionOf(age("?u", "&lt; 18")), ConditionOf(age("?v", "&lt; 12"))));
  EXPECT_FALSE(Both(ConditionOf(age("?u", "17")), ConditionOf(age("?v", "> 17"))));
  EXPECT_TRUE(Both(ConditionOf(wish + ConstraintText("type", "?user", "a", "docent:Visitor")),
                   ConditionOf(guest + ConstraintText("type", "?guest", "a", "docent:Person"))));
}

TEST(SharedStarts, OneAlternativeIsEnough) {
  const std::string either = ConditionOf(
      Chose("?user", "expo:Tour") + ConstraintText("other", "?user", "docent:chose", "expo:Guide"),
      "wish or other");
  EXPECT_TRUE(Both(either, ConditionOf(Chose("?user", "expo:Guide"))));
}

TEST(SharedStarts, OneEventAndOneSituationAreToldToo) {
  const auto on = [](const std::string& event) {
    return "<condition><case name=\"c\"><event operation=\"" + event + "\"/></case></condition>";
  };
  EXPECT_TRUE(Both(on("bell"), on("bell")));
  EXPECT_FALSE(Both(on("bell"), on("knock")));
  EXPECT_FALSE(Both(on("bell"), ConditionOf(Chose("?user", "expo:Guide"))));
  const auto low = [](const std::string& robot, const std::string& limit) {
    return ConditionOf(ConstraintText("is", robot, "docent:status", "docent:Standby") +
                       ConstraintText("low", robot, "docent:battery", limit));
  };
  EXPECT_TRUE(Both(low("?robot", "&lt; 20"), low("?r", "&lt; 20")));
  EXPECT_FALSE(Both(low("?robot", "&lt; 20"),
                    ConditionOf(ConstraintText("is", "?r", "docent:status", "docent:Standby") +
                                ConstraintText("low", "?other", "docent:battery", "&lt; 20"))))
      << "of another robot";
  EXPECT_FALSE(Both(low("?robot", "&lt; 20"), ConditionOf(ConstraintText("is", "?r", "a", "docent:Robot"))));
}

TEST(SharedStarts, OtherTimesOfDayAreOtherOccasions) {
  const auto in = [](const std::string& hours) {
    return "<condition><context name=\"C\"><ext:time between=\"" + hours + "\"/><rule name=\"R\">" +
           Chose("?user", "expo:Guide") + "</rule></context></condition>";
  };
  EXPECT_FALSE(Both(in("09:00-12:00"), in("12:00-18:00")));
  EXPECT_TRUE(Both(in("09:00-12:00"), in("09:00-12:00")));
  EXPECT_TRUE(Both(in("09:00-12:00"), ConditionOf(Chose("?user", "expo:Guide"))));
}

TEST(SharedStarts, AWorkflowTakesThePlaceOfItsOwnOlderVersion) {
  const std::string wish = ConditionOf(Chose("?user", "expo:Guide"));
  EXPECT_TRUE(Told(wish, wish, "Mine").empty());
}

TEST(SharedStarts, LargeSituationsEndTheLookAndNotTheServer) {
  std::string many;
  for (int i = 0; i < 1000; ++i)
    many += ConstraintText("c" + std::to_string(i), "?v" + std::to_string(i), "docent:isAt",
                           "?w" + std::to_string(i));
  EXPECT_TRUE(Told(ConditionOf(many), ConditionOf(many)).empty());
}

}  // namespace
}  // namespace docent::cawl
