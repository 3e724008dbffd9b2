#include "robot_adapters/sim/guide_robot.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <filesystem>
#include <utility>

#include <spdlog/spdlog.h>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "absl/synchronization/notification.h"
#include "graph/base/text.h"
#include "graph/rdf/vocabulary.h"
#include "maps/regions.h"
#include "robot_adapters/sdk/decimal.h"
#include "robot_adapters/sim/booth_page.h"
#include "robot_adapters/sim/booth_picture.h"
#include "robot_adapters/sim/graph_questions.h"
#include "robot_adapters/sim/guide_operations.h"
#include "robot_adapters/sim/living_body.h"
#include "robot_adapters/sim/screen_server.h"
#include "robot_adapters/sim/text_file.h"
#include "robot_adapters/sim/voice.h"
#include "robot_adapters/sim/world_state.h"

namespace docent::robot {

using maps::Point2;
using maps::Pose2;

namespace {

constexpr double kSocialDistanceM = 1.0;  // distance from a visitor at which the robot stops
constexpr double kSearchRadiusM = 3.0;    // search for a free place around an occupied one
constexpr double kRegionMarginM = 0.15;   // margin for leaving a region, see RegionIndex
// A pose is reported again after a move of this length; the filter's noise of a standing robot is smaller.
constexpr double kToldMoveM = 0.02;
constexpr double kToldTurnRad = 0.02;
constexpr double kToldDeviationM = 0.05;                  // the deviation is reported in steps of this length
constexpr std::chrono::milliseconds kScreenChange{1500};  // simulated time until a page can be read

// "LINESTRING(1.00 2.00, 3.00 4.00)" in the hall frame.
Term LineOf(const std::vector<Point2>& path) {
  return Term::Literal(absl::StrCat("LINESTRING(",
                                    absl::StrJoin(path, ", ",
                                                  [](std::string* out, const Point2& p) {
                                                    absl::StrAppendFormat(out, "%.2f %.2f", p.x_m, p.y_m);
                                                  }),
                                    ")"),
                       Concat(kGeoNs, "wktLiteral"));
}

absl::Status CheckOptions(const GuideRobotOptions& options) {
  if (!(options.speed >= 0.1 && options.speed <= 100)) {
    return absl::InvalidArgumentError(absl::StrFormat("speed = %g is not within 0.1..100", options.speed));
  }
  std::error_code error;
  std::filesystem::create_directories(options.folder, error);
  if (error) {
    return absl::InvalidArgumentError(
        absl::StrCat("cannot make the folder ", options.folder, ": ", error.message()));
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<const maps::Region*> DockOf(const maps::HallLayout& layout) {
  const maps::Region* found = nullptr;
  int best = 0;
  for (const maps::Region& region : layout.regions) {
    if (!region.service_point) continue;
    const std::string name = absl::AsciiStrToLower(region.name);
    const int rank = absl::StrContains(name, "dock") ? 3 : region.is_booth ? 1 : 2;
    if (rank > best) {
      best = rank;
      found = &region;
    }
  }
  if (found == nullptr) {
    return absl::InvalidArgumentError(
        "the hall has no service point where a robot could start; give --start");
  }
  return found;
}

class GuideRobot::Impl {
 public:
  Impl(GuideRobotOptions options, const maps::HallLayout& layout)
      : options_(std::move(options)), layout_(layout), regions_(layout_) {}

  // Operations use all other members, so they end first; then the body, which reports its pose.
  ~Impl() {
    Shutdown();
    body_.reset();
  }

  void Shutdown() {
    if (adapter_ != nullptr) adapter_->Shutdown();
  }

  absl::Status Start(std::shared_ptr<const maps::HallModel> hall) {
    if (absl::Status status = CheckOptions(options_); !status.ok()) return status;
    const std::string world_path = options_.folder + "/world.state";
    auto start = StartPose(world_path);
    if (!start.ok()) return start.status();
    auto body = GuideBody::Create(std::move(hall), layout_, options_.body, *start, options_.seed);
    if (!body.ok()) return body.status();
    auto screen = ScreenServer::Start(options_.screen_port);
    if (!screen.ok()) return screen.status();
    screen_ = *std::move(screen);
    screen_->Show("standby", StandbyPage(layout_, Name()));

    AdapterOptions adapter = options_.adapter;
    adapter.journal_path = options_.folder + "/commands.journal";
    adapter.transient_states = {DocentIri("isAt"), DocentIri("screenPage"), DocentIri("plannedPath")};
    auto started = RobotAdapter::Start(adapter, Operations());
    if (!started.ok()) return started.status();
    {
      absl::MutexLock lock(&mutex_);
      adapter_ = *std::move(started);
    }
    body_ = std::make_unique<LivingBody>(*std::move(body), options_.speed, world_path,
                                         [this](const LivingBody::Pose& pose) { TellPose(pose); });
    ready_.Notify();
    return absl::OkStatus();
  }

  absl::StatusOr<PathError> WriteReportNow() {
    DriveReport report = body_->Report();
    report.robot = options_.adapter.robot;
    if (absl::Status status = WriteReport(report, layout_, options_.folder); !status.ok()) return status;
    return ErrorOf(report.trace);
  }

  std::string screen_address() const { return screen_->address(); }
  const std::string& address() const { return adapter_->address(); }
  bool localised() const { return body_->pose().localised; }

 private:
  std::string Name() const {
    return options_.adapter.label.empty() ? FileNameOf(options_.adapter.robot) : options_.adapter.label;
  }

  // Logs the place and why.
  absl::StatusOr<Pose2> StartPose(const std::string& world_path) const {
    const auto said = [](const Pose2& pose, const std::string& why) {
      spdlog::info("starts at {:.2f}, {:.2f} m, {:.2f} rad: {}", pose.x_m, pose.y_m, pose.heading_rad, why);
      return pose;
    };
    if (options_.start) return said(*options_.start, "as it was told");
    if (const std::optional<Pose2> left = LoadWorld(world_path))
      return said(*left, absl::StrCat("there it was left, says ", world_path));
    const auto dock = DockOf(layout_);
    if (!dock.ok()) return dock.status();
    return said(*(*dock)->service_point,
                absl::StrCat("the service point of ", ToDisplay(Term::Iri((*dock)->iri)), ", its dock"));
  }

  std::vector<Operation> Operations() {
    using Method = absl::StatusOr<NamedTerms> (Impl::*)(OperationContext&);
    const std::pair<std::string_view, Method> methods[] = {{"moveToUser", &Impl::MoveToUser},
                                                           {"moveToBooth", &Impl::MoveToBooth},
                                                           {"displayBoothInfo", &Impl::DisplayBoothInfo},
                                                           {"briefBoothInfo", &Impl::BriefBoothInfo},
                                                           {"driveTo", &Impl::DriveTo},
                                                           {"showText", &Impl::ShowText},
                                                           {"say", &Impl::Say}};
    std::vector<Operation> operations = GuideOperations();
    for (Operation& operation : operations) {
      for (const auto& [name, method] : methods) {
        if (operation.name != name) continue;
        operation.run = [this, method = method](OperationContext& context) {
          ready_.WaitForNotification();  // a command may arrive before the body exists
          return (this->*method)(context);
        };
      }
    }
    return operations;
  }

  absl::StatusOr<NamedTerms> MoveToUser(OperationContext& context) {
    auto user = IriArgument(context, "user");
    if (!user.ok()) return user.status();
    auto whereabouts = AskWhereIs(adapter_->server(), context, *user);
    if (!whereabouts.ok()) return whereabouts.status();
    auto goal = GoalNear(*whereabouts);
    if (!goal.ok()) return goal.status();
    return Drive(*goal, context);
  }

  absl::StatusOr<NamedTerms> MoveToBooth(OperationContext& context) {
    return DriveToRegion(context, "booth");
  }
  absl::StatusOr<NamedTerms> DriveTo(OperationContext& context) { return DriveToRegion(context, "place"); }

  absl::StatusOr<NamedTerms> DriveToRegion(OperationContext& context, std::string_view argument) {
    auto region = IriArgument(context, argument);
    if (!region.ok()) return region.status();
    auto goal = GoalIn(*region);
    if (!goal.ok()) return goal.status();
    return Drive(*goal, context);
  }

  absl::StatusOr<NamedTerms> Drive(const Pose2& goal, OperationContext& context) {
    absl::Status driven = body_->Drive(goal, context);
    TellPose(body_->pose());  // the final pose is sent before the end of the command
    if (!driven.ok()) return driven;
    return NamedTerms{};
  }

  // A goal beside a person whose coordinates are known; otherwise the service point of the person's region.
  absl::StatusOr<Pose2> GoalNear(const Whereabouts& whereabouts) {
    if (!whereabouts.point) {
      absl::StatusOr<Pose2> goal = absl::NotFoundError("");
      for (const std::string& region : whereabouts.regions) {
        goal = GoalIn(region);
        if (goal.ok()) break;
      }
      return goal;
    }
    const Point2 person = *whereabouts.point, here = body_->pose().estimate.position();
    const double distance_m = std::max(1e-6, maps::Distance(person, here));
    const double share = std::min(1.0, kSocialDistanceM / distance_m);
    auto place = body_->NearestFree(
        {person.x_m + share * (here.x_m - person.x_m), person.y_m + share * (here.y_m - person.y_m)},
        kSearchRadiusM);
    if (!place.ok()) return place.status();
    return Pose2{place->x_m, place->y_m, std::atan2(person.y_m - place->y_m, person.x_m - place->x_m)};
  }

  absl::StatusOr<Pose2> GoalIn(const std::string& region_iri) {
    const maps::Region* region = layout_.FindRegion(region_iri);
    if (region == nullptr)
      return absl::NotFoundError(absl::StrCat("the robot's hall has no region <", region_iri, ">"));
    if (region->service_point) return *region->service_point;
    const Point2 middle = maps::Centroid(region->outline);
    auto place = body_->NearestFree(middle, kSearchRadiusM);
    if (!place.ok()) return place.status();
    return Pose2{place->x_m, place->y_m, 0};
  }

  absl::StatusOr<NamedTerms> DisplayBoothInfo(OperationContext& context) {
    auto booth = BoothOf(context);
    if (!booth.ok()) return booth.status();
    const std::string name = FileNameOf(booth->iri);
    const std::string html = BoothPage(*booth, PictureOf(*booth), layout_, body_->pose().estimate, Name());
    return Show(context, name, html);
  }

  absl::StatusOr<NamedTerms> ShowText(OperationContext& context) {
    auto text = TextArgument(context);
    if (!text.ok()) return text.status();
    return Show(context, "text", TextPage(text->lexical, text->language, layout_, Name()));
  }

  absl::StatusOr<NamedTerms> Show(OperationContext& context, const std::string& name,
                                  const std::string& html) {
    const std::string file = absl::StrCat(options_.folder, "/screen_", name, ".html");
    if (absl::Status status = WriteTextFile(file, html); !status.ok()) return status;
    const Term page = Term::Iri(screen_->Show(name, html));
    adapter_->SetState(DocentIri("screenPage"), page);
    context.ReportProgress(0.5, "the page is on the screen");
    if (!context.SleepFor(Scaled(kScreenChange)))
      return absl::CancelledError("stopped while showing the page");
    return NamedTerms{{"page", page}};
  }

  absl::StatusOr<NamedTerms> BriefBoothInfo(OperationContext& context) {
    auto booth = BoothOf(context);
    if (!booth.ok()) return booth.status();
    return Speak(context, SpokenText(*booth), "", absl::StrCat("briefing_", FileNameOf(booth->iri)));
  }

  absl::StatusOr<NamedTerms> Say(OperationContext& context) {
    auto text = TextArgument(context);
    if (!text.ok()) return text.status();
    return Speak(context, text->lexical, text->language, absl::StrCat("said_", ++texts_said_));
  }

  absl::StatusOr<NamedTerms> Speak(OperationContext& context, const std::string& text,
                                   const std::string& language, const std::string& name) {
    const std::string file =
        std::filesystem::absolute(absl::StrCat(options_.folder, "/", name, ".wav")).string();
    context.ReportProgress(0, "preparing to speak");
    auto length = SpeakToFile(
        text, file, [&context] { return !context.StopRequested(); }, language);
    if (!length.ok()) return length.status();
    adapter_->SetState(DocentIri("spokenFile"), Term::Literal(file));
    constexpr int kParts = 20;
    for (int i = 0; i < kParts; ++i) {
      context.ReportProgress(static_cast<double>(i) / kParts, "speaking");
      screen_->Say(text, language, static_cast<double>(i) / kParts);
      if (!context.SleepFor(Scaled(*length) / kParts)) {
        screen_->Say("", "", 0);
        return absl::CancelledError("stopped while speaking");
      }
    }
    screen_->Say("", "", 0);
    return NamedTerms{{"file", Term::Literal(file)}};
  }

  // Empty: there is none, or it cannot be shown, which the log says.
  std::string PictureOf(const BoothInfo& booth) const {
    if (booth.image.empty() || options_.pictures.empty()) return "";
    absl::StatusOr<std::string> picture = PictureUri(options_.pictures, booth.image);
    if (picture.ok()) return *std::move(picture);
    spdlog::warn("booth {} is shown without its picture: {}", booth.name,
                 std::string(picture.status().message()));
    return "";
  }

  // The graph's data of the booth, completed by the robot's own layout.
  absl::StatusOr<BoothInfo> BoothOf(OperationContext& context) {
    auto iri = IriArgument(context, "booth");
    if (!iri.ok()) return iri.status();
    auto info = AskAboutBooth(adapter_->server(), context, *iri);
    if (!info.ok()) return info.status();
    if (const maps::Region* region = layout_.FindRegion(*iri); region != nullptr) {
      if (info->name.empty()) info->name = region->name;
      if (info->description.empty()) info->description = region->description;
      if (info->exhibitor.empty()) info->exhibitor = region->exhibitor;
    }
    if (info->name.empty() && info->description.empty()) {
      return absl::NotFoundError(
          absl::StrCat("neither the graph nor the robot's hall knows the booth <", *iri, ">"));
    }
    return info;
  }

  std::chrono::microseconds Scaled(std::chrono::milliseconds simulated) const {
    return std::chrono::duration_cast<std::chrono::microseconds>(simulated / options_.speed);
  }

  void TellPose(const LivingBody::Pose& pose) {
    absl::MutexLock lock(&mutex_);
    if (adapter_ == nullptr) return;
    std::vector<std::pair<std::string, std::optional<Term>>> facts = {
        {DocentIri("localised"), Term::Boolean(pose.localised)}};
    if (pose.localised) {
      region_ = regions_.Innermost(pose.estimate.position(), region_, kRegionMarginM);
      facts.emplace_back(DocentIri("isAt"),
                         region_ != nullptr ? std::optional(Term::Iri(region_->iri)) : std::nullopt);
      const bool moved =
          !told_ || maps::Distance(told_->position(), pose.estimate.position()) > kToldMoveM ||
          std::abs(maps::WrapAngle(told_->heading_rad - pose.estimate.heading_rad)) > kToldTurnRad;
      if (moved) {
        told_ = pose.estimate;
        facts.emplace_back(DocentIri("x"), Decimal(pose.estimate.x_m, 3));
        facts.emplace_back(DocentIri("y"), Decimal(pose.estimate.y_m, 3));
        facts.emplace_back(DocentIri("heading"), Decimal(pose.estimate.heading_rad, 3));
      }
      const int steps = static_cast<int>(std::ceil(pose.deviation_m / kToldDeviationM));
      if (steps != told_deviation_) {
        told_deviation_ = steps;
        facts.emplace_back(DocentIri("positionDeviation"), Decimal(steps * kToldDeviationM, 2));
      }
    }
    if (told_path_ != pose.path) {
      told_path_ = pose.path;
      facts.emplace_back(DocentIri("plannedPath"),
                         pose.path.size() > 1 ? std::optional(LineOf(pose.path)) : std::nullopt);
    }
    adapter_->facts().SetAll(options_.adapter.robot, std::move(facts));
  }

  const GuideRobotOptions options_;
  const maps::HallLayout layout_;
  const maps::RegionIndex regions_;
  std::unique_ptr<ScreenServer> screen_;
  std::unique_ptr<LivingBody> body_;
  absl::Notification ready_;
  absl::Mutex mutex_;
  std::atomic<int> texts_said_ = 0;
  const maps::Region* region_ ABSL_GUARDED_BY(mutex_) = nullptr;  // last reported as docent:isAt
  std::optional<Pose2> told_ ABSL_GUARDED_BY(mutex_);
  int told_deviation_ ABSL_GUARDED_BY(mutex_) = -1;  // in steps of kToldDeviationM
  std::vector<Point2> told_path_ ABSL_GUARDED_BY(mutex_);
  std::unique_ptr<RobotAdapter> adapter_;
};

GuideRobot::GuideRobot(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
GuideRobot::~GuideRobot() = default;

absl::StatusOr<std::unique_ptr<GuideRobot>> GuideRobot::Start(GuideRobotOptions options,
                                                              const maps::HallLayout& layout,
                                                              std::shared_ptr<const maps::HallModel> hall) {
  auto impl = std::make_unique<Impl>(std::move(options), layout);
  if (absl::Status status = impl->Start(std::move(hall)); !status.ok()) return status;
  return std::unique_ptr<GuideRobot>(new GuideRobot(std::move(impl)));
}

void GuideRobot::Shutdown() {
  impl_->Shutdown();
}
absl::StatusOr<PathError> GuideRobot::WriteReportNow() {
  return impl_->WriteReportNow();
}
const std::string& GuideRobot::address() const {
  return impl_->address();
}
std::string GuideRobot::screen_address() const {
  return impl_->screen_address();
}
bool GuideRobot::localised() const {
  return impl_->localised();
}

}  // namespace docent::robot
