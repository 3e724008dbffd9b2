// A workflow whose node fires only after its condition has held for some time: on a server with a test clock,
// over a restart.
#include "gmock/gmock.h"
#include "tests/kb_server/scripted_adapter.h"
#include "tests/kb_server/server_world.h"

namespace docent::server::test {
namespace {

// Waits until a visitor has been in the hall for 200 ms while a robot is standing by.
constexpr char kPatient[] = R"(<?xml version="1.0"?>
<CAWL name="Patient" namespace="urn:w:" version="1.0" xmlns:docent="https://w3id.org/docent#"
      xmlns:ext="https://w3id.org/docent/cawl-ext#">
  <flow name="Wait">
    <variable name="person"/>
    <source name="start"/>
    <node name="Stays">
      <condition><context name="Here">
        <rule name="here" ext:for="200ms"><constraint name="at">
          <subject>?person</subject><verb>docent:isAt</verb><object>&lt;urn:w:Hall&gt;</object>
        </constraint></rule>
        <rule name="standby"><constraint name="standby">
          <subject>?robot</subject><verb>docent:status</verb><object>docent:Standby</object>
        </constraint></rule>
      </context></condition>
      <invoke operation="greet"/>
    </node>
    <sink name="end"/>
    <link from="start" to="Stays"/>
    <link from="Stays" to="end"/>
  </flow>
</CAWL>
)";

class ServerLastingTest : public ServerWorkflowTest {
 protected:
  void AdvanceMs(int ms) { clock_.Advance(std::chrono::milliseconds(ms)); }
  // Waits until the clock has been read once more: by a tick, or with this fact.
  std::string StateAfterAnotherTurn(const std::string& run) {
    MustTell(absl::StrCat(":x :counts ", ++count_, " ."));
    return FindNode(GetRun(run), "Stays")->state();
  }
  int count_ = 0;
};

TEST_F(ServerLastingTest, ANodeFiresOnceItsConditionHasHeldForTheTime) {
  settings_.clock = &clock_;
  StartServer();
  ScriptedAdapter adapter;
  MustTell(kStates);
  ASSERT_TRUE(Join("urn:w:R1", adapter.address()).ok());
  const grpc::Status deployed = Deploy("patient.xml", kPatient);
  ASSERT_TRUE(deployed.ok()) << deployed.error_message();
  v1::StartReply start;
  ASSERT_TRUE(StartRun("Patient", &start).ok());
  const std::string run = start.run();

  MustTell(":John docent:isAt :Hall .");
  AdvanceMs(150);
  EXPECT_EQ(StateAfterAnotherTurn(run), "waiting");
  MustTell(":John docent:isAt :Yard .");
  MustTell(":John docent:isAt :Hall .");
  AdvanceMs(150);
  EXPECT_EQ(StateAfterAnotherTurn(run), "waiting") << "he was away in between";

  StopServer();
  StartServer();
  AdvanceMs(49);
  EXPECT_EQ(StateAfterAnotherTurn(run), "waiting");
  EXPECT_EQ(adapter.commands().size(), 0u);
  AdvanceMs(1);  // nothing is told any more: the server's own tick does it
  WaitForRun(run, "done");
  EXPECT_EQ(adapter.commands().size(), 1u);
  const Rows rows =
      Query("PREFIX docent: <https://w3id.org/docent#> SELECT ?why { ?n docent:waitsFor ?why }");
  EXPECT_THAT(rows.rows, ::testing::IsEmpty());
}

}  // namespace
}  // namespace docent::server::test
