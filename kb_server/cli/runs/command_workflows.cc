// docent workflows: which workflows are deployed and which texts were; undeploys, enables and disables them.
#include <CLI/CLI.hpp>

#include <algorithm>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/time/time.h"
#include "docent/v1/workflows.grpc.pb.h"
#include "graph/base/line_diff.h"
#include "kb_server/cli/client.h"
#include "kb_server/cli/commands.h"
#include "kb_server/cli/runs/run_printer.h"
#include "kb_server/cli/table.h"
#include "kb_server/cli/terminal.h"

namespace docent::server {
namespace {

struct WorkflowsArguments {
  ClientOptions client;
  std::string name;
  std::vector<uint32_t> numbers;
  uint32_t number = 0;
  bool cancel_runs = false;
};

std::string StateOf(const v1::Workflow& workflow) {
  return workflow.disabled() ? "disabled" : workflow.paused() ? "paused" : "enabled";
}

class WorkflowsClient {
 public:
  explicit WorkflowsClient(const WorkflowsArguments& arguments)
      : arguments_(arguments), stub_(v1::Workflows::NewStub(Connect(arguments.client))) {}

  int List() {
    v1::ListWorkflowsReply reply;
    grpc::ClientContext context;
    const grpc::Status status = stub_->List(&context, {}, &reply);
    if (!status.ok()) return Fail(status, arguments_.client);
    if (arguments_.client.json) {
      for (const v1::Workflow& workflow : reply.workflows()) PrintJson(workflow);
      return kExitOk;
    }
    if (reply.workflows().empty()) {
      std::cerr << "no workflow is deployed\n";
      return kExitOk;
    }
    Table table({"workflow", "version", "state", "live runs", "starts", "flows", "since revision"});
    table.KeepWhole({0, 2, 3});
    for (const v1::Workflow& workflow : reply.workflows()) {
      const std::string number = absl::StrCat(workflow.deployed_version());
      table.Add(
          {workflow.name(),
           workflow.version().empty() ? number : absl::StrCat(number, " (", workflow.version(), ")"),
           {StateOf(workflow), workflow.disabled() || workflow.paused() ? Style::kFaint : Style::kPlain},
           absl::StrCat(workflow.live_runs()),
           workflow.activated_flow(),
           absl::StrJoin(workflow.flows(), ", "),
           absl::StrCat(workflow.revision())});
    }
    std::cout << table.Render(Terminal::OfOutput(arguments_.client.colours));
    return kExitOk;
  }

  // The text of a version, for a file; without a number the newest.
  int Show() {
    v1::ListVersionsReply versions;
    if (const int failed = Versions(&versions); failed != kExitOk) return failed;
    const v1::DeployedVersion* version = Find(versions, arguments_.number);
    if (version == nullptr) return NoVersion(versions, arguments_.number);
    if (arguments_.client.json)
      PrintJson(*version);
    else
      PrintForPrograms(version->text());
    return kExitOk;
  }

  int ListVersions() {
    v1::ListVersionsReply versions;
    if (const int failed = Versions(&versions); failed != kExitOk) return failed;
    if (arguments_.client.json) {
      for (v1::DeployedVersion& version : *versions.mutable_versions()) {
        version.clear_text();
        PrintJson(version);
      }
      return kExitOk;
    }
    Table table({"number", "version", "deployed", "revision", ""});
    table.KeepWhole({0, 2, 3, 4});
    for (const v1::DeployedVersion& version : versions.versions()) {
      table.Add({absl::StrCat(version.number()), version.version(),
                 LocalTime(version.time_us(), "%Y-%m-%d %H:%M:%S"), absl::StrCat(version.revision()),
                 version.live() ? "live" : ""});
    }
    std::cout << table.Render(Terminal::OfOutput(arguments_.client.colours));
    return kExitOk;
  }

  // From one version to another: without numbers from the last but one to the last, with one from that to the last.
  int Diff() {
    v1::ListVersionsReply versions;
    if (const int failed = Versions(&versions); failed != kExitOk) return failed;
    const std::vector<uint32_t>& numbers = arguments_.numbers;
    const uint32_t newest = versions.versions().rbegin()->number();
    const uint32_t to = numbers.size() > 1 ? numbers[1] : newest;
    const uint32_t from = !numbers.empty() ? numbers[0] : newest - 1;
    if (from == 0) {
      return Fail(absl::FailedPreconditionError(absl::StrCat(
          "workflow ", arguments_.name, " has one version; there is nothing to compare it with")));
    }
    const v1::DeployedVersion* before = Find(versions, from);
    if (before == nullptr) return NoVersion(versions, from);
    const v1::DeployedVersion* after = Find(versions, to);
    if (after == nullptr) return NoVersion(versions, to);
    std::cout << LineDiff(before->text(), after->text(), absl::StrCat(arguments_.name, " ", from),
                          absl::StrCat(arguments_.name, " ", to));
    return kExitOk;
  }

  int Undeploy() {
    v1::UndeployRequest request;
    request.set_workflow(arguments_.name);
    request.set_cancel_runs(arguments_.cancel_runs);
    v1::UndeployReply reply;
    grpc::ClientContext context;
    const grpc::Status status = stub_->Undeploy(&context, request, &reply);
    if (!status.ok()) return Fail(status, arguments_.client);
    if (arguments_.client.json) {
      PrintJson(reply);
      return kExitOk;
    }
    std::cout << arguments_.name << ": undeployed with revision " << reply.revision();
    if (arguments_.cancel_runs) std::cout << ", " << reply.cancelled_runs() << " runs cancelled";
    std::cout << "\n";
    for (const std::string& by : reply.invoked_by()) {
      std::cerr << "warning: workflow " << by << " invokes " << arguments_.name
                << "; its runs fail there until it is deployed again\n";
    }
    return kExitOk;
  }

  int SetEnabled(bool enabled) {
    v1::SetEnabledRequest request;
    request.set_workflow(arguments_.name);
    request.set_enabled(enabled);
    v1::Workflow reply;
    grpc::ClientContext context;
    const grpc::Status status = stub_->SetEnabled(&context, request, &reply);
    if (!status.ok()) return Fail(status, arguments_.client);
    if (arguments_.client.json)
      PrintJson(reply);
    else
      std::cout << reply.name() << ": "
                << (enabled ? "enabled" : "disabled: it starts no run until it is enabled") << "\n";
    return kExitOk;
  }

 private:
  int Versions(v1::ListVersionsReply* reply) {
    v1::ListVersionsRequest request;
    request.set_workflow(arguments_.name);
    request.set_with_texts(true);
    grpc::ClientContext context;
    const grpc::Status status = stub_->ListVersions(&context, request, reply);
    return status.ok() ? kExitOk : Fail(status, arguments_.client);
  }

  // 0: the newest.
  static const v1::DeployedVersion* Find(const v1::ListVersionsReply& versions, uint32_t number) {
    if (number == 0) return &*versions.versions().rbegin();
    for (const v1::DeployedVersion& version : versions.versions()) {
      if (version.number() == number) return &version;
    }
    return nullptr;
  }

  int NoVersion(const v1::ListVersionsReply& versions, uint32_t number) const {
    return Fail(absl::NotFoundError(absl::StrCat(
        "workflow ", arguments_.name, " has no version ", number, " (kept are ",
        absl::StrJoin(
            versions.versions(), ", ",
            [](std::string* out, const v1::DeployedVersion& v) { absl::StrAppend(out, v.number()); }),
        ")")));
  }

  const WorkflowsArguments& arguments_;
  std::unique_ptr<v1::Workflows::Stub> stub_;
};

using ArgumentsPtr = std::shared_ptr<WorkflowsArguments>;

template <typename Action>
CLI::App* AddAction(CLI::App* workflows, const ArgumentsPtr& arguments, int* exit_code, const char* name,
                    const char* what, Action action) {
  CLI::App* command = workflows->add_subcommand(name, what);
  AddClientOptions(command, &arguments->client);
  command->add_option("name", arguments->name, "Name of the workflow")->required();
  command->callback([arguments, exit_code, action] {
    WorkflowsClient client(*arguments);
    *exit_code = action(&client);
  });
  return command;
}

}  // namespace

void AddWorkflowsCommand(CLI::App* app, int* exit_code) {
  auto arguments = std::make_shared<WorkflowsArguments>();
  CLI::App* workflows = app->add_subcommand(
      "workflows",
      "List deployed workflows; show and compare their versions; undeploy, enable and disable them");
  workflows->group(kRobotsGroup);
  workflows->require_subcommand(0, 1);
  AddClientOptions(workflows, &arguments->client);
  AddShowOptions(workflows, &arguments->client);
  workflows->footer(
      "Examples:\n  docent workflows\n  docent workflows diff BoothGuide\n"
      "  docent workflows undeploy BoothGuide --cancel-runs");
  workflows->callback([arguments, exit_code, workflows] {
    if (workflows->get_subcommands().empty()) *exit_code = WorkflowsClient(*arguments).List();
  });
  AddAction(workflows, arguments, exit_code, "show", "Print the text of a version, by default of the newest",
            [](WorkflowsClient* client) { return client->Show(); })
      ->footer("Example:\n  docent workflows show BoothGuide --version 2 > guide.cawl.xml")
      ->add_option("--version", arguments->number,
                   "Number of the version, as `docent workflows versions` prints it")
      ->type_name("N")
      ->check(CLI::PositiveNumber);
  CLI::App* versions =
      AddAction(workflows, arguments, exit_code, "versions",
                "List the texts that were deployed under a name, also of a workflow that is undeployed",
                [](WorkflowsClient* client) { return client->ListVersions(); });
  AddShowOptions(versions, &arguments->client);
  versions->footer("Example:\n  docent workflows versions BoothGuide");
  AddAction(workflows, arguments, exit_code, "diff",
            "Compare two versions line by line; without numbers the last two, with one that and the newest",
            [](WorkflowsClient* client) { return client->Diff(); })
      ->footer("Example:\n  docent workflows diff BoothGuide 1 3")
      ->add_option("numbers", arguments->numbers, "Numbers of versions: the older, the newer")
      ->type_name("N")
      ->expected(0, 2)
      ->check(CLI::PositiveNumber);
  AddAction(workflows, arguments, exit_code, "undeploy",
            "Undeploy a workflow: it starts no run, and its versions stay readable",
            [](WorkflowsClient* client) { return client->Undeploy(); })
      ->footer("Example:\n  docent workflows undeploy BoothGuide --cancel-runs")
      ->add_flag("--cancel-runs", arguments->cancel_runs, "Cancel its live runs, too; otherwise they go on");
  AddAction(workflows, arguments, exit_code, "enable",
            "Let a disabled workflow start runs again, first those that its activator held back",
            [](WorkflowsClient* client) { return client->SetEnabled(true); })
      ->footer("Example:\n  docent workflows enable BoothGuide");
  AddAction(workflows, arguments, exit_code, "disable",
            "Let a workflow start no run, by its activator or by hand; live runs go on",
            [](WorkflowsClient* client) { return client->SetEnabled(false); })
      ->footer("Example:\n  docent workflows disable BoothGuide");
}

}  // namespace docent::server
