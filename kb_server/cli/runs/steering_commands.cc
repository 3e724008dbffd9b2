#include "kb_server/cli/runs/steering_commands.h"

#include <CLI/CLI.hpp>

#include <functional>
#include <iostream>
#include <memory>
#include <set>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "docent/v1/workflows.grpc.pb.h"
#include "kb_server/cli/fact_arguments.h"
#include "kb_server/cli/presenter.h"
#include "kb_server/cli/run_name.h"
#include "kb_server/cli/runs/nodes_at_work.h"
#include "kb_server/cli/runs/run_printer.h"
#include "kb_server/cli/variable_argument.h"
#include "kb_server/cli/work_to_stop.h"
#include "kb_server/grpc/convert.h"

namespace docent::server {
namespace {

struct SteeringArguments {
  ClientOptions client;
  std::vector<std::string> runs;
  std::string run, workflow, node, robot, reason;
  std::vector<std::string> values, prefixes;
  bool cancel_commands = false;
  bool compensate = false;
};

int Show(const ClientOptions& client, const v1::Run& run) {
  if (client.json)
    PrintJson(run);
  else
    PrintRun(run, Presenter(client));
  return kExitOk;
}

// Asks for each run in turn; the first that is refused ends it.
int ForEach(const SteeringArguments& arguments, const std::function<int(const std::string& run)>& ask) {
  for (const std::string& run : arguments.runs) {
    if (const int code = ask(run); code != kExitOk) return code;
  }
  return kExitOk;
}

template <typename Reply>
void PrintSteered(const ClientOptions& client, const Reply& reply, const std::string& what, const char* done,
                  const char* already) {
  if (client.json) return PrintJson(reply);
  for (const std::string& run : reply.runs()) std::cout << done << " " << run << "\n";
  if (reply.runs().empty()) std::cerr << what << already << "\n";
}

// Of the runs that are paused now: what goes on in them, for people.
void SayUnderWay(v1::Workflows::Stub& workflows, const v1::PauseReply& paused) {
  std::cout << std::flush;
  for (const std::string& id : paused.runs()) {
    v1::GetRunRequest get;
    get.set_run(id);
    v1::Run run;
    grpc::ClientContext context;
    if (workflows.Get(&context, get, &run).ok()) std::cerr << StillUnderWay(run);
  }
}

// Also one that was paused already is asked to stop.
std::set<std::string> RunsToStop(const v1::PauseRequest& request, const v1::PauseReply& paused) {
  std::set<std::string> runs(paused.runs().begin(), paused.runs().end());
  if (request.has_run()) runs.insert(request.run());
  return runs;
}

int Pause(const SteeringArguments& arguments) {
  auto stub = v1::Workflows::NewStub(Connect(arguments.client));
  const auto ask = [&](v1::PauseRequest request, const std::string& what) {
    request.set_cancel_commands(arguments.cancel_commands);
    request.set_reason(arguments.reason);
    v1::PauseReply reply;
    grpc::ClientContext context;
    const grpc::Status status = stub->Pause(&context, request, &reply);
    if (!status.ok()) return Fail(status, arguments.client);
    PrintSteered(arguments.client, reply, what, "paused",
                 !request.has_run()          ? " is paused; it has no run that was not paused"
                 : arguments.cancel_commands ? " is paused already; what it does is to stop"
                                             : " is paused already");
    if (arguments.client.json) return static_cast<int>(kExitOk);
    if (arguments.cancel_commands)
      SayWorkToStop(arguments.client, RunsToStop(request, reply), "");
    else
      SayUnderWay(*stub, reply);
    return static_cast<int>(kExitOk);
  };
  if (!arguments.workflow.empty()) {
    v1::PauseRequest request;
    request.set_workflow(arguments.workflow);
    return ask(std::move(request), arguments.workflow);
  }
  return ForEach(arguments, [&](const std::string& run) {
    v1::PauseRequest request;
    request.set_run(run);
    return ask(std::move(request), run);
  });
}

int Resume(const SteeringArguments& arguments) {
  auto stub = v1::Workflows::NewStub(Connect(arguments.client));
  const auto ask = [&](const v1::ResumeRequest& request, const std::string& what) {
    v1::ResumeReply reply;
    grpc::ClientContext context;
    const grpc::Status status = stub->Resume(&context, request, &reply);
    if (!status.ok()) return Fail(status, arguments.client);
    PrintSteered(arguments.client, reply, what, "resumed",
                 request.has_run() ? " is not paused" : " goes on; it has no run that was paused");
    return static_cast<int>(kExitOk);
  };
  v1::ResumeRequest request;
  if (!arguments.workflow.empty()) {
    request.set_workflow(arguments.workflow);
    return ask(request, arguments.workflow);
  }
  return ForEach(arguments, [&](const std::string& run) {
    request.set_run(run);
    return ask(request, run);
  });
}

int Cancel(const SteeringArguments& arguments) {
  auto stub = v1::Workflows::NewStub(Connect(arguments.client));
  return ForEach(arguments, [&](const std::string& id) {
    v1::CancelRunRequest request;
    request.set_run(id);
    request.set_compensate(arguments.compensate);
    request.set_reason(arguments.reason);
    v1::Run run;
    grpc::ClientContext context;
    const grpc::Status status = stub->Cancel(&context, request, &run);
    return status.ok() ? Show(arguments.client, run) : Fail(status, arguments.client);
  });
}

// The values NAME=VALUE of the command line.
absl::Status AddValues(const SteeringArguments& arguments, FactArguments* facts,
                       google::protobuf::RepeatedPtrField<v1::NamedTerm>* out) {
  for (const std::string& text : arguments.values) {
    auto value = ParseVariable(text, [&](std::string_view prefix) { return facts->Namespace(prefix); });
    if (!value.ok()) return value.status();
    v1::NamedTerm* named = out->Add();
    named->set_name(value->first);
    ToProto(value->second, named->mutable_value());
  }
  return absl::OkStatus();
}

// The node that is meant where the command line names none: the only one with an incident.
grpc::Status FindIncident(v1::Workflows::Stub* stub, v1::SettleRequest* request) {
  grpc::ClientContext context;
  v1::GetRunRequest get;
  get.set_run(request->run());
  v1::Run run;
  if (grpc::Status status = stub->Get(&context, get, &run); !status.ok()) return status;
  std::vector<std::string> incidents;
  for (const v1::Node& node : run.nodes()) {
    if (node.state() == "incident") incidents.push_back(node.name());
  }
  if (incidents.size() == 1) {
    request->set_node(incidents[0]);
    return grpc::Status::OK;
  }
  const std::string at_work = NodesAtWork(run);
  return grpc::Status(
      grpc::StatusCode::FAILED_PRECONDITION,
      incidents.empty()
          ? absl::StrCat(
                "run ", request->run(),
                " has no incident; name the node, if it was retried and has begun nothing",
                at_work.empty()
                    ? ""
                    : absl::StrCat(". To end what runs (", at_work,
                                   "): docent runs cancel, or docent robots out ROBOT --cancel-commands"))
          : absl::StrCat("run ", request->run(), " has several incidents; name one of ",
                         absl::StrJoin(incidents, ", ")));
}

int Settle(const SteeringArguments& arguments, v1::SettleRequest::How how) {
  auto stub = v1::Workflows::NewStub(Connect(arguments.client));
  FactArguments facts([&] { return ServerNames(arguments.client); });
  v1::SettleRequest request;
  request.set_run(arguments.run);
  request.set_node(arguments.node);
  request.set_how(how);
  request.set_reason(arguments.reason);
  if (absl::Status status = facts.AddPrefixes(arguments.prefixes); !status.ok()) return Fail(status);
  if (!arguments.robot.empty()) request.set_robot(facts.Iri(arguments.robot));
  if (absl::Status status = AddValues(arguments, &facts, request.mutable_values()); !status.ok())
    return Fail(status);
  if (request.node().empty()) {
    if (grpc::Status status = FindIncident(stub.get(), &request); !status.ok())
      return Fail(status, arguments.client);
  }
  v1::Run run;
  grpc::ClientContext context;
  const grpc::Status status = stub->Settle(&context, request, &run);
  return status.ok() ? Show(arguments.client, run) : Fail(status, arguments.client);
}

int Set(const SteeringArguments& arguments) {
  auto stub = v1::Workflows::NewStub(Connect(arguments.client));
  FactArguments facts([&] { return ServerNames(arguments.client); });
  if (absl::Status status = facts.AddPrefixes(arguments.prefixes); !status.ok()) return Fail(status);
  google::protobuf::RepeatedPtrField<v1::NamedTerm> values;
  if (absl::Status status = AddValues(arguments, &facts, &values); !status.ok()) return Fail(status);
  v1::Run run;
  std::string kept;
  for (const v1::NamedTerm& value : values) {
    v1::SetVariableRequest request;
    request.set_run(arguments.run);
    *request.mutable_variable() = value;
    run.Clear();
    grpc::ClientContext context;
    const grpc::Status status = stub->SetVariable(&context, request, &run);
    if (!status.ok()) return Fail(status, arguments.client);
    absl::StrAppend(&kept, KeptValueText(run, value.name()));
  }
  const int code = Show(arguments.client, run);
  if (!arguments.client.json) std::cerr << std::flush << kept;
  return code;
}

using Arguments = std::shared_ptr<SteeringArguments>;

CLI::App* Add(CLI::App* runs, const char* name, const char* help, const Arguments& arguments) {
  CLI::App* command = runs->add_subcommand(name, help);
  AddClientOptions(command, &arguments->client);
  AddShowOptions(command, &arguments->client);
  return command;
}

void AddReason(CLI::App* command, const Arguments& arguments) {
  command->add_option("--reason", arguments->reason, "Why, for people; it stands in the run")
      ->type_name("TEXT");
}

// Runs by their ids, or all of a workflow.
void AddWhat(CLI::App* command, const Arguments& arguments) {
  CLI::Option* runs = TakesRunName(command->add_option("run", arguments->runs, "Ids of runs"));
  CLI::Option* workflow = command
                              ->add_option("--workflow", arguments->workflow,
                                           "Every live run of this workflow, and the workflow itself")
                              ->type_name("NAME");
  runs->excludes(workflow);
}
void RequireWhat(const SteeringArguments& arguments) {
  if (arguments.runs.empty() && arguments.workflow.empty())
    throw CLI::RequiredError("the id of a run, or --workflow NAME,");
}

void AddNode(CLI::App* command, const Arguments& arguments) {
  TakesRunName(command->add_option("run", arguments->run, "Id of the run"))->required();
  command->add_option("node", arguments->node, "Name of the node; by default the only one with an incident");
}

}  // namespace

int CancelRun(const ClientOptions& client, const std::string& run) {
  SteeringArguments arguments;
  arguments.client = client;
  arguments.runs = {run};
  return Cancel(arguments);
}

void AddSteeringCommands(CLI::App* runs, int* exit_code) {
  auto pause = std::make_shared<SteeringArguments>();
  CLI::App* command =
      Add(runs, "pause", "Pause runs: they open no node and send no command until they are resumed", pause);
  AddWhat(command, pause);
  command->add_flag("--cancel-commands", pause->cancel_commands,
                    "Cancel what is under way; it begins again with resume, or asks you where it must not");
  AddReason(command, pause);
  command->footer(
      "Examples:\n  docent runs pause BoothGuide-1 --reason 'the hall is being cleaned'\n  docent runs pause "
      "--workflow BoothGuide --cancel-commands");
  command->callback([pause, exit_code] {
    RequireWhat(*pause);
    *exit_code = Pause(*pause);
  });

  auto resume = std::make_shared<SteeringArguments>();
  command = Add(runs, "resume", "Let paused runs go on", resume);
  AddWhat(command, resume);
  command->footer("Example:\n  docent runs resume BoothGuide-1");
  command->callback([resume, exit_code] {
    RequireWhat(*resume);
    *exit_code = Resume(*resume);
  });

  auto cancel = std::make_shared<SteeringArguments>();
  command = Add(runs, "cancel", "Cancel runs", cancel);
  TakesRunName(command->add_option("run", cancel->runs, "Ids of runs"))->required();
  command->add_flag("--compensate", cancel->compensate,
                    "Undo what its done nodes did, by their ext:compensate, last first");
  AddReason(command, cancel);
  command->footer("Example:\n  docent runs cancel BoothGuide-1 --compensate --reason 'the visitor has left'");
  command->callback([cancel, exit_code] { *exit_code = Cancel(*cancel); });

  auto retry = std::make_shared<SteeringArguments>();
  command = Add(runs, "retry", "Settle an incident: the node begins again", retry);
  AddNode(command, retry);
  command->add_option("--robot", retry->robot, "The robot to use; by default as the workflow says")
      ->type_name("IRI");
  AddPrefixOption(command, &retry->prefixes);
  AddReason(command, retry);
  command->footer("Example:\n  docent runs retry BoothGuide-1 Move2User --robot expo:R02");
  command->callback([retry, exit_code] { *exit_code = Settle(*retry, v1::SettleRequest::RETRY); });

  auto skip = std::make_shared<SteeringArguments>();
  command = Add(runs, "skip", "Settle an incident: the node counts as done", skip);
  AddNode(command, skip);
  command->add_option("--var", skip->values, "A variable that the node would have set")
      ->type_name("NAME=VALUE")
      ->allow_extra_args(false);
  AddPrefixOption(command, &skip->prefixes);
  AddReason(command, skip);
  command->footer(absl::StrCat(kVariableValueHelp, "\n",
                               "Example:\n  docent runs skip BoothGuide-1 Move2Booth --var booth=expo:B03"));
  command->callback([skip, exit_code] { *exit_code = Settle(*skip, v1::SettleRequest::SKIP); });

  auto fail = std::make_shared<SteeringArguments>();
  command = Add(runs, "fail",
                "Settle an incident: the node fails, and with it the run unless a link handles it", fail);
  AddNode(command, fail);
  AddReason(command, fail);
  command->footer("Example:\n  docent runs fail BoothGuide-1 Move2User");
  command->callback([fail, exit_code] { *exit_code = Settle(*fail, v1::SettleRequest::FAIL); });

  auto set = std::make_shared<SteeringArguments>();
  command = Add(runs, "set", "Give variables of a live run other values", set);
  TakesRunName(command->add_option("run", set->run, "Id of the run"))->required();
  command->add_option("values", set->values, "NAME=VALUE")->required();
  AddPrefixOption(command, &set->prefixes);
  command->footer(
      absl::StrCat(kVariableValueHelp, "\n", "Example:\n  docent runs set BoothGuide-1 booth=expo:B03"));
  command->callback([set, exit_code] { *exit_code = Set(*set); });
}

}  // namespace docent::server
