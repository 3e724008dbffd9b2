// docent run WORKFLOW: starts a run and follows it. docent runs: lists runs, shows one, watches.
#include <CLI/CLI.hpp>

#include <iostream>
#include <memory>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "docent/v1/workflows.grpc.pb.h"
#include "kb_server/cli/client.h"
#include "kb_server/cli/commands.h"
#include "kb_server/cli/fact_arguments.h"
#include "kb_server/cli/presenter.h"
#include "kb_server/cli/run_name.h"
#include "kb_server/cli/runs/run_printer.h"
#include "kb_server/cli/runs/steering_commands.h"
#include "kb_server/cli/variable_argument.h"
#include "kb_server/grpc/convert.h"

namespace docent::server {
namespace {

struct RunArguments {
  ClientOptions client;
  std::string workflow;
  std::string flow;
  std::vector<std::string> variables;
  std::vector<std::string> prefixes;
  bool detach = false;
};

struct RunsArguments {
  ClientOptions client;
  std::string run;
  bool live = false;
  bool watch = false;
  bool cancel = false;
  std::string workflow, state, robot;
  uint32_t limit = 0;
  std::string after;
};

// Details of an event and rows of a run are cut to so many columns.
constexpr size_t kDetailColumns = 200;

void PrintEvent(const v1::RunEvent& event, const Presenter& presenter) {
  std::cout << LocalTime(event.time_us(), "%H:%M:%E3S") << "  " << event.run();
  if (!event.node().empty()) std::cout << (event.run().empty() ? "" : "/") << event.node();  // or a workflow
  std::cout << "  " << event.kind() << " ";
  if (!event.from().empty()) std::cout << event.from() << " → ";
  std::cout << presenter.State(event.to());
  if (!event.detail().empty()) std::cout << "  " << presenter.Text(event.detail(), kDetailColumns);
  std::cout << std::endl;
}

void Print(const ClientOptions& client, const Presenter& presenter, const v1::RunEvent& event) {
  if (client.json)
    PrintJson(event);
  else
    PrintEvent(event, presenter);
}

// The date only where it is another one than that of the start.
std::string EndText(const v1::Run& run) {
  constexpr char kDate[] = "%Y-%m-%d";
  const bool same = LocalTime(run.started_us(), kDate) == LocalTime(run.ended_us(), kDate);
  return LocalTime(run.ended_us(), same ? "%H:%M:%S" : "%Y-%m-%d %H:%M:%S");
}

void PrintTable(const v1::ListRunsReply& reply, const Presenter& presenter) {
  Table table({"run", "state", "workflow", "started", "ended", "reason"});
  table.KeepWhole({0, 1, 3, 4});
  for (const v1::Run& run : reply.runs()) {
    table.Add({run.id(),
               {StateOf(run), StyleOfState(StateOf(run))},
               run.workflow(),
               LocalTime(run.started_us(), "%Y-%m-%d %H:%M:%S"),
               EndText(run),
               presenter.names().InText(run.reason())});
  }
  std::cout << table.Render(presenter.terminal());
}

int ExitCodeOf(const v1::Run& run) {
  return run.state() == "failed" || run.state() == "cancelled" ? kExitNegative : kExitOk;
}

// Events of one run, or of all, from when it is made. A lost connection is taken up again where it broke.
class EventReader {
 public:
  EventReader(std::shared_ptr<grpc::Channel> channel, const std::string& run)
      : channel_(std::move(channel)), stub_(v1::Workflows::NewStub(channel_)) {
    request_.set_run(run);
    Open();
  }
  ~EventReader() { context_->TryCancel(); }

  enum class Next { kEvent, kGap, kEnd };
  // kGap: there may be events that were missed. kEnd: see status().
  Next Read(v1::RunEvent* event) {
    while (true) {
      while (reader_->Read(event)) {
        if (event->revision() != revision_) {
          revision_ = event->revision();
          seen_ = again_ = 0;
        }
        if (again_ > 0) {
          --again_;
          continue;
        }
        ++seen_;
        return Next::kEvent;
      }
      status_ = reader_->Finish();
      const bool forgotten = status_.error_code() == grpc::StatusCode::OUT_OF_RANGE && revision_ > 0;
      if (forgotten) {
        std::cerr << "docent: the server no longer has all events of the meantime; going on with new ones\n";
        revision_ = seen_ = 0;
      } else if (status_.error_code() == grpc::StatusCode::UNAVAILABLE && connected_) {
        PauseToReconnect(!std::exchange(lost_, true));
      } else {
        return Next::kEnd;
      }
      Open();
      if (revision_ == 0 && !lost_) return Next::kGap;
    }
  }
  const grpc::Status& status() const { return status_; }

 private:
  // The turn in which the connection broke is asked for again, for those of its events that did not come.
  void Open() {
    request_.set_after(revision_ > 0 ? revision_ - 1 : 0);
    again_ = seen_;
    context_ = std::make_unique<grpc::ClientContext>();
    reader_ = stub_->Watch(context_.get(), request_);
    reader_->WaitForInitialMetadata();  // what happens from here on is heard
    if (channel_->GetState(false) != GRPC_CHANNEL_READY) return;
    connected_ = true;
    lost_ = false;
  }

  const std::shared_ptr<grpc::Channel> channel_;
  const std::unique_ptr<v1::Workflows::Stub> stub_;
  v1::WatchRequest request_;
  std::unique_ptr<grpc::ClientContext> context_;
  std::unique_ptr<grpc::ClientReader<v1::RunEvent>> reader_;
  bool connected_ = false;  // ever
  bool lost_ = false;       // and not there again
  uint64_t revision_ = 0;   // of the newest event
  uint64_t seen_ = 0;       // events of that revision
  uint64_t again_ = 0;      // of those, still to come a second time
  grpc::Status status_;
};

// Follows events until the run ends; then shows it.
int Follow(const ClientOptions& client, const Presenter& presenter, v1::Workflows::Stub* stub,
           EventReader* reader, const std::string& run_id) {
  v1::RunEvent event;
  v1::Run run;
  auto get = [&] {
    grpc::ClientContext context;
    v1::GetRunRequest request;
    request.set_run(run_id);
    run.Clear();
    return stub->Get(&context, request, &run);
  };
  grpc::Status status = get();
  while (status.ok() && run.state() == "running") {
    const EventReader::Next next = reader->Read(&event);
    if (next == EventReader::Next::kEnd) break;
    if (next == EventReader::Next::kGap) {
      status = get();
      continue;
    }
    if (event.run() != run_id) continue;
    Print(client, presenter, event);
    if (event.kind() == "run" && event.to() != "running" && event.to() != "paused") break;
  }
  if (status.ok()) status = get();
  if (!status.ok()) return Fail(status, client);
  if (client.json)
    PrintJson(run);
  else
    PrintRun(run, presenter);
  return ExitCodeOf(run);
}

int StartRun(const RunArguments& arguments) {
  v1::StartRequest request;
  request.set_workflow(arguments.workflow);
  request.set_flow(arguments.flow);
  FactArguments facts([&] { return ServerNames(arguments.client); });
  if (absl::Status status = facts.AddPrefixes(arguments.prefixes); !status.ok()) return Fail(status);
  for (const std::string& text : arguments.variables) {
    auto variable =
        ParseVariable(text, [&facts](std::string_view prefix) { return facts.Namespace(prefix); });
    if (!variable.ok()) return Fail(variable.status());
    v1::NamedTerm* named = request.add_variables();
    named->set_name(variable->first);
    ToProto(variable->second, named->mutable_value());
  }
  const std::shared_ptr<grpc::Channel> channel = Connect(arguments.client);
  auto stub = v1::Workflows::NewStub(channel);
  std::optional<EventReader> reader;
  if (!arguments.detach) reader.emplace(channel, "");  // before the run starts
  grpc::ClientContext context;
  v1::StartReply reply;
  grpc::Status status = stub->Start(&context, request, &reply);
  if (!status.ok()) return Fail(status, arguments.client);
  if (arguments.detach) {
    if (arguments.client.json)
      PrintJson(reply);
    else
      std::cout << reply.run() << "\n";
    return kExitOk;
  }
  return Follow(arguments.client, Presenter(arguments.client), stub.get(), &*reader, reply.run());
}

int Watch(const ClientOptions& client, const Presenter& presenter, const std::string& run) {
  const std::shared_ptr<grpc::Channel> channel = Connect(client);
  EventReader reader(channel, run);
  if (!run.empty()) return Follow(client, presenter, v1::Workflows::NewStub(channel).get(), &reader, run);
  v1::RunEvent event;
  for (auto next = reader.Read(&event); next != EventReader::Next::kEnd; next = reader.Read(&event)) {
    if (next == EventReader::Next::kEvent) Print(client, presenter, event);
  }
  return reader.status().ok() ? kExitOk : Fail(reader.status(), client);
}

// So many runs (0: all), a page after the other: the server gives fewer at a time where they are large.
grpc::Status ListRuns(v1::Workflows::Stub& workflows, v1::ListRunsRequest request, uint32_t limit,
                      v1::ListRunsReply* all) {
  do {
    request.set_page_size(limit == 0 ? 0 : limit - static_cast<uint32_t>(all->runs_size()));
    v1::ListRunsReply page;
    grpc::ClientContext context;
    if (grpc::Status status = workflows.ListRuns(&context, request, &page); !status.ok()) return status;
    all->mutable_runs()->MergeFrom(page.runs());
    all->set_next_page_token(page.next_page_token());
    request.set_page_token(page.next_page_token());
  } while (!request.page_token().empty() && (limit == 0 || static_cast<uint32_t>(all->runs_size()) < limit));
  return grpc::Status::OK;
}

int ShowRuns(const RunsArguments& arguments) {
  auto stub = v1::Workflows::NewStub(Connect(arguments.client));
  const Presenter presenter(arguments.client);
  if (arguments.cancel) {
    if (arguments.run.empty()) return Fail(absl::InvalidArgumentError("--cancel needs the id of a run"));
    return CancelRun(arguments.client, arguments.run);
  }
  if (arguments.watch) return Watch(arguments.client, presenter, arguments.run);
  if (!arguments.run.empty()) {
    grpc::ClientContext context;
    v1::GetRunRequest request;
    request.set_run(arguments.run);
    v1::Run run;
    grpc::Status status = stub->Get(&context, request, &run);
    if (!status.ok()) return Fail(status, arguments.client);
    if (arguments.client.json)
      PrintJson(run);
    else
      PrintRun(run, presenter);
    return ExitCodeOf(run);
  }
  v1::ListRunsRequest request;
  request.set_live_only(arguments.live);
  request.set_workflow(arguments.workflow);
  request.set_state(arguments.state);
  if (!arguments.robot.empty()) {
    FactArguments facts([&] { return ServerNames(arguments.client); });
    request.set_robot(facts.Iri(arguments.robot));
  }
  request.set_page_token(arguments.after);
  v1::ListRunsReply reply;
  grpc::Status status = ListRuns(*stub, request, arguments.limit, &reply);
  if (!status.ok()) return Fail(status, arguments.client);
  if (arguments.client.json) {
    for (const v1::Run& run : reply.runs()) PrintJson(run);
  } else if (reply.runs().empty()) {
    std::cerr << "no runs\n";
  } else {
    PrintTable(reply, presenter);
  }
  if (!reply.next_page_token().empty())
    std::cerr << "there are more; go on with --after " << reply.next_page_token() << "\n";
  return kExitOk;
}

}  // namespace

void AddRunCommand(CLI::App* app, int* exit_code) {
  auto arguments = std::make_shared<RunArguments>();
  CLI::App* command =
      app->add_subcommand("run", "Start a run of a deployed workflow, and follow it to its end");
  command->group(kRobotsGroup);
  AddClientOptions(command, &arguments->client);
  AddShowOptions(command, &arguments->client);
  command->add_option("workflow", arguments->workflow, "Name of the workflow")->required();
  command
      ->add_option("--flow", arguments->flow,
                   "Flow of the workflow to start; by default the one that its activator starts")
      ->type_name("NAME");
  command->add_option("--var", arguments->variables, "A variable of the run")
      ->type_name("NAME=VALUE")
      ->allow_extra_args(false);
  AddPrefixOption(command, &arguments->prefixes);
  command->add_flag("--detach", arguments->detach, "Print the run's id and do not follow it");
  command->footer(absl::StrCat(
      kVariableValueHelp,
      "\n"
      "Exit code 1: the run failed or was cancelled.\n"
      "Examples:\n"
      "  docent run BoothGuide --var booth=https://w3id.org/docent/expo#B03\n"
      "  docent run BoothGuide --prefix expo=https://w3id.org/docent/expo# --var user=expo:John\n"
      "  docent run Tour --var 'greeting=\"Hello, John\"@en'"));
  command->callback([arguments, exit_code] { *exit_code = StartRun(*arguments); });
}

void AddRunsCommand(CLI::App* app, int* exit_code) {
  auto arguments = std::make_shared<RunsArguments>();
  CLI::App* command = app->add_subcommand("runs",
                                          "List runs; show one with what it waits for and why its nodes "
                                          "fired; follow, pause, repair or cancel it");
  command->group(kRobotsGroup);
  AddClientOptions(command, &arguments->client);
  AddShowOptions(command, &arguments->client);
  TakesRunName(
      command->add_option("run", arguments->run, "Id of the run to show; by default all runs are listed"));
  command->add_flag("--live", arguments->live, "List only runs that have not ended");
  command->add_option("--workflow", arguments->workflow, "List only runs of this workflow")
      ->type_name("NAME");
  command
      ->add_option("--state", arguments->state,
                   "List only runs in this state: running, paused, incident, done, failed, cancelled")
      ->type_name("STATE");
  command->add_option("--robot", arguments->robot, "List only runs that have taken this robot")
      ->type_name("IRI");
  command->add_option("--limit", arguments->limit, "List at most this number of runs (default: all)")
      ->type_name("N");
  command->add_option("--after", arguments->after, "Go on where the list before ended")->type_name("TOKEN");
  command->add_flag("--watch", arguments->watch, "Print events as they happen; of one run until it ends");
  command->add_flag("--cancel", arguments->cancel, "Cancel the run");
  command->footer(
      "Runs are listed newest first. Exit code 1: the run that is shown failed or was cancelled.\n"
      "Examples:\n"
      "  docent runs --live\n"
      "  docent runs --state incident\n"
      "  docent runs BoothGuide-1 --watch\n"
      "  docent runs pause BoothGuide-1 --reason 'the hall is being cleaned'");
  AddSteeringCommands(command, exit_code);
  AddSaveCommand(command, exit_code);
  command->callback([arguments, command, exit_code] {
    if (command->get_subcommands().empty()) *exit_code = ShowRuns(*arguments);
  });
}

}  // namespace docent::server
