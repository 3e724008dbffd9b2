// Workflows, robot services and the fleet over gRPC with a real adapter; starting, refusing to start, and
// starting again.
#include "kb_server/server.h"

#include <sys/stat.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <set>
#include <thread>

#include "gmock/gmock.h"
#include "graph/log/folder_copy.h"
#include "tests/kb_server/scripted_adapter.h"
#include "tests/kb_server/server_world.h"
#include "tests/kb_server/test_world.h"

namespace docent::server::test {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

TEST_F(ServerWorkflowTest, CheckShowsMistakesAndConditions) {
  StartServer();
  ASSERT_TRUE(Join("urn:w:R1", "127.0.0.1:1").ok());
  v1::CheckRequest request;
  v1::CheckReply reply;
  request.set_name("greeting.xml");
  request.set_cawl(kGreeting);
  ASSERT_TRUE(Call(workflows_, &v1::Workflows::Stub::Check, request, &reply).ok());
  ASSERT_EQ(reply.conditions_size(), 2);
  EXPECT_THAT(reply.conditions(0).ask(), HasSubstr("isNear"));
  for (const v1::Diagnostic& diagnostic : reply.diagnostics())
    EXPECT_TRUE(diagnostic.warning()) << diagnostic.message();

  request.set_cawl("<?xml version=\"1.0\"?>\n<!DOCTYPE CAWL [<!ENTITY a \"b\">]>\n<CAWL name=\"&a;\"/>");
  reply.Clear();
  ASSERT_TRUE(Call(workflows_, &v1::Workflows::Stub::Check, request, &reply).ok());
  ASSERT_GE(reply.diagnostics_size(), 1);
  EXPECT_EQ(reply.diagnostics(0).line(), 2);
  EXPECT_FALSE(reply.diagnostics(0).warning());
  EXPECT_THAT(reply.diagnostics(0).message(), HasSubstr("document type definition"));
  EXPECT_THAT(reply.diagnostics(0).hint(), HasSubstr("remove it"));
}

TEST_F(ServerWorkflowTest, ABadWorkflowIsNotDeployed) {
  StartServer();
  grpc::Status status = Deploy("bad.xml", "<?xml version=\"1.0\"?>\n<!DOCTYPE CAWL>\n<CAWL/>");
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_THAT(status.error_message(), HasSubstr("bad.xml:2:1: error: a document type definition"));
  std::string text = kGreeting;
  text.replace(text.find("to=\"Goodbye\""), 12, "to=\"Godbye\"");
  status = Deploy("bad.xml", text);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_THAT(status.error_message(), HasSubstr("Godbye"));
  EXPECT_THAT(status.error_message(), HasSubstr("bad.xml:20:"));
  v1::StartReply start;
  status = StartRun("Greeting", &start);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::NOT_FOUND);
  EXPECT_THAT(status.error_message(), HasSubstr("Greeting"));
  EXPECT_EQ(Revision(), 0u);
}

TEST_F(ServerWorkflowTest, ARunIsStartedWatchedAndDone) {
  StartServer();
  ScriptedAdapter adapter;
  SetUpGreeting(adapter.address());
  v1::ListWorkflowsReply list;
  ASSERT_TRUE(Call(workflows_, &v1::Workflows::Stub::List, v1::ListWorkflowsRequest(), &list).ok());
  ASSERT_EQ(list.workflows_size(), 1);
  EXPECT_EQ(list.workflows(0).name(), "Greeting");
  EXPECT_THAT(list.workflows(0).flows(), ElementsAre("Greet"));

  grpc::ClientContext watch_context;
  Limit(&watch_context);
  auto watch = workflows_->Watch(&watch_context, v1::WatchRequest());
  watch->WaitForInitialMetadata();  // from now on nothing is missed
  v1::StartReply start;
  ASSERT_TRUE(StartRun("Greeting", &start, "greet").ok());
  EXPECT_EQ(start.run(), "Greet-1");
  v1::Run run = GetRun("Greet-1");
  EXPECT_EQ(run.state(), "running");
  EXPECT_EQ(FindNode(run, "Hello")->state(), "waiting");
  EXPECT_THAT(FindNode(run, "Hello")->waits_for(), HasSubstr("isNear"));
  EXPECT_EQ(FindNode(run, "Goodbye")->state(), "inactive");

  MustTell(":John docent:isAt :Hall ; docent:feels docent:Glad . :R1 docent:isAt :Hall .");
  run = WaitForRun("Greet-1", "done");
  EXPECT_THAT(FindNode(run, "Hello")->fired_because(),
              HasSubstr("<urn:w:John> <https://w3id.org/docent#isNear> <urn:w:R1> ."));
  ASSERT_EQ(FindNode(run, "Hello")->invocations_size(), 1);
  EXPECT_EQ(FindNode(run, "Hello")->invocations(0).robot(), "urn:w:R1");
  EXPECT_THAT(adapter.commands(),
              ElementsAre(StartsWith("Greet-1/Hello/0/0.1/1/1@"), StartsWith("Greet-1/Goodbye/0/0.1/1/1@")));

  std::vector<std::string> events;
  v1::RunEvent event;
  uint64_t revision = 0;
  while (watch->Read(&event)) {
    EXPECT_EQ(event.run(), "Greet-1");
    EXPECT_GE(event.revision(), revision);
    revision = event.revision();
    events.push_back(absl::StrCat(event.kind(), " ", event.node(), " ", event.to()));
    if (event.kind() == "run" && event.to() == "done") break;
  }
  EXPECT_EQ(events.front(), "run  running");
  EXPECT_THAT(events, Contains("node Hello waiting"));
  EXPECT_THAT(events, Contains("command Hello sent"));
  EXPECT_THAT(events, Contains("report Hello succeeded"));
  EXPECT_EQ(events.back(), "run  done");
  watch_context.TryCancel();

  // the same request again starts nothing
  v1::StartReply again;
  ASSERT_TRUE(StartRun("Greeting", &again, "greet").ok());
  EXPECT_EQ(again.run(), "Greet-1");
  EXPECT_EQ(again.revision(), start.revision());
}

TEST_F(ServerWorkflowTest, ARunIsCancelled) {
  StartServer();
  SetUpGreeting();
  v1::StartReply start;
  ASSERT_TRUE(StartRun("Greeting", &start).ok());
  v1::CancelRunRequest cancel;
  cancel.set_run(start.run());
  v1::Run run;
  ASSERT_TRUE(Call(workflows_, &v1::Workflows::Stub::Cancel, cancel, &run).ok());
  EXPECT_EQ(run.state(), "cancelled");
  EXPECT_GT(run.ended_us(), 0);
  EXPECT_EQ(Call(workflows_, &v1::Workflows::Stub::Cancel, cancel, &run).error_code(),
            grpc::StatusCode::NOT_FOUND);
  v1::ListRunsRequest list;
  v1::ListRunsReply runs;
  list.set_live_only(true);
  ASSERT_TRUE(Call(workflows_, &v1::Workflows::Stub::ListRuns, list, &runs).ok());
  EXPECT_EQ(runs.runs_size(), 0);
  list.set_live_only(false);
  ASSERT_TRUE(Call(workflows_, &v1::Workflows::Stub::ListRuns, list, &runs).ok());
  EXPECT_EQ(runs.runs_size(), 1);
  v1::GetRunRequest get;
  get.set_run("Greet-77");
  EXPECT_EQ(Call(workflows_, &v1::Workflows::Stub::Get, get, &run).error_code(), grpc::StatusCode::NOT_FOUND);
}

TEST_F(ServerWorkflowTest, ARestartKeepsEverything) {
  StartServer();
  SetUpGreeting();
  MustTell(":John docent:isAt :Hall .");
  v1::AssertReply told;
  ASSERT_TRUE(Assert(Turtle(":R1 docent:isAt :Hall .", "R1 is here"), &told).ok());
  ASSERT_TRUE(Register(kServices).ok());
  v1::StartReply start;
  ASSERT_TRUE(StartRun("Greeting", &start, "greet").ok());
  EXPECT_EQ(GetRun("Greet-1").state(), "running");
  std::string query =
      "SELECT ?s ?p ?o ?g { GRAPH ?g { ?s ?p ?o } FILTER(?g != <https://w3id.org/docent#runs>) } ORDER BY ?g "
      "?s ?p ?o";
  Rows before = Query(query);
  StopServer();

  ScriptedAdapter adapter;
  StartServer();
  Rows after = Query(query);
  EXPECT_EQ(after.rows, before.rows);
  v1::AssertReply repeat;
  ASSERT_TRUE(Assert(Turtle(":R1 docent:isAt :Hall .", "R1 is here"), &repeat).ok());
  EXPECT_TRUE(repeat.repeated());
  EXPECT_EQ(repeat.offset(), told.offset());
  v1::StartReply again;
  ASSERT_TRUE(StartRun("Greeting", &again, "greet").ok());
  EXPECT_EQ(again.run(), start.run());
  v1::ListWorkflowsReply workflows;
  ASSERT_TRUE(Call(workflows_, &v1::Workflows::Stub::List, v1::ListWorkflowsRequest(), &workflows).ok());
  EXPECT_EQ(workflows.workflows_size(), 1);
  v1::ListServicesReply services;
  ASSERT_TRUE(Call(services_, &v1::RobotServices::Stub::List, v1::ListServicesRequest(), &services).ok());
  EXPECT_EQ(services.services_size(), 1);

  // the run continues: its command finds the adapter at its new address
  ASSERT_TRUE(Join("urn:w:R1", adapter.address()).ok());
  MustTell(":John docent:feels docent:Glad .");
  WaitForRun("Greet-1", "done");
  EXPECT_THAT(adapter.commands(),
              ElementsAre(StartsWith("Greet-1/Hello/0/0.1/1/1@"), StartsWith("Greet-1/Goodbye/0/0.1/1/1@")));
}

// An adapter with a journal would answer a known id with the old result, and do nothing.
TEST_F(ServerWorkflowTest, AnOlderBackupPutBackGivesNoCommandIdTwice) {
  ScriptedAdapter adapter;
  StartServer();
  SetUpGreeting(adapter.address());
  ASSERT_TRUE(log::CopyFolder(settings_.data_folder, folder_ / "backup").ok());
  const auto greet = [this] {
    v1::StartReply start;
    ASSERT_TRUE(StartRun("Greeting", &start).ok());
    EXPECT_EQ(start.run(), "Greet-1");
    MustTell(":John docent:isAt :Hall ; docent:feels docent:Glad . :R1 docent:isAt :Hall .");
    WaitForRun("Greet-1", "done");
  };
  greet();
  StopServer();
  std::filesystem::remove_all(settings_.data_folder);
  ASSERT_TRUE(log::CopyFolder(folder_ / "backup", settings_.data_folder).ok());
  StartServer();
  ASSERT_TRUE(Join("urn:w:R1", adapter.address()).ok());
  greet();
  const std::vector<std::string> commands = adapter.commands();
  EXPECT_EQ(commands.size(), 4u);
  EXPECT_EQ(std::set<std::string>(commands.begin(), commands.end()).size(), 4u);
}

class ServerStartTest : public ServerTest {
 protected:
  absl::Status TryStart(const ServerSettings& settings) { return Server::Start(settings, nullptr).status(); }
  std::string WriteFile(const std::string& name, const std::string& text) {
    std::ofstream(folder_ / name) << text;
    return folder_ / name;
  }
};

TEST_F(ServerStartTest, APortInUseIsAClearError) {
  StartServer();
  ServerSettings second = settings_;
  second.data_folder = folder_ / "second";
  second.grpc_address = server_->grpc_address();
  absl::Status status = TryStart(second);
  EXPECT_EQ(status.code(), absl::StatusCode::kUnavailable);
  EXPECT_THAT(std::string(status.message()), HasSubstr("cannot listen on " + server_->grpc_address()));
  second.grpc_address = "127.0.0.1:0";
  second.http_address = server_->http_address();
  status = TryStart(second);
  EXPECT_FALSE(status.ok());
  EXPECT_THAT(std::string(status.message()), HasSubstr("--http"));
  EXPECT_THAT(std::string(status.message()), ::testing::Not(HasSubstr("\n")));
  EXPECT_TRUE(Assert(Turtle(":a :b :c .")).ok());
}

TEST_F(ServerStartTest, AServerThatCannotListenEndsAlthoughClientsKnock) {
  StartServer();
  ServerSettings second = settings_;
  second.data_folder = folder_ / "second";
  second.http_address = server_->http_address();  // taken; gRPC is there first
  {
    ServerSettings third = settings_;
    third.data_folder = folder_ / "third";
    auto free = Server::Start(third, nullptr);
    ASSERT_TRUE(free.ok()) << free.status();
    second.grpc_address = (*free)->grpc_address();
  }
  std::atomic<bool> enough = false;
  std::thread client([&] {
    grpc::ChannelArguments arguments;
    for (const char* backoff : {GRPC_ARG_INITIAL_RECONNECT_BACKOFF_MS, GRPC_ARG_MIN_RECONNECT_BACKOFF_MS,
                                GRPC_ARG_MAX_RECONNECT_BACKOFF_MS}) {
      arguments.SetInt(backoff, 1);
    }
    auto stub = v1::Context::NewStub(
        grpc::CreateCustomChannel(second.grpc_address, grpc::InsecureChannelCredentials(), arguments));
    while (!enough) {
      grpc::ClientContext context;
      context.set_wait_for_ready(true);
      context.set_deadline(std::chrono::system_clock::now() + std::chrono::milliseconds(100));
      v1::AssertReply reply;
      stub->Assert(&context, Turtle(":a :b :c ."), &reply);
    }
  });
  for (int i = 0; i < 20; ++i) {
    EXPECT_THAT(std::string(TryStart(second).message()), HasSubstr("--http"));
  }
  enough = true;
  client.join();
}

TEST_F(ServerStartTest, NobodyIsListenedToBeforeTheFilesAreLoaded) {
  StartServer();
  settings_.grpc_address = server_->grpc_address();
  StopServer();
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  settings_.ontologies = {absl::StrCat("/dev/fd/", ends[0])};
  std::thread start([this] { StartServer(); });
  const std::string comment(size_t{1} << 20,
                            '\n');  // more than a pipe holds: written when the server reads it
  ASSERT_EQ(write(ends[1], comment.data(), comment.size()), static_cast<ssize_t>(comment.size()));
  grpc::ChannelArguments own;
  own.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
  auto early = v1::Context::NewStub(
      grpc::CreateCustomChannel(settings_.grpc_address, grpc::InsecureChannelCredentials(), own));
  grpc::ClientContext context;
  Limit(&context);
  v1::AssertReply reply;
  EXPECT_EQ(early->Assert(&context, Turtle(":a :b :c ."), &reply).error_code(),
            grpc::StatusCode::UNAVAILABLE);
  const std::string place = "@prefix : <urn:w:> . :Hall a :Place .";
  ASSERT_EQ(write(ends[1], place.data(), place.size()), static_cast<ssize_t>(place.size()));
  close(ends[1]);
  start.join();
  close(ends[0]);
  EXPECT_TRUE(Ask(":Hall a :Place"));
  EXPECT_FALSE(Ask(":a :b :c"));
}

TEST_F(ServerStartTest, APipeThatNobodyWritesToIsNoOntology) {
  const std::string file = folder_ / "place.ttl";
  ASSERT_EQ(mkfifo(file.c_str(), 0600), 0);
  settings_.ontologies = {file};
  EXPECT_THAT(std::string(TryStart(settings_).message()), HasSubstr("is no regular file"));
}

TEST_F(ServerStartTest, AFolderInUseOrUnusableIsAClearError) {
  StartServer();
  EXPECT_EQ(TryStart(settings_).code(), absl::StatusCode::kFailedPrecondition);
  ServerSettings second = settings_;
  second.data_folder = WriteFile("file", "no folder");
  EXPECT_FALSE(TryStart(second).ok());
}

TEST_F(ServerStartTest, AnAddressThatOthersCanReachHasToBeMeant) {
  settings_.grpc_address = "0.0.0.0:0";
  absl::Status status = TryStart(settings_);
  EXPECT_EQ(status.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(std::string(status.message()), HasSubstr("--insecure"));
  settings_.grpc_address = "127.0.0.1";
  EXPECT_EQ(TryStart(settings_).code(), absl::StatusCode::kInvalidArgument);
}

TEST_F(ServerStartTest, FilesAreLoadedOnceAndMistakesInThemShown) {
  settings_.ontologies = {WriteFile("place.ttl", "@prefix : <urn:w:> . :Hall a :Place ; :has [ :a :b ] .")};
  settings_.rules = {WriteFile("place.rules", "RULE { ?x a <urn:w:Thing> } WHERE { ?x a <urn:w:Place> }")};
  StartServer();
  EXPECT_TRUE(Ask(":Hall a :Thing"));
  EXPECT_EQ(Revision(), 2u);
  StopServer();
  StartServer();
  EXPECT_EQ(Revision(), 2u) << "nothing changed, nothing is loaded";
  StopServer();
  WriteFile("place.ttl", "@prefix : <urn:w:> . :Yard a :Place .");
  StartServer();
  EXPECT_EQ(Revision(), 3u);
  EXPECT_FALSE(Ask(":Hall a :Thing"));
  StopServer();
  WriteFile("place.ttl", "@prefix : <urn:w:> .\n:Yard a .");
  absl::Status status = TryStart(settings_);
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(status.message()), HasSubstr("place.ttl:2:9"));
  settings_.ontologies = {folder_ / "nothing.ttl"};
  EXPECT_EQ(TryStart(settings_).code(), absl::StatusCode::kNotFound);
}

TEST_F(ServerStartTest, AFileMayHaveAnyName) {
  settings_.ontologies = {WriteFile("my place (1)+100%.ttl", "@prefix : <urn:w:> . :Hall :has [ :a :b ] .")};
  StartServer();
  EXPECT_TRUE(Ask("GRAPH <https://w3id.org/docent/ontology/my%20place%20(1)+100%25.ttl> { :Hall :has ?x }"));
  StopServer();
  StartServer();
  EXPECT_EQ(Revision(), 1u) << "nothing changed, nothing is loaded";
}

}  // namespace
}  // namespace docent::server::test
