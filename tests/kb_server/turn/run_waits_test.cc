// What a run waits for, told to people: runs that wait for each other.
#include "kb_server/grpc/run_waits.h"

#include <string>

#include "gmock/gmock.h"
#include "graph/store/graph_reader.h"
#include "gtest/gtest.h"
#include "kb_server/grpc/run_reader.h"
#include "tests/kb_server/turn/turn_fixture.h"

namespace docent::server {
namespace {

using test::Fact;
using test::Put;
using test::Tell;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class RunWaitsTest : public test::TurnTest {
 protected:
  void SetUp() override {
    Turn(Tell(test::FreeRobots({"R1", "R2"}, "drive")));
    const auto node = [](const std::string& name, const std::string& of) {
      return absl::StrCat("<node name=\"", name, "\"><ext:assign variable=\"robot\" expression=\"$", of,
                          "\"/><invoke operation=\"drive\"/></node>");
    };
    Turn(Put(Document::Kind::kCawl, "t.xml",
             absl::StrCat("<CAWL name=\"T\" xmlns:ext=\"https://w3id.org/docent/cawl-ext#\"><flow name=\"F\">"
                          "<variable name=\"first\"/><variable name=\"second\"/><variable name=\"robot\"/>"
                          "<source name=\"s\"/>",
                          node("A", "first"), node("B", "second"),
                          "<sink name=\"e\"/><link from=\"s\" to=\"A\"/><link from=\"A\" to=\"B\"/>"
                          "<link from=\"B\" to=\"e\"/></flow></CAWL>")));
  }
  CommandId Begin(const std::string& first, const std::string& second) {
    const TurnResult turn =
        Turn(test::Start("T/F", {{"first", test::Iri(first)}, {"second", test::Iri(second)}}));
    EXPECT_EQ(turn.record.commands.size(), 1u);
    return turn.record.commands.empty() ? CommandId() : turn.record.commands[0].id;
  }
  std::string Waits(const std::string& id) {
    const GraphReader graph(dictionary_, stages_->writer.current());
    v1::Run run;
    EXPECT_TRUE(ReadRun(graph, id, &run));
    v1::ExplainRunReply reply;
    AddWaits({.graph = &graph}, run, "", &reply);
    return TextOf(run, reply);
  }
};

TEST_F(RunWaitsTest, RunsThatWaitForEachOtherAreNamed) {
  const CommandId one = Begin("R1", "R2"), two = Begin("R2", "R1");
  Turn(test::Report(one, CommandReport::Outcome::kSucceeded));
  EXPECT_THAT(Waits("F-1"), Not(HasSubstr("each other"))) << "the other one drives, and then goes on";
  Turn(test::Report(two, CommandReport::Outcome::kSucceeded));
  for (const char* run : {"F-1", "F-2"}) {
    EXPECT_THAT(Waits(run), AllOf(HasSubstr("runs wait for each other"),
                                  HasSubstr("F-1 waits for robot <urn:w:R2>, which F-2 holds"),
                                  HasSubstr("F-2 waits for robot <urn:w:R1>, which F-1 holds")));
  }
}

// Two invokes that name their robots, and a third robot that is free.
TEST_F(RunWaitsTest, RunsThatWaitForRobotsOfTheirInvokesAreNamed) {
  Turn(Tell(test::FreeRobots({"R3"}, "drive")));
  const auto node = [](const std::string& name, const std::string& of) {
    return absl::StrCat("<node name=\"", name,
                        "\"><invoke operation=\"drive\"><ext:input part=\"robot\" variable=\"", of,
                        "\"/></invoke></node>");
  };
  Turn(Put(Document::Kind::kCawl, "t.xml",
           absl::StrCat("<CAWL name=\"T\" xmlns:ext=\"https://w3id.org/docent/cawl-ext#\"><flow name=\"F\">"
                        "<variable name=\"first\"/><variable name=\"second\"/><source name=\"s\"/>",
                        node("A", "first"), node("B", "second"),
                        "<sink name=\"e\"/><link from=\"s\" to=\"A\"/><link from=\"A\" to=\"B\"/>"
                        "<link from=\"B\" to=\"e\"/></flow></CAWL>")));
  const CommandId one = Begin("R1", "R2"), two = Begin("R2", "R1");
  Turn(test::Report(one, CommandReport::Outcome::kSucceeded));
  Turn(test::Report(two, CommandReport::Outcome::kSucceeded));
  const std::string waits = Waits("F-1");
  EXPECT_THAT(waits, HasSubstr("runs wait for each other"));
  EXPECT_THAT(waits, AllOf(HasSubstr("R2>, which is"), HasSubstr("held by run F-2")));
  EXPECT_THAT(waits, Not(HasSubstr("R3")));
  EXPECT_THAT(waits, Not(HasSubstr("held by run F-1:")));
}

// A node of two invokes, each of which waits for a robot of another run: one of these waits for the first.
TEST_F(RunWaitsTest, EachInvocationThatWaitsMayBeOfACircle) {
  Turn(Tell(test::FreeRobots({"R3"}, "drive")));
  const auto drive = [](const std::string& of) {
    return absl::StrCat("<invoke operation=\"drive\"><ext:input part=\"robot\" variable=\"", of,
                        "\"/></invoke>");
  };
  Turn(Put(Document::Kind::kCawl, "t.xml",
           absl::StrCat("<CAWL name=\"T\" xmlns:ext=\"https://w3id.org/docent/cawl-ext#\"><flow name=\"F\">"
                        "<variable name=\"first\"/><variable name=\"second\"/><variable name=\"third\"/>"
                        "<source name=\"s\"/><node name=\"A\">",
                        drive("first"), "</node><node name=\"B\">", drive("third"), drive("second"),
                        "</node><sink name=\"e\"/><link from=\"s\" to=\"A\"/><link from=\"A\" to=\"B\"/>"
                        "<link from=\"B\" to=\"e\"/></flow></CAWL>")));
  const auto begin = [this](const char* first, const char* second, const char* third) {
    return Turn(test::Start("T/F", {{"first", test::Iri(first)},
                                    {"second", test::Iri(second)},
                                    {"third", test::Iri(third)}}))
        .record.commands.at(0)
        .id;
  };
  const CommandId one = begin("R1", "R2", "R3"), two = begin("R2", "R1", "R1");
  begin("R3", "R3", "R3");
  Turn(test::Report(one, CommandReport::Outcome::kSucceeded));
  Turn(test::Report(two, CommandReport::Outcome::kSucceeded));
  EXPECT_THAT(Waits("F-1"), HasSubstr("runs wait for each other"));
}

TEST_F(RunWaitsTest, ARunThatIsToUndoWhatItDidWaitsForTheEndOfIt) {
  Turn(Put(Document::Kind::kCawl, "t.xml",
           "<CAWL name=\"T\" xmlns:ext=\"https://w3id.org/docent/cawl-ext#\"><flow name=\"F\">"
           "<variable name=\"first\"/><variable name=\"second\"/><source name=\"s\"/>"
           "<node name=\"A\" ext:compensate=\"drive\"><invoke operation=\"drive\"/></node>"
           "<sink name=\"e\"/><link from=\"s\" to=\"A\"/><link from=\"A\" to=\"e\"/></flow></CAWL>"));
  const CommandId one = Begin("R1", "R2");
  WriteBatch cancel;
  RunRequest request;
  request.kind = RunRequest::Kind::kCancel;
  request.target = "F-1";
  request.compensates = true;
  cancel.run_requests.push_back(request);
  Turn(cancel);
  EXPECT_THAT(Waits("F-1"), HasSubstr("the end of command " + one.value()));
}

}  // namespace
}  // namespace docent::server
