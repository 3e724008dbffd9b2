// Robot services of several steps as the engine runs them: types of their arguments, their progress, services inside services.
#include <gmock/gmock.h>

#include "tests/workflow/engine/engine_fixture.h"
#include "workflow/rsel/parser.h"

namespace docent::engine {
namespace {

using ::testing::HasSubstr;

constexpr char kServices[] = R"(<rsel name="R">
  <message name="In"><part name="times" type="xsd:integer"/></message>
  <process name="inner"><invoke operation="a"/><invoke operation="b"/></process>
  <process name="outer"><invoke operation="inner"/><invoke operation="c"/></process>
  <process name="typed" input="In"><invoke operation="a"/></process>
</rsel>)";

class EngineServicesTest : public EngineTest {
 protected:
  EngineServicesTest() {
    rsel::ParsedRsel parsed = rsel::ParseRsel(kServices, "r.xml");
    EXPECT_TRUE(parsed.ok());
    EXPECT_FALSE(HasErrors(engine_.PutServices(parsed.document)));
  }
  void Invoke(const std::string& service, std::vector<std::pair<std::string, Term>> arguments = {}) {
    Turn({}, {{RunRequest::Kind::kInvokeService, service, std::move(arguments)}});
  }
  CommandReport Progress(double fraction) {
    CommandReport report = Done(commands_.at(0).id);
    report.outcome = CommandReport::Outcome::kProgress;
    report.progress = fraction;
    return report;
  }
  double Told() { return std::stod(Fact("urn:docent:run:outer-1/outer/0", "progress")); }
};

TEST_F(EngineServicesTest, TheProgressOfAServiceCountsTheStepsOfThoseInside) {
  Invoke("outer");
  ASSERT_EQ(commands_.size(), 1u);
  EXPECT_EQ(Told(), 0);
  const CommandReport half = Progress(0.5);
  const CommandId a = commands_[0].id;
  Turn({half});
  EXPECT_NEAR(Told(), 0.5 / 3, 0.01);
  EXPECT_EQ(Fact("urn:docent:run:outer-1/outer/0", "stepRunning"), "1/3 inner/a");
  Turn({Done(a)});
  EXPECT_NEAR(Told(), 1.0 / 3, 0.01);
  EXPECT_EQ(Fact("urn:docent:run:outer-1/outer/0", "stepDone"), "1/3 inner/a");
  EXPECT_EQ(Fact("urn:docent:run:outer-1/outer/0", "stepRunning"), "2/3 inner/b");
  const CommandId b = commands_.at(0).id;
  Turn({}, {{RunRequest::Kind::kCancel, "outer-1", {}}});
  EXPECT_EQ(cancels_, std::vector<CommandId>{b}) << "a cancel goes down to the step of the service inside";
}

TEST_F(EngineServicesTest, AWorkflowsValueOfAnotherTypeFailsTheInvocation) {
  Deploy(Flow("<variable name=\"times\"/>" + Node("A", "", "<invoke operation=\"typed\"/>") +
              "<sink name=\"t\"/>" + Link("s", "A") + Link("A", "t")));
  Turn({}, {{RunRequest::Kind::kStart, "W/F", {{"times", Term::Literal("three")}}}});
  EXPECT_TRUE(commands_.empty());
  EXPECT_THAT(Fact("urn:docent:run:F-1", "reason"),
              HasSubstr("service typed cannot take \"three\" as times, which is of xsd:string, not of "
                        "xsd:integer; it takes "
                        "times (xsd:integer)"));
  Turn({}, {{RunRequest::Kind::kStart, "W/F", {{"times", Term::Integer(3)}}}});
  EXPECT_EQ(commands_.size(), 1u);
}

}  // namespace
}  // namespace docent::engine
