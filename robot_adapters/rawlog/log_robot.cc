#include "robot_adapters/rawlog/log_robot.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <optional>

#include "absl/strings/str_format.h"
#include "kb_server/rdf/vocabulary.h"
#include "maps/hall_picture.h"
#include "robot_adapters/sdk/decimal.h"

namespace docent::robot {
namespace {

absl::StatusOr<std::string> PathOr(const std::string& path, const char* dataset) {
  return path.empty() ? FindMrptDataset(dataset) : absl::StatusOr<std::string>(path);
}

std::string JsonString(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    if (static_cast<unsigned char>(c) >= 0x20) out += c;
  }
  return out + "\"";
}

}  // namespace

LogRobot::LogRobot(std::string robot, maps::HallLayout layout, std::shared_ptr<const maps::HallModel> building,
                   double speed)
    : robot_(std::move(robot)),
      layout_(std::move(layout)),
      regions_(layout_),
      building_(std::move(building)),
      speed_(speed) {}

absl::StatusOr<std::unique_ptr<LogRobot>> LogRobot::Start(LogRobotOptions options) {
  if (!(options.speed > 0) || !std::isfinite(options.speed)) {
    return absl::InvalidArgumentError(absl::StrFormat("log robot: speed %g is not above 0", options.speed));
  }
  if (absl::Status status = Validate(options.localiser); !status.ok()) return status;
  const absl::StatusOr<std::string> log = PathOr(options.log_path, "localization_demo.rawlog");
  if (!log.ok()) return log.status();
  const absl::StatusOr<std::string> map = PathOr(options.map_path, "localization_demo.simplemap.gz");
  if (!map.ok()) return map.status();
  absl::StatusOr<maps::HallLayout> layout = maps::HallLayout::FromFile(options.layout_path);
  if (!layout.ok()) return layout.status();
  absl::StatusOr<RecordedDrive> drive = ReadRawlog(*log);
  if (!drive.ok()) return drive.status();
  absl::StatusOr<std::shared_ptr<const maps::HallModel>> building = BuildingFromSimplemap(*map);
  if (!building.ok()) return building.status();

  std::unique_ptr<LogRobot> robot(new LogRobot(options.adapter.robot, *std::move(layout), *building, options.speed));
  robot->replay_ = std::make_unique<LogReplay>(*building, *std::move(drive), &robot->regions_, options.localiser,
                                               options.seed);
  absl::StatusOr<std::unique_ptr<RobotAdapter>> adapter =
      RobotAdapter::Start(std::move(options.adapter), {robot->NoteArrival()});
  if (!adapter.ok()) return adapter.status();
  robot->adapter_ = *std::move(adapter);
  return robot;
}

Operation LogRobot::NoteArrival() {
  Operation operation;
  operation.name = "noteArrival";
  operation.inputs = {"region"};
  operation.outputs = {"step"};
  operation.idempotent = true;
  operation.description = "Says at which step of the recording the robot first was in the region";
  operation.run = [this](OperationContext& context) -> absl::StatusOr<NamedTerms> {
    const absl::StatusOr<Term> region = context.Argument("region");
    if (!region.ok()) return region.status();
    for (const auto& [entered, step] : Entries()) {
      if (entered->iri != region->lexical) continue;
      context.ReportProgress(1, absl::StrFormat("was in %s from step %d on", entered->name, step));
      return NamedTerms{{"step", Term::Integer(static_cast<int64_t>(step))}};
    }
    return absl::NotFoundError("the recorded robot has not been in " + region->lexical + " so far");
  };
  return operation;
}

absl::Status LogRobot::Replay(const Sleep& sleep) {
  TimeMicros before = replay_->Done() ? 0 : replay_->NextTime();
  while (!replay_->Done()) {
    const TimeMicros pause = std::max<TimeMicros>(0, replay_->NextTime() - before);
    before = replay_->NextTime();
    if (!sleep(std::chrono::microseconds(std::llround(static_cast<double>(pause) / speed_)))) {
      return absl::CancelledError("the replay was stopped");
    }
    const absl::StatusOr<ReplayedStep> step = replay_->Next();
    if (!step.ok()) return step.status();
    {
      absl::MutexLock lock(&mutex_);
      steps_.push_back(*step);
    }
    Tell(*step);
  }
  return absl::OkStatus();
}

// One batch, so that no reader sees the pose of one step with the region of another.
void LogRobot::Tell(const ReplayedStep& step) {
  std::optional<Term> region;
  if (step.region != nullptr) region = Term::Iri(step.region->iri);
  adapter_->facts().SetAll(robot_, {{DocentIri("x"), Decimal(step.estimate.x_m, 3)},
                                    {DocentIri("y"), Decimal(step.estimate.y_m, 3)},
                                    {DocentIri("heading"), Decimal(step.estimate.heading_rad, 3)},
                                    {DocentIri("localised"), Term::Boolean(step.estimate.localised)},
                                    {DocentIri("isAt"), region}});
}

std::vector<ReplayedStep> LogRobot::Steps() const {
  absl::MutexLock lock(&mutex_);
  return steps_;
}

std::vector<std::pair<const maps::Region*, size_t>> LogRobot::Entries() const {
  std::vector<std::pair<const maps::Region*, size_t>> entries;
  for (const ReplayedStep& step : Steps()) {
    const bool known = step.region == nullptr || std::any_of(entries.begin(), entries.end(), [&](const auto& entry) {
                         return entry.first == step.region;
                       });
    if (!known) entries.push_back({step.region, step.number});
  }
  return entries;
}

absl::Status LogRobot::WriteReport(const std::string& folder) const {
  const std::vector<ReplayedStep> steps = Steps();
  maps::PicturePath path = {"where the recorded robot was (estimate)", maps::kEstimateColor, {}, false};
  double path_m = 0;
  for (const ReplayedStep& step : steps) {
    const maps::Point2 here = step.estimate.pose().position();
    if (!path.points.empty()) path_m += maps::Distance(path.points.back(), here);
    path.points.push_back(here);
  }
  std::string json = absl::StrFormat("{\"steps\": %d, \"path_m\": %.3f, \"relocalisations\": %d, \"entered\": [",
                                     steps.size(), path_m, steps.empty() ? 0 : steps.back().estimate.relocalisations);
  std::string separator;
  maps::HallPicture picture;
  for (const auto& [region, step] : Entries()) {
    json += absl::StrFormat("%s{\"region\": %s, \"step\": %d, \"time_us\": %d}", separator, JsonString(region->iri), step,
                            steps[step].time_us);
    separator = ", ";
    picture.highlighted.push_back(region->iri);
    picture.marks.push_back({maps::PictureMark::Kind::kGoal, steps[step].estimate.pose(),
                             absl::StrFormat("%s, step %d", region->name, step)});
  }
  json += "]}\n";
  std::ofstream out(folder + "/report.json");
  out << json;
  out.flush();
  if (!out) return absl::UnavailableError("cannot write " + folder + "/report.json");

  picture.title = "A real robot's recorded drive";
  picture.subtitle = absl::StrFormat("%d steps, %.1f m; map and log: MRPT localization_demo", steps.size(), path_m);
  picture.paths = {std::move(path)};
  picture.background = &building_->laser_field();
  if (!steps.empty()) picture.marks.push_back({maps::PictureMark::Kind::kRobot, steps.back().estimate.pose(), ""});
  return maps::WritePng(layout_, picture, folder + "/path.png");
}

}  // namespace docent::robot
