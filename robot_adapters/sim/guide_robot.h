// docent-robot: the simulated guide robot as a process. It runs the body in (scaled) real time, offers its
// operations through the sdk, reports its context as facts, shows pages and speaks.
//
// Operations: moveToUser(user), moveToBooth(booth), displayBoothInfo(booth), briefBoothInfo(booth). Facts:
// docent:x, docent:y, docent:heading, docent:positionDeviation, docent:plannedPath, docent:isAt,
// docent:localised, docent:screenPage, docent:spokenFile;
// docent:status, docent:currentCommand and docent:progress by the sdk. The body's thread ticks it; operations
// run on the sdk's threads and share it under a lock.
#ifndef DOCENT_ROBOT_ADAPTERS_SIM_GUIDE_ROBOT_H_
#define DOCENT_ROBOT_ADAPTERS_SIM_GUIDE_ROBOT_H_

#include <memory>
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "maps/hall_layout.h"
#include "maps/hall_model.h"
#include "robot_adapters/sdk/robot_adapter.h"
#include "robot_adapters/sim/guide_body.h"

namespace docent::robot {

struct GuideRobotOptions {
  AdapterOptions adapter;  // the robot sets the journal: commands.journal in `folder`
  GuideBodySettings body;
  std::string folder;    // for journal, pages, sound files and reports; created if absent
  std::string pictures;  // folder of the files that schema:image names; empty: pages have no pictures
  int screen_port = 0;   // 0: any free port
  double speed = 1;      // 0.1..100: simulated seconds per real second, also for speaking
  uint64_t seed = 1;
  std::optional<maps::Pose2>
      start;  // nullopt: the last pose of the simulated world (world.state in `folder`), or the dock
};

class GuideRobot {
 public:
  // Errors: INVALID_ARGUMENT for settings or a start in a wall; as RobotAdapter::Start and
  // ScreenServer::Start; the system's for the folder.
  static absl::StatusOr<std::unique_ptr<GuideRobot>> Start(GuideRobotOptions options,
                                                           const maps::HallLayout& layout,
                                                           std::shared_ptr<const maps::HallModel> hall);
  ~GuideRobot();  // Shutdown, if that was not done. Writes no report.
  // The robot leaves: ends running commands and sends the last facts. Its body stays, for the report.
  void Shutdown();

  // Writes report.json, path.csv and path.png into the folder; returns the localisation errors.
  absl::StatusOr<PathError> WriteReportNow();

  const std::string& address() const;  // of the adapter
  std::string screen_address() const;
  bool localised() const;

 private:
  class Impl;
  explicit GuideRobot(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

// Where it starts by default: the first region named "…dock…", else the first one that is no booth, else the first one, of
// those with a service point. Points into `layout`. INVALID_ARGUMENT: the layout has no service point.
absl::StatusOr<const maps::Region*> DockOf(const maps::HallLayout& layout);

}  // namespace docent::robot

#endif  // DOCENT_ROBOT_ADAPTERS_SIM_GUIDE_ROBOT_H_
