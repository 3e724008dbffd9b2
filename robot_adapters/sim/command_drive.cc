// docent-robot: a simulated guide robot in a hall.
#include <spdlog/spdlog.h>

#include <filesystem>
#include <iostream>
#include <memory>

#include "CLI/CLI.hpp"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_split.h"
#include "graph/base/data_files.h"
#include "graph/command_line/usage_error.h"
#include "maps/hall_model.h"
#include "robot_adapters/sim/commands.h"
#include "robot_adapters/sim/guide_operations.h"
#include "robot_adapters/sim/guide_robot.h"
#include "robot_adapters/sim/signals.h"
#include "robot_adapters/sim/text_file.h"

namespace docent::robot {
namespace {

struct DriveArguments {
  GuideRobotOptions options;
  std::string hall;  // empty: the hall of scenario s01
  std::string map;
  std::string start;
  bool lists_operations = false;
};

std::string DefaultFolder(const std::string& robot) {
  const char* state = std::getenv("XDG_STATE_HOME");
  const char* home = std::getenv("HOME");
  std::string base = state != nullptr && *state != '\0'
                         ? state
                         : absl::StrCat(home != nullptr ? home : ".", "/.local/state");
  return absl::StrCat(base, "/docent/robot-", FileNameOf(robot));
}

// "x,y,heading" or the IRI of a region with a service point.
absl::StatusOr<maps::Pose2> ParseStart(const std::string& text, const maps::HallLayout& layout) {
  if (const maps::Region* region = layout.FindRegion(text); region != nullptr) {
    if (region->service_point) return *region->service_point;
    return absl::InvalidArgumentError(
        absl::StrCat("--start: region <", text, "> has no docent:servicePoint"));
  }
  const std::vector<std::string> parts = absl::StrSplit(text, ',');
  maps::Pose2 pose;
  if (parts.size() == 3 && absl::SimpleAtod(parts[0], &pose.x_m) && absl::SimpleAtod(parts[1], &pose.y_m) &&
      absl::SimpleAtod(parts[2], &pose.heading_rad) && std::isfinite(pose.x_m) && std::isfinite(pose.y_m) &&
      std::isfinite(pose.heading_rad)) {
    return pose;
  }
  return absl::InvalidArgumentError(absl::StrCat("--start \"", text,
                                                 "\" is neither x,y,heading (metres, radians) nor the "
                                                 "IRI of a region of the hall"));
}

absl::StatusOr<std::shared_ptr<const maps::HallModel>> ModelFor(const DriveArguments& arguments,
                                                                const maps::HallLayout& layout) {
  if (!arguments.map.empty() && std::filesystem::exists(arguments.map))
    return maps::HallModel::Load(arguments.map);
  auto model = maps::HallModel::FromLayout(layout);
  if (model.ok() && !arguments.map.empty()) {
    if (absl::Status saved = (*model)->Save(arguments.map); !saved.ok()) return saved;
  }
  return model;
}

void SayReport(const absl::StatusOr<PathError>& error, const std::string& folder) {
  if (!error.ok()) {
    std::cerr << "docent-robot: no report: " << error.status().message() << "\n";
    return;
  }
  std::cout << absl::StrFormat("report: RMSE %.1f mm and %.2f deg, largest %.1f mm, over %d scans; in %s",
                               error->rmse_mm, error->rmse_deg, error->max_error_mm, error->points, folder)
            << std::endl;
}

int Drive(DriveArguments arguments) {
  GuideRobotOptions& options = arguments.options;
  if (options.folder.empty()) options.folder = DefaultFolder(options.adapter.robot);
  if (options.adapter.label.empty()) options.adapter.label = FileNameOf(options.adapter.robot);
  if (arguments.hall.empty()) {
    auto hall = FindDataFile("scenarios/s01_booth_guide/hall.ttl");
    if (!hall.ok()) return Fail(hall.status());
    arguments.hall = *hall;
  }
  auto layout = maps::HallLayout::FromFile(arguments.hall);
  if (!layout.ok()) return Fail(layout.status());
  if (options.pictures.empty()) {
    const std::filesystem::path beside = std::filesystem::path(arguments.hall).parent_path() / "pictures";
    if (std::filesystem::is_directory(beside)) options.pictures = beside.string();
  }
  if (!arguments.start.empty()) {
    auto start = ParseStart(arguments.start, *layout);
    if (!start.ok()) return Fail(start.status());
    options.start = *start;
  }
  auto model = ModelFor(arguments, *layout);
  if (!model.ok()) return Fail(model.status());
  const std::string folder = options.folder;
  auto robot = GuideRobot::Start(std::move(options), *layout, *std::move(model));
  if (!robot.ok()) return Fail(robot.status());
  std::cout << "listening grpc=" << (*robot)->address() << " screen=" << (*robot)->screen_address()
            << std::endl;
  while (true) {
    const Signal signal = WaitForSignal(std::chrono::seconds(3600));
    if (signal == Signal::kReport) SayReport((*robot)->WriteReportNow(), folder);
    if (signal == Signal::kEnd) break;
  }
  (*robot)->Shutdown();  // before the report, which takes its time: it gets no command any more
  absl::StatusOr<PathError> report = (*robot)->WriteReportNow();
  robot->reset();
  SayReport(report, folder);
  return report.ok() ? kExitOk : kExitNegative;
}

// Where the robot is.
void AddPlaceOptions(CLI::App* app, const std::shared_ptr<DriveArguments>& arguments) {
  app->add_option("--hall,--layout", arguments->hall,
                  "RDF file of the hall that the robot drives in; by default that of scenario s01")
      ->type_name("FILE");
  app->add_option("--map", arguments->map,
                  "OctoMap (.bt) to localise in; made from the hall and written here if the file is absent")
      ->type_name("FILE");
  app->add_option("--start", arguments->start,
                  "Where the robot stands: x,y,heading in metres and radians, or the IRI of a region. By "
                  "default where it was left; the first time at its dock: the service point of the first "
                  "region with \"dock\" in its name, or of the first that is no booth")
      ->type_name("POSE|IRI");
}

}  // namespace

void AddDriveCommand(CLI::App* app, int* exit_code) {
  auto arguments = std::make_shared<DriveArguments>();
  AdapterOptions& adapter = arguments->options.adapter;
  adapter.robot = "https://w3id.org/docent/expo#R01";
  app->add_option("--server", adapter.server, "Address of the docent server, HOST:PORT")
      ->envname("DOCENT_SERVER")
      ->type_name("ADDRESS")
      ->capture_default_str();
  app->add_option("--robot", adapter.robot, "IRI of the robot in the graph")
      ->type_name("IRI")
      ->capture_default_str();
  app->add_option("--label", adapter.label, "Name of the robot for people; by default the end of the IRI")
      ->type_name("NAME");
  AddPlaceOptions(app, arguments);
  app->add_option("--out", arguments->options.folder,
                  "Folder for its journal, pages, sound files and reports; by default "
                  "~/.local/state/docent/robot-NAME")
      ->type_name("FOLDER");
  app->add_option("--listen", adapter.listen, "HOST:PORT to take commands at; port 0 takes a free one")
      ->type_name("ADDRESS")
      ->capture_default_str();
  app->add_option_function<int>(
         "--port",
         [arguments](int port) { arguments->options.adapter.listen = absl::StrCat("127.0.0.1:", port); },
         "Short for --listen 127.0.0.1:PORT")
      ->check(CLI::Range(0, 65535))
      ->type_name("PORT");
  app->add_option("--pictures", arguments->options.pictures,
                  "Folder of the pictures that its screen shows: the file that schema:image of a booth or "
                  "exhibitor names. By default the folder pictures beside the hall's file")
      ->check(CLI::ExistingDirectory)
      ->type_name("FOLDER");
  app->add_option("--screen-port", arguments->options.screen_port,
                  "Port of its screen (HTTP on 127.0.0.1); 0 takes a free one")
      ->check(CLI::Range(0, 65535))
      ->type_name("PORT");
  app->add_option("--speed,--speed-factor", arguments->options.speed,
                  "Simulated seconds in a second, 0.1 to 100")
      ->check(CLI::Range(0.1, 100.0))
      ->type_name("FACTOR")
      ->capture_default_str();
  app->add_option("--seed", arguments->options.seed, "Seed of all simulated noise")
      ->check(AtLeast(0))
      ->type_name("N")
      ->capture_default_str();
  app->add_flag(
      "--operations", arguments->lists_operations,
      "Print what the robot can do: its operations with inputs, outputs, and what of it each occupies");
  app->footer(
      "SIGTERM ends the robot. SIGUSR1 writes a report into the folder of --out: report.json, path.csv, "
      "path.png.\n"
      "Exit code 1: there is no report at the end.\n"
      "Example:\n"
      "  docent-robot --server 127.0.0.1:7400 --start https://w3id.org/docent/expo#B03 --speed 4");
  app->callback([app, arguments, exit_code] {
    if (!app->get_subcommands().empty()) return;
    if (arguments->lists_operations)
      std::cout << OperationsTable(GuideOperations());
    else
      *exit_code = Drive(*arguments);
  });
}

}  // namespace docent::robot
