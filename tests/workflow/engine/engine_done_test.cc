// What is done is not done again when its node begins again, whatever came first: its success, or the failure beside it.
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/workflow/engine/engine_fixture.h"

namespace docent::engine {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using Outcome = CommandReport::Outcome;

class EngineDoneTest : public EngineTest {
 protected:
  // A node that does `f` and `g` beside each other, on two robots.
  void Begin(const std::string& attributes) {
    robots_.offers = {{RobotId("urn:r1"), "i1", false, false}, {RobotId("urn:r2"), "i1", false, false}};
    Deploy(Flow("<node name=\"A\" " + attributes +
                "><invoke operation=\"f\"/><invoke operation=\"g\"/></node><sink name=\"t\"/>" +
                Link("s", "A") + Link("A", "t")));
    Start();
    for (const RobotCommand& command : commands_) (command.operation == "f" ? f_ : g_) = command.id;
    ASSERT_EQ(commands_.size(), 2u);
  }
  std::vector<std::string> Sent() const {
    std::vector<std::string> operations;
    for (const RobotCommand& command : commands_) operations.push_back(command.operation);
    return operations;
  }
  std::string State() const { return Fact("urn:docent:run:F-1", "runState"); }
  CommandId f_, g_;
};

TEST_F(EngineDoneTest, ItSucceedsAndThenTheOtherFails) {
  Begin("ext:retry=\"3\"");
  Turn({Done(g_)});
  Turn({Failed(f_, "x")});
  EXPECT_THAT(Sent(), ElementsAre("f"));
  Turn({Done(commands_[0].id)});
  EXPECT_EQ(State(), "done");
}

TEST_F(EngineDoneTest, TheOtherFailsAndThenItSucceedsAllTheSame) {
  Begin("ext:retry=\"3\"");
  Turn({Failed(f_, "x")});
  EXPECT_THAT(cancels_, ElementsAre(g_));
  Turn({Done(g_)});
  EXPECT_THAT(Sent(), ElementsAre("f"));
  Turn({Done(commands_[0].id)});
  EXPECT_EQ(State(), "done");
}

TEST_F(EngineDoneTest, BothInOneTurnInEitherOrder) {
  for (const bool success_first : {true, false}) {
    SCOPED_TRACE(success_first);
    Begin("ext:retry=\"3\"");
    Turn(success_first ? std::vector<CommandReport>{Done(g_), Failed(f_, "x")}
                       : std::vector<CommandReport>{Failed(f_, "x"), Done(g_)});
    EXPECT_THAT(Sent(), ElementsAre("f"));
    Turn({Done(commands_[0].id)});
    EXPECT_EQ(engine_.live_runs(), 0u);
  }
}

TEST_F(EngineDoneTest, AnOperatorsRetryLeavesItDone) {
  for (const bool success_first : {true, false}) {
    SCOPED_TRACE(success_first);
    Begin("ext:onFailure=\"incident\"");
    if (success_first) Turn({Done(g_)});
    Turn({Failed(f_, "x")});
    if (!success_first) Turn({Done(g_)});
    RunRequest retry;
    retry.kind = RunRequest::Kind::kRetryNode;
    retry.target = success_first ? "F-1" : "F-2";
    retry.node = "A";
    Turn({}, {retry});
    EXPECT_THAT(Sent(), ElementsAre("f"));
    Turn({Done(commands_[0].id)});
    EXPECT_EQ(engine_.live_runs(), 0u);
  }
}

TEST_F(EngineDoneTest, WhatWasCancelledIsDoneAgain) {
  Begin("ext:retry=\"3\"");
  Turn({Failed(f_, "x")});
  EXPECT_THAT(commands_, IsEmpty());
  Turn({{g_, Outcome::kCancelled, "", 0, "i1", {}}});
  EXPECT_THAT(Sent(), ElementsAre("f", "g"));
}

}  // namespace
}  // namespace docent::engine
