// docent-robot replay: plays the recording of a real robot through the localiser into the live graph.
#include <spdlog/spdlog.h>

#include <filesystem>
#include <iostream>
#include <memory>

#include "CLI/CLI.hpp"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "graph/command_line/usage_error.h"
#include "graph/rdf/vocabulary.h"
#include "maps/hall_picture.h"
#include "robot_adapters/rawlog/log_replay.h"
#include "robot_adapters/rawlog/recorded_drive.h"
#include "robot_adapters/sdk/decimal.h"
#include "robot_adapters/sdk/robot_adapter.h"
#include "robot_adapters/sim/commands.h"
#include "robot_adapters/sim/signals.h"
#include "robot_adapters/sim/text_file.h"

namespace docent::robot {
namespace {

struct ReplayArguments {
  AdapterOptions adapter;
  std::string rawlog = "localization_demo.rawlog";
  std::string building = "localization_demo.simplemap.gz";
  std::string layout;
  std::string folder;
  double speed = 1;
  uint64_t seed = 1;
  int wait_s = 30;
};

// A path as given, or the name of an MRPT data set.
absl::StatusOr<std::string> Find(const std::string& name) {
  return std::filesystem::exists(name) ? absl::StatusOr<std::string>(name) : FindMrptDataset(name);
}

struct Replayed {
  std::vector<ReplayedStep> steps;
  std::vector<std::string> entered;  // lines of the report
};

void Tell(RobotAdapter& adapter, const std::string& robot, const ReplayedStep& step) {
  std::vector<std::pair<std::string, std::optional<Term>>> facts = {
      {DocentIri("localised"), Term::Boolean(step.estimate.localised)}};
  if (step.estimate.localised) {
    facts.emplace_back(DocentIri("x"), Decimal(step.estimate.x_m, 3));
    facts.emplace_back(DocentIri("y"), Decimal(step.estimate.y_m, 3));
    facts.emplace_back(DocentIri("heading"), Decimal(step.estimate.heading_rad, 3));
    facts.emplace_back(DocentIri("isAt"),
                       step.region != nullptr ? std::optional(Term::Iri(step.region->iri)) : std::nullopt);
  }
  adapter.facts().SetAll(robot, std::move(facts));
}

// Plays the steps at the recorded pace. False if a signal ended it.
absl::StatusOr<bool> Play(LogReplay& replay, RobotAdapter& adapter, const ReplayArguments& arguments,
                          Replayed* played) {
  const auto begun = std::chrono::steady_clock::now();
  const TimeMicros first_us = replay.NextTime();
  std::string region;
  while (!replay.Done()) {
    const auto due = begun + std::chrono::microseconds(static_cast<int64_t>(
                                 static_cast<double>(replay.NextTime() - first_us) / arguments.speed));
    const auto wait =
        std::chrono::duration_cast<std::chrono::milliseconds>(due - std::chrono::steady_clock::now());
    if (WaitForSignal(std::max(wait, std::chrono::milliseconds(0))) == Signal::kEnd) return false;
    auto step = replay.Next();
    if (!step.ok()) return step.status();
    Tell(adapter, arguments.adapter.robot, *step);
    const std::string now = step->region != nullptr ? step->region->iri : "";
    if (now != region) {
      region = now;
      const std::string line =
          absl::StrFormat("step %d  %.1f s  x %.2f  y %.2f  %s", step->number,
                          static_cast<double>(step->time_us - first_us) / 1e6, step->estimate.x_m,
                          step->estimate.y_m, region.empty() ? "(no region)" : ToDisplay(Term::Iri(region)));
      std::cout << line << std::endl;
      played->entered.push_back(line);
    }
    played->steps.push_back(*step);
    // Each step is sent alone, so that it is a turn of its own, even if the server is slow.
    if (!adapter.facts().Flush(absl::Seconds(arguments.wait_s))) {
      return absl::DeadlineExceededError(absl::StrCat("the server at ", arguments.adapter.server,
                                                      " did not take the facts within ", arguments.wait_s,
                                                      " s"));
    }
  }
  return true;
}

absl::Status WriteFiles(const ReplayArguments& arguments, const Replayed& played,
                        const maps::HallLayout& layout, const maps::HallModel& building) {
  std::error_code error;
  std::filesystem::create_directories(arguments.folder, error);
  std::string csv = "step,time_us,x_m,y_m,heading_rad,localised,region\n";
  maps::PicturePath path{"localised path", maps::kEstimateColor, {}, false};
  for (const ReplayedStep& step : played.steps) {
    absl::StrAppendFormat(&csv, "%d,%d,%.4f,%.4f,%.4f,%d,%s\n", step.number, step.time_us, step.estimate.x_m,
                          step.estimate.y_m, step.estimate.heading_rad, step.estimate.localised ? 1 : 0,
                          step.region != nullptr ? step.region->iri : "");
    if (step.estimate.localised) path.points.push_back({step.estimate.x_m, step.estimate.y_m});
  }
  if (absl::Status status = WriteTextFile(arguments.folder + "/replay.csv", csv); !status.ok()) return status;
  maps::HallPicture picture;
  picture.title = absl::StrCat(layout.name, ": ", arguments.rawlog);
  picture.paths = {std::move(path)};
  picture.background = &building.laser_field();
  return maps::WritePng(layout, picture, arguments.folder + "/replay.png");
}

int Replay(const ReplayArguments& arguments) {
  auto layout = maps::HallLayout::FromFile(arguments.layout);
  if (!layout.ok()) return Fail(layout.status());
  auto rawlog = Find(arguments.rawlog);
  if (!rawlog.ok()) return Fail(rawlog.status());
  auto simplemap = Find(arguments.building);
  if (!simplemap.ok()) return Fail(simplemap.status());
  auto drive = ReadRawlog(*rawlog);
  if (!drive.ok()) return Fail(drive.status());
  auto building = BuildingFromSimplemap(*simplemap);
  if (!building.ok()) return Fail(building.status());

  AdapterOptions options = arguments.adapter;
  options.transient_states = {DocentIri("isAt")};
  auto adapter = RobotAdapter::Start(options, {});
  if (!adapter.ok()) return Fail(adapter.status());
  std::cout << "listening grpc=" << (*adapter)->address() << std::endl;
  if (!(*adapter)->facts().Flush(absl::Seconds(arguments.wait_s))) {
    return Fail(absl::UnavailableError(absl::StrCat("no server answers at ", options.server)));
  }
  const maps::RegionIndex regions(*layout);
  LogReplay replay(*building, *std::move(drive), &regions, LocaliserSettings{}, arguments.seed);
  Replayed played;
  auto ended = Play(replay, **adapter, arguments, &played);
  if (!ended.ok()) return Fail(ended.status());
  if (!arguments.folder.empty()) {
    if (absl::Status status = WriteFiles(arguments, played, *layout, **building); !status.ok())
      return Fail(status);
  }
  std::cout << "replayed " << played.steps.size() << " steps" << (*ended ? "" : ", then was told to stop")
            << std::endl;
  return kExitOk;
}

}  // namespace

void AddReplayCommand(CLI::App* app, int* exit_code) {
  auto arguments = std::make_shared<ReplayArguments>();
  arguments->adapter.robot = "https://w3id.org/docent/s02#RealRobot";
  CLI::App* command = app->add_subcommand(
      "replay", "Replay the recorded log of a real robot through the localiser into the graph");
  command->add_option("--server", arguments->adapter.server, "Address of the docent server, HOST:PORT")
      ->envname("DOCENT_SERVER")
      ->type_name("ADDRESS")
      ->capture_default_str();
  command->add_option("--robot", arguments->adapter.robot, "IRI of the robot in the graph")
      ->type_name("IRI")
      ->capture_default_str();
  command
      ->add_option("--rawlog", arguments->rawlog,
                   "MRPT rawlog: a file, or the name of one of MRPT's data sets")
      ->type_name("FILE|NAME")
      ->capture_default_str();
  command
      ->add_option("--map", arguments->building,
                   "MRPT simple map of the building: a file, or the name of one of MRPT's data sets")
      ->type_name("FILE|NAME")
      ->capture_default_str();
  command->add_option("--hall,--layout", arguments->layout, "RDF file with the building's regions")
      ->type_name("FILE")
      ->required();
  command
      ->add_option("--out", arguments->folder,
                   "Folder for replay.csv and replay.png; by default none is written")
      ->type_name("FOLDER");
  command->add_option("--speed,--speed-factor", arguments->speed, "Recorded seconds in a second, 0.1 to 1000")
      ->check(CLI::Range(0.1, 1000.0))
      ->type_name("FACTOR")
      ->capture_default_str();
  command->add_option("--seed", arguments->seed, "Seed of the particle filter")
      ->check(AtLeast(0))
      ->type_name("N")
      ->capture_default_str();
  command->add_option("--wait", arguments->wait_s, "Time to wait for the server")
      ->check(CLI::Range(1, 3600))
      ->type_name("SECONDS")
      ->capture_default_str();
  command->footer(
      "Example:\n"
      "  docent-robot replay --layout scenarios/s02_real_robot_log/layout.ttl --speed 20");
  command->callback([arguments, exit_code] { *exit_code = Replay(*arguments); });
}

}  // namespace docent::robot
