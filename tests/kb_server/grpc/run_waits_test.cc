// What is told of what a run waits for.
#include "kb_server/grpc/run_waits.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "graph/base/text.h"
#include "graph/calendar/time_spec.h"
#include "graph/rdf/date_time.h"
#include "graph/rdf/docent_iris.h"
#include "graph/rdf/vocabulary.h"
#include "graph/store/batch_applier.h"
#include "graph/store/graph_writer.h"

namespace docent::server {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class RunWaitsTest : public ::testing::Test {
 protected:
  void Tell(const std::string& subject, const std::string& predicate, Term object) {
    WriteBatch batch;
    batch.operations.push_back(
        {QuadOperation::Kind::kAdd, {Term::Iri(subject), Term::Iri(predicate), std::move(object), Term()}});
    ASSERT_TRUE(applier_.Apply(batch, writer_, {}).ok());
  }
  v1::ExplainRunReply Waits(const v1::Run& run, TimeMicros now_us = 0) {
    const GraphReader graph(dictionary_, writer_.current());
    v1::ExplainRunReply reply;
    AddWaits({&graph, nullptr, now_us, [this](const std::string&) { return answer_; }}, run, "", &reply);
    return reply;
  }
  static v1::Run Waiting(const std::string& ask) {
    v1::Run run;
    run.set_id("F-1");
    run.set_state("running");
    v1::Node* node = run.add_nodes();
    node->set_name("N");
    node->set_state("waiting");
    node->set_waits_for(ask);
    node->set_since_us(1'700'000'000'000'000);
    return run;
  }

  ConditionAnswer answer_ = {true, "", "", {}};
  Dictionary dictionary_;
  GraphWriter writer_{nullptr};
  BatchApplier applier_{dictionary_, Limits{}};
};

TEST_F(RunWaitsTest, ATimeAfterTheNodeWasEnteredIsToldWithItsEnd) {
  const v1::Run run = Waiting("# after 20s in the node\nASK {\n}\n");
  v1::ExplainRunReply reply = Waits(run, 1'700'000'005'000'000);
  ASSERT_EQ(reply.waits_size(), 1);
  EXPECT_EQ(reply.waits(0).kind(), "time");
  EXPECT_EQ(reply.waits(0).until_us(), 1'700'000'020'000'000);
  EXPECT_THAT(reply.waits(0).detail(), HasSubstr("2023-11-14T22:13:40"));
  EXPECT_THAT(reply.waits(0).detail(), HasSubstr("20s after it was entered"));
}

TEST_F(RunWaitsTest, ATimeThatIsNotOverIsToldBeforeARobotThatIsFree) {
  answer_.robots = {"urn:clara"};
  const v1::Run run = Waiting("# after 20s in the node\nASK {\n}\n");
  EXPECT_EQ(Waits(run, 1'700'000'005'000'000).waits(0).kind(), "time");
  EXPECT_EQ(Waits(run, 1'700'000'020'000'000).waits(0).kind(), "robot");
}

TEST_F(RunWaitsTest, EachRobotWithWhichTheConditionHoldsIsNamed) {
  for (const char* robot : {"urn:clara", "urn:hugo"})
    Tell(robot, std::string(kRdfType), Term::Iri(DocentIri("Robot")));
  Tell("urn:clara", DocentIri("heldBy"), Term::Iri("urn:docent:run:G-2"));
  Tell("urn:hugo", DocentIri("heldBy"), Term::Iri("urn:docent:run:G-3"));
  answer_.robots = {"urn:clara", "urn:hugo"};
  const v1::ExplainRunReply reply = Waits(Waiting("ASK {\n}\n"));
  ASSERT_EQ(reply.waits_size(), 2);
  EXPECT_EQ(reply.waits(0).robot(), "urn:clara");
  EXPECT_EQ(reply.waits(0).held_by(), "G-2");
  EXPECT_EQ(reply.waits(1).robot(), "urn:hugo");
  EXPECT_EQ(reply.waits(1).held_by(), "G-3");
}

TEST_F(RunWaitsTest, ATimeThatAConditionHasToHoldIsNamed) {
  const v1::Run run = Waiting("# after 20s in the node\n# rule there: for at least 5min\nASK {\n}\n");
  v1::ExplainRunReply reply = Waits(run, 1'700'000'030'000'000);
  ASSERT_EQ(reply.waits_size(), 1);
  EXPECT_EQ(reply.waits(0).until_us(), 0);
  EXPECT_EQ(reply.waits(0).detail(), "its condition holds, but not yet for the 5min that it has to hold");
  Tell(Concat(RunIri(RunId("F-1")), "/N"), DocentIri("opensAt"), DateTimeTerm(1'700'000'300'000'000));
  reply = Waits(run, 1'700'000'030'000'000);
  EXPECT_EQ(reply.waits(0).until_us(), 1'700'000'300'000'000);
  EXPECT_THAT(reply.waits(0).detail(),
              HasSubstr("5min that it has to hold; it opens it at 2023-11-14T22:18:20"));
}

TEST_F(RunWaitsTest, TheFactThatLacksForWhatHasToHoldIsNamed) {
  v1::Run run = Waiting("ASK {\n}\n");
  run.mutable_nodes(0)->set_state("running");
  v1::Invocation* invocation = run.mutable_nodes(0)->add_invocations();
  invocation->set_state("pending");
  invocation->set_reason("what has to hold while it runs does not hold");
  answer_ = {false, "<urn:john> <urn:near> ?robot", "now <urn:far>", {}};
  v1::ExplainRunReply reply = Waits(run);
  ASSERT_EQ(reply.waits_size(), 1);
  EXPECT_EQ(reply.waits(0).kind(), "fact");
  EXPECT_EQ(reply.waits(0).missing(), "<urn:john> <urn:near> ?robot");
  EXPECT_EQ(
      reply.waits(0).detail(),
      "a fact: <urn:john> <urn:near> ?robot (now <urn:far>; what has to hold while it runs does not hold)");
  answer_ = {};
  reply = Waits(run);
  ASSERT_EQ(reply.waits_size(), 1);
  EXPECT_EQ(reply.waits(0).detail(), "what has to hold while it runs does not hold");
}

TEST_F(RunWaitsTest, ATimeOfDayIsToldWithItsNextBegin) {
  const std::string window = calendar::TimeIri({{"between", "09:00-17:00"}});
  const std::string each = calendar::TimeIri({{"every", "10min"}});
  answer_ = {false, "a time", "", {}};
  const TimeMicros night = 1'700'000'000'000'000;  // 22:13:20
  v1::ExplainRunReply reply = Waits(Waiting(Concat("ASK { <", window, "> <urn:p> true }")), night);
  ASSERT_EQ(reply.waits_size(), 1);
  EXPECT_THAT(reply.waits(0).detail(), HasSubstr("its time comes at 2023-11-15T09:00:00"));
  EXPECT_EQ(reply.waits(0).until_us(), 1'700'038'800'000'000);
  reply = Waits(Waiting(Concat("ASK { <", window, "> <urn:p> true }")), night - 6 * 3600 * 1'000'000LL);
  EXPECT_EQ(reply.waits(0).until_us(), 0) << "it holds: another fact lacks";
  Tell(each, DocentIri("nextOccurrence"), Term::Literal("2023-11-14T22:20:00Z", std::string(kXsdDateTime)));
  reply = Waits(Waiting(Concat("ASK { <", each, "> <urn:p> ?at }")), night);
  EXPECT_THAT(reply.waits(0).detail(), HasSubstr("its time comes at 2023-11-14T22:20:00"));
}

TEST_F(RunWaitsTest, ItIsSaidThatTheHolderOfARobotIsPaused) {
  Tell("urn:clara", std::string(kRdfType), Term::Iri(DocentIri("Robot")));
  Tell("urn:clara", DocentIri("heldBy"), Term::Iri("urn:docent:run:G-2"));
  v1::Run run = Waiting("");
  run.mutable_nodes(0)->set_state("running");
  v1::Invocation* invocation = run.mutable_nodes(0)->add_invocations();
  invocation->set_operation("goTo");
  invocation->set_state("pending");
  invocation->set_reason("every robot that offers it serves another run");
  invocation->add_awaits()->set_robot("urn:clara");
  EXPECT_THAT(Waits(run).waits(0).detail(), Not(HasSubstr("paused")));
  Tell("urn:docent:run:G-2", DocentIri("pausedAt"),
       Term::Literal("2023-11-14T22:20:00Z", std::string(kXsdDateTime)));
  Tell("urn:docent:run:G-2", DocentIri("pauseReason"), Term::Literal("smoke"));
  EXPECT_THAT(Waits(run).waits(0).detail(),
              HasSubstr("held by run G-2, which is paused (smoke); docent runs resume G-2"));
}

TEST_F(RunWaitsTest, ACommandIsToldWithWhatKeepsItsRobotFromEndingIt) {
  Tell("urn:clara", std::string(kRdfType), Term::Iri(DocentIri("Robot")));
  v1::Run run = Waiting("");
  run.mutable_nodes(0)->set_state("running");
  v1::Invocation* invocation = run.mutable_nodes(0)->add_invocations();
  invocation->set_state("running");
  invocation->set_command("F-1/N/1/0.1/1/1@1");
  invocation->set_robot("urn:clara");
  Tell("urn:clara", DocentIri("status"), Term::Iri(DocentIri("Busy")));
  EXPECT_THAT(Waits(run).waits(0).detail(), Not(HasSubstr("which is")));
  Tell("urn:clara", DocentIri("status"), Term::Iri(DocentIri("Offline")));
  Tell("urn:clara", DocentIri("lastSeenAt"),
       Term::Literal("2023-11-14T22:20:00Z", std::string(kXsdDateTime)));
  Tell("urn:clara", DocentIri("outOfService"), Term::Literal("brush"));
  EXPECT_THAT(
      Waits(run).waits(0).detail(),
      HasSubstr("robot <urn:clara>, which is offline (last seen 2023-11-14T22:20:00Z), which is out of "
                "service (brush)"));
  run.set_state("cancelled");
  EXPECT_EQ(Waits(run).waits_size(), 0);
  Tell("urn:clara", DocentIri("endingCommand"), Term::Literal("F-1/N/1/0.1/1/1@1"));
  const v1::ExplainRunReply reply = Waits(run);
  ASSERT_EQ(reply.waits_size(), 1);
  EXPECT_THAT(TextOf(run, reply),
              HasSubstr("not yet confirmed: the end of command F-1/N/1/0.1/1/1@1 of robot "
                        "<urn:clara>, which is offline"));
}

// The reason of the invocation, which is that of one robot, stood with each.
TEST_F(RunWaitsTest, EachRobotIsToldWithWhatKeepsIt) {
  for (const char* robot : {"urn:clara", "urn:hugo"})
    Tell(robot, std::string(kRdfType), Term::Iri(DocentIri("Robot")));
  Tell("urn:clara", DocentIri("outOfService"), Term::Literal("brush"));
  Tell("urn:hugo", DocentIri("reservedBy"), Term::Iri("urn:docent:reservation:operator-1"));
  v1::Run run = Waiting("");
  run.mutable_nodes(0)->set_state("running");
  v1::Invocation* invocation = run.mutable_nodes(0)->add_invocations();
  invocation->set_operation("goTo");
  invocation->set_state("pending");
  invocation->set_reason("<urn:clara> is out of service: brush");
  invocation->add_awaits()->set_robot("urn:clara");
  invocation->add_awaits()->set_robot("urn:hugo");
  const v1::ExplainRunReply reply = Waits(run);
  ASSERT_EQ(reply.waits_size(), 2);
  EXPECT_THAT(reply.waits(0).detail(), HasSubstr("out of service (brush)"));
  EXPECT_THAT(reply.waits(1).detail(), HasSubstr("reserved"));
  EXPECT_THAT(reply.waits(1).detail(), Not(HasSubstr("clara")));
}

}  // namespace
}  // namespace docent::server
