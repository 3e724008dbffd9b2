// Values of a wrong type that a run is given by what starts it.
#include "gmock/gmock.h"
#include "tests/kb_server/turn/run_fixture.h"

namespace docent::server {
namespace {

using test::Fact;
using test::Tell;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

class RunTypes : public RunActionsTest {
 protected:
  void DeployActivated(const std::string& type) {
    Must(test::Put(Document::Kind::kCawl, "w.xml",
                   "<CAWL name=\"W\" xmlns:w=\"urn:w:\"><activator name=\"On\"><variable name=\"n\" type=\"" +
                       type + "\"/><activate flow=\"F\"/>" + When("?room", "w:dust", "?n") +
                       "</activator><flow name=\"F\"><source name=\"s\"/><node name=\"A\"><invoke "
                       "operation=\"greet\"/></node><sink name=\"e\"/><link from=\"s\" to=\"A\"/><link "
                       "from=\"A\" to=\"e\"/></flow></CAWL>"));
  }
};

TEST_F(RunTypes, ARunWhoseActivatorBindsAValueOfAWrongTypeFailsAtOnce) {
  Must(test::WorldFacts());
  DeployActivated("xsd:integer");
  const TurnResult started = Must(Tell({Fact("r1", "dust", Term::Literal("abc"))}));
  EXPECT_THAT(Said(started), Contains("F-1 running>failed: $n is of type xsd:integer, and \"abc\" is of type "
                                      "xsd:string"));
  EXPECT_TRUE(started.record.commands.empty());
  EXPECT_EQ(stages_.engine.live_runs(), 0u);
  const TurnResult good = Must(Tell({Fact("r2", "dust", Term::Integer(3))}));
  EXPECT_THAT(Said(good), Not(Contains(HasSubstr("failed"))));
  EXPECT_EQ(stages_.engine.live_runs(), 1u);
}

TEST_F(RunTypes, ASubflowThatGetsAValueOfAWrongTypeFails) {
  Must(test::WorldFacts());
  Must(test::Put(Document::Kind::kCawl, "w.xml",
                 "<CAWL name=\"W\" xmlns:w=\"urn:w:\"><flow name=\"F\"><variable name=\"n\"/>"
                 "<source name=\"s\"/><node name=\"A\"><invoke subflow=\"G\"/></node><sink name=\"e\"/>"
                 "<link from=\"s\" to=\"A\"/><link from=\"A\" to=\"e\"/></flow><flow name=\"G\">"
                 "<variable name=\"n\" type=\"w:Room\"/><source name=\"s\"/><node name=\"B\"><invoke "
                 "operation=\"greet\"/></node><sink name=\"e\"/><link from=\"s\" to=\"B\"/><link "
                 "from=\"B\" to=\"e\"/></flow></CAWL>"));
  const TurnResult result = Run({{"n", Term::Integer(7)}});
  EXPECT_THAT(Said(result), Contains("G-2 running>failed: $n is of type w:Room, and 7 is a literal"));
  EXPECT_THAT(Said(result),
              Contains("F-1 running>failed: node A: subflow G-2: $n is of type w:Room, and 7 is "
                       "a literal"));
}

}  // namespace
}  // namespace docent::server
