// docent robots: the robots that the server knows.
#include <iostream>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "docent/v1/fleet.grpc.pb.h"
#include "graph/rdf/date_time.h"
#include "graph/rdf/docent_iris.h"
#include "kb_server/cli/client.h"
#include "kb_server/cli/commands.h"
#include "kb_server/cli/fact_arguments.h"
#include "kb_server/cli/presenter.h"
#include "kb_server/cli/robots/robot_work.h"
#include "kb_server/cli/work_to_stop.h"
#include "workflow/xml/xml_document.h"

namespace docent::server {
namespace {

std::string PoseText(const v1::RobotStatus& robot) {
  if (!robot.has_pose()) return "";
  return absl::StrFormat("%.2f, %.2f m, %.2f rad", robot.x_m(), robot.y_m(), robot.heading_rad());
}

std::string StateText(const v1::RobotStatus& robot) {
  if (!robot.out_of_service()) return robot.state();
  return absl::StrCat(robot.state(), ", out of service: ", robot.out_of_service_reason());
}

// "operator-12 for run Tour-1 until 2026-11-25T10:00:00Z, priority 5".
std::string ReservationText(const v1::RobotReservation& reservation) {
  constexpr std::string_view kIri = "urn:docent:reservation:";
  std::string text = reservation.reservation();
  if (text.starts_with(kIri)) text = text.substr(kIri.size());
  if (!reservation.kept_for().empty()) absl::StrAppend(&text, " for ", reservation.kept_for());
  if (reservation.until_us() != 0)
    absl::StrAppend(&text, " until ", DateTimeTerm(reservation.until_us()).lexical);
  absl::StrAppend(&text, ", priority ", reservation.priority());
  return reservation.reason().empty() ? text : absl::StrCat(text, ": ", reservation.reason());
}

int ListRobots(const ClientOptions& options) {
  v1::ListRobotsReply reply;
  const grpc::Status status = AllRobots(*v1::Fleet::NewStub(Connect(options)), &reply);
  if (!status.ok()) return Fail(status, options);
  if (options.json) {
    for (const v1::RobotStatus& robot : reply.robots()) PrintJson(robot);
    return kExitOk;
  }
  if (reply.robots().empty()) {
    std::cerr << "no robot has joined\n";
    return kExitOk;
  }
  const Presenter presenter(options);
  Table table(
      {"robot", "state", "x, y, heading", "in", "held by", "reserved", "operations", "can", "adapter"});
  table.KeepWhole({0, 1});
  for (const v1::RobotStatus& robot : reply.robots()) {
    const auto named = [&](std::string* out, const std::string& iri) { out->append(presenter.Iri(iri)); };
    table.Add({presenter.Iri(robot.robot()),
               {StateText(robot), StyleOfState(robot.state())},
               PoseText(robot),
               absl::StrJoin(robot.regions(), " ", named),
               HeldText(robot),
               absl::StrJoin(robot.reservations(), "; ",
                             [](std::string* out, const v1::RobotReservation& reservation) {
                               out->append(ReservationText(reservation));
                             }),
               absl::StrJoin(robot.operations(), " "),
               absl::StrJoin(robot.capabilities(), " ", named),
               robot.address()});
  }
  std::cout << table.Render(presenter.terminal());
  return kExitOk;
}

struct ServiceArguments {
  ClientOptions client;
  std::string robot, reason;
  std::vector<std::string> prefixes;
  bool cancel_commands = false;
};

// Says also where a robot was written with a prefix that is not known.
int FailOf(const grpc::Status& status, const ClientOptions& options, const FactArguments& facts) {
  const int code = Fail(status, options);
  std::cerr << facts.taken_whole();
  return code;
}

// What the robot goes on with, or is to stop, for people; nothing where the server does not say.
void SayWork(const ClientOptions& client, v1::Fleet::Stub& fleet, const std::string& robot, bool cancels) {
  v1::ListRobotsReply reply;
  if (!AllRobots(fleet, &reply).ok()) return;
  for (const v1::RobotStatus& each : reply.robots()) {
    if (each.robot() != robot) continue;
    if (!cancels) {
      std::cerr << WorkAfterOut(each);
      continue;
    }
    std::set<std::string> runs;
    for (const v1::RobotTask& task : each.held_for())
      runs.insert(task.run().empty() ? each.held_by() : task.run());
    SayWorkToStop(client, runs, robot);
  }
}

int SetService(const ServiceArguments& arguments, bool in) {
  FactArguments facts([&] { return ServerNames(arguments.client); });
  if (absl::Status status = facts.AddPrefixes(arguments.prefixes); !status.ok()) return Fail(status);
  auto stub = v1::Fleet::NewStub(Connect(arguments.client));
  grpc::ClientContext context;
  v1::ServiceStateReply reply;
  grpc::Status status;
  if (in) {
    v1::PutInServiceRequest request;
    request.set_robot(facts.Iri(arguments.robot));
    status = stub->PutInService(&context, request, &reply);
  } else {
    v1::TakeOutOfServiceRequest request;
    request.set_robot(facts.Iri(arguments.robot));
    request.set_cancel_commands(arguments.cancel_commands);
    request.set_reason(arguments.reason);
    status = stub->TakeOutOfService(&context, request, &reply);
  }
  if (!status.ok()) return FailOf(status, arguments.client, facts);
  if (arguments.client.json) {
    PrintJson(reply);
    return kExitOk;
  }
  std::cout << arguments.robot << (in ? " is in service\n" : " is out of service\n") << std::flush;
  if (!in) SayWork(arguments.client, *stub, facts.Iri(arguments.robot), arguments.cancel_commands);
  return kExitOk;
}

void AddServiceCommands(CLI::App* robots, int* exit_code) {
  for (const bool in : {false, true}) {
    auto arguments = std::make_shared<ServiceArguments>();
    CLI::App* command = robots->add_subcommand(
        in ? "in" : "out", in ? "Put a robot in service again"
                              : "Take a robot out of service: it gets no further command until it is put in");
    AddClientOptions(command, &arguments->client);
    AddPrefixOption(command, &arguments->prefixes);
    command->add_option("robot", arguments->robot, "The robot: prefix:name or an IRI")->required();
    if (!in) {
      command->add_flag("--cancel-commands", arguments->cancel_commands,
                        "Cancel what it does; by default its commands end");
      command
          ->add_option("--reason", arguments->reason,
                       "Why, for people; by default the reason that was given before")
          ->type_name("TEXT");
    }
    command->callback([arguments, in, exit_code] { *exit_code = SetService(*arguments, in); });
  }
}

struct ReserveArguments {
  ClientOptions client;
  std::vector<std::string> robots, prefixes;
  std::string kept_for, lasting, until, reason;
  int priority = 0;
};

int Reserve(const ReserveArguments& arguments) {
  FactArguments facts([&] { return ServerNames(arguments.client); });
  if (absl::Status status = facts.AddPrefixes(arguments.prefixes); !status.ok()) return Fail(status);
  v1::ReserveRequest request;
  for (const std::string& robot : arguments.robots) request.add_robots(facts.Iri(robot));
  request.set_kept_for(arguments.kept_for);
  request.set_priority(arguments.priority);
  request.set_reason(arguments.reason);
  int64_t lasting_ms = 0;
  if (!arguments.lasting.empty() && !xml::ParseDurationMs(arguments.lasting, &lasting_ms)) {
    return Fail(absl::InvalidArgumentError(
        absl::StrCat("--lasting ", arguments.lasting,
                     " is not a duration; write a number and ms, s, min or h, e.g. 10min")));
  }
  request.set_lasting_ms(lasting_ms);
  if (!arguments.until.empty()) {
    request.set_until_us(MicrosOfDateTime(arguments.until));
    if (request.until_us() == 0) {
      return Fail(absl::InvalidArgumentError(
          absl::StrCat("--until ", arguments.until,
                       " is not a date and time with a zone; write e.g. 2026-12-01T14:30:00+01:00")));
    }
  }
  grpc::ClientContext context;
  v1::ReserveReply reply;
  const grpc::Status status =
      v1::Fleet::NewStub(Connect(arguments.client))->Reserve(&context, request, &reply);
  if (!status.ok()) return FailOf(status, arguments.client, facts);
  if (arguments.client.json)
    PrintJson(reply);
  else
    std::cout << absl::StrJoin(arguments.robots, ", ") << (arguments.robots.size() == 1 ? " is" : " are")
              << " reserved: " << ReservationText(reply.reservation()) << "\n";
  return kExitOk;
}

struct ReleaseArguments {
  ClientOptions client;
  std::string reservation;
};

int Release(const ReleaseArguments& arguments) {
  grpc::ClientContext context;
  v1::ReleaseRequest request;
  v1::ReleaseReply reply;
  const bool is_iri = arguments.reservation.starts_with("urn:");
  request.set_reservation(is_iri ? arguments.reservation : ReservationIri(arguments.reservation));
  const grpc::Status status =
      v1::Fleet::NewStub(Connect(arguments.client))->Release(&context, request, &reply);
  if (!status.ok()) return Fail(status, arguments.client);
  if (arguments.client.json)
    PrintJson(reply);
  else
    std::cout << arguments.reservation << " is released\n";
  return kExitOk;
}

void AddReservationCommands(CLI::App* robots, int* exit_code) {
  auto reserve = std::make_shared<ReserveArguments>();
  CLI::App* command = robots->add_subcommand(
      "reserve",
      "Keep robots for a run or a workflow: other runs take them only if they are of a higher priority");
  AddClientOptions(command, &reserve->client);
  AddPrefixOption(command, &reserve->prefixes);
  command->add_option("robot", reserve->robots, "The robots, all of them or none: prefix:name or an IRI")
      ->required();
  command
      ->add_option("--for", reserve->kept_for,
                   "A live run or a deployed workflow; by default they are kept for none")
      ->type_name("RUN|WORKFLOW");
  command->add_option("--priority", reserve->priority, "-1000 to 1000; runs of a higher one take the robots")
      ->type_name("N");
  CLI::Option* lasting =
      command->add_option("--lasting", reserve->lasting, "How long: 10min, 1h, at most 720h")
          ->type_name("DURATION");
  command->add_option("--until", reserve->until, "Until when, with a zone: 2026-12-01T14:30:00+01:00")
      ->type_name("TIME")
      ->excludes(lasting);
  command->add_option("--reason", reserve->reason, "Why, for people")->type_name("TEXT");
  command->footer(
      "It also ends with the run that it is for, and by docent robots release. One of --for, --lasting and "
      "--until is needed.\n"
      "Examples:\n"
      "  docent robots reserve expo:R01 expo:R02 --for Tour --lasting 30min --priority 5\n"
      "  docent robots reserve expo:R01 --until 2026-12-01T14:30:00Z --reason 'a visit of the mayor'");
  command->callback([reserve, exit_code] { *exit_code = Reserve(*reserve); });

  auto release = std::make_shared<ReleaseArguments>();
  command = robots->add_subcommand("release", "End a reservation");
  AddClientOptions(command, &release->client);
  command
      ->add_option("reservation", release->reservation, "As docent robots and reserve show it: operator-12")
      ->required();
  command->callback([release, exit_code] { *exit_code = Release(*release); });
}

}  // namespace

void AddRobotsCommand(CLI::App* app, int* exit_code) {
  auto options = std::make_shared<ClientOptions>();
  CLI::App* command = app->add_subcommand("robots",
                                          "List the robots with state, pose, region and operations; reserve "
                                          "them; take one out of service, or put it in");
  command->group(kRobotsGroup);
  AddClientOptions(command, options.get());
  AddShowOptions(command, options.get());
  command->footer(
      "Examples:\n"
      "  docent robots --json\n"
      "  docent robots out expo:R01 --reason 'a wheel squeaks'\n"
      "  docent robots in expo:R01\n"
      "  docent robots reserve expo:R01 --for Tour --lasting 30min");
  AddServiceCommands(command, exit_code);
  AddReservationCommands(command, exit_code);
  command->callback([options, command, exit_code] {
    if (command->get_subcommands().empty()) *exit_code = ListRobots(*options);
  });
}

}  // namespace docent::server
