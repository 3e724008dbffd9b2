#include "bench/real_log.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <utility>

#include "absl/strings/str_format.h"
#include "bench/mrpt_stock.h"
#include "maps/hall_layout.h"
#include "robot_adapters/rawlog/log_replay.h"
#include "robot_adapters/rawlog/recorded_drive.h"
#include "robot_adapters/rawlog/reference_track.h"

namespace docent::bench {
namespace {

using maps::Pose2;
using robot::RecordedDrive;
using robot::ReferencePose;

constexpr char kLog[] = "localization_demo.rawlog";
constexpr char kMap[] = "localization_demo.simplemap.gz";
constexpr int kReferenceRuns = 7;
constexpr int kReferenceParticles = 20000;
constexpr size_t kFirstCompared = 10;  // MRPT's stock filter needs some steps to find the robot
// The region in which the drive begins: [LocalizationExperiment] init_PDF of localization_demo.ini.
constexpr maps::Bounds kStart = {-10, -15, 10, -5};

struct RealData {
  RecordedDrive drive;
  std::vector<maps::PosedScan> scans;
};

absl::StatusOr<RealData> ReadData() {
  const absl::StatusOr<std::string> log = robot::FindMrptDataset(kLog), map = robot::FindMrptDataset(kMap);
  if (!log.ok()) return log.status();
  if (!map.ok()) return map.status();
  absl::StatusOr<RecordedDrive> drive = robot::ReadRawlog(*log);
  if (!drive.ok()) return drive.status();
  absl::StatusOr<std::vector<maps::PosedScan>> scans = robot::ReadSimplemap(*map);
  if (!scans.ok()) return scans.status();
  return RealData{*std::move(drive), *std::move(scans)};
}

// Poses after every step; the first one is the start's.
absl::StatusOr<std::vector<Pose2>> RunStock(StockFilter& filter, const RecordedDrive& drive,
                                            std::vector<double>* cpu_ms) {
  std::vector<Pose2> poses;
  for (const robot::RecordedStep& step : drive.steps) {
    const double before = CpuMillis();
    const absl::StatusOr<Pose2> pose = filter.Update(poses.empty() ? Pose2() : step.odometry, step.scan);
    if (!pose.ok()) return pose.status();
    if (cpu_ms != nullptr) cpu_ms->push_back(CpuMillis() - before);
    poses.push_back(*pose);
  }
  return poses;
}

Pose2 StartThatLeadsTo(const Pose2& end, const RecordedDrive& drive) {
  Pose2 moved;
  for (size_t i = 1; i < drive.steps.size(); ++i) moved = maps::Compose(moved, drive.steps[i].odometry);
  return maps::Compose(end, maps::Between(moved, Pose2()));
}

// One run: first with an unknown start, to learn where the drive ends; then again from the start that follows
// from it.
absl::StatusOr<std::vector<Pose2>> ReferenceRun(const RealData& data, uint32_t seed) {
  StockSettings settings = PfLocalization();
  settings.motion = {0.05, 0.02, 0.02, 0.08, 0.01, 0.0035};
  settings.min_particles = kReferenceParticles;
  StockFilter anywhere(data.scans, settings, seed);
  if (absl::Status status = anywhere.StartAnywhere(kStart); !status.ok()) return status;
  const absl::StatusOr<std::vector<Pose2>> first = RunStock(anywhere, data.drive, nullptr);
  if (!first.ok()) return first.status();
  if (anywhere.spread_m() > 0.5) return absl::NotFoundError("this run did not converge");
  StockFilter again(data.scans, settings, seed + 1000);
  again.StartAt(StartThatLeadsTo(first->back(), data.drive), 0.5, 0.15, 2 * kReferenceParticles);
  return RunStock(again, data.drive, nullptr);
}

// Corrects the mean by scan matching against the recorded map's own points.
absl::Status AlignAll(const RealData& data, std::vector<ReferencePose>& poses) {
  const IcpAligner aligner(data.scans);
  for (ReferencePose& pose : poses) {
    const absl::StatusOr<Pose2> aligned = aligner.Align(data.drive.steps[pose.step].scan, pose.robot_in_hall);
    if (!aligned.ok()) return aligned.status();
    pose.robot_in_hall = *aligned;
  }
  return absl::OkStatus();
}

// Mean of the runs that end at the most common place.
std::vector<ReferencePose> MeanOfAgreeing(const std::vector<std::vector<Pose2>>& runs,
                                          const RecordedDrive& drive, size_t* agreeing) {
  std::vector<const std::vector<Pose2>*> best;
  for (const auto& candidate : runs) {
    std::vector<const std::vector<Pose2>*> near;
    for (const auto& other : runs) {
      if (maps::Distance(candidate.back().position(), other.back().position()) < 0.3) near.push_back(&other);
    }
    if (near.size() > best.size()) best = near;
  }
  *agreeing = best.size();
  std::vector<ReferencePose> poses;
  for (size_t k = 0; !best.empty() && k < drive.steps.size(); ++k) {
    const double n = static_cast<double>(best.size());
    ReferencePose pose = {k, drive.steps[k].time_us, {}, 0};
    double sin_sum = 0, cos_sum = 0;
    for (const auto* run : best) {
      pose.robot_in_hall.x_m += (*run)[k].x_m / n;
      pose.robot_in_hall.y_m += (*run)[k].y_m / n;
      sin_sum += std::sin((*run)[k].heading_rad);
      cos_sum += std::cos((*run)[k].heading_rad);
    }
    pose.robot_in_hall.heading_rad = std::atan2(sin_sum, cos_sum);
    for (const auto* run : best) {
      pose.spread_m += std::pow(maps::Distance((*run)[k].position(), pose.robot_in_hall.position()), 2) / n;
    }
    pose.spread_m = std::sqrt(pose.spread_m);
    poses.push_back(pose);
  }
  return poses;
}

struct RunFigures {
  double rms_mm = 0;
  double largest_mm = 0;
  double median_ms = 0;
};

RunFigures Figures(const std::vector<Pose2>& poses, const std::vector<ReferencePose>& reference,
                   const std::vector<double>& cpu_ms) {
  RunFigures figures;
  size_t counted = 0;
  for (const ReferencePose& r : reference) {
    if (r.step < kFirstCompared) continue;
    const double mm = 1e3 * maps::Distance(poses.at(r.step).position(), r.robot_in_hall.position());
    figures.rms_mm += mm * mm;
    figures.largest_mm = std::max(figures.largest_mm, mm);
    ++counted;
  }
  figures.rms_mm = std::sqrt(figures.rms_mm / static_cast<double>(std::max<size_t>(counted, 1)));
  figures.median_ms = Median(cpu_ms);
  return figures;
}

class RealLogTable {
 public:
  void Add(const std::string& system, const std::string& metric, const std::string& unit, double value) {
    const std::string key = metric + "\n" + system;
    if (index_.emplace(key, rows_.size()).second) {
      rows_.push_back({"localisation", "s02 real robot's log", system, metric, unit, {}, ""});
    }
    rows_[index_[key]].runs.push_back(value);
  }
  void AddRun(const std::string& system, const RunFigures& figures) {
    Add(system, "off reference from step 10, RMS", "mm", figures.rms_mm);
    Add(system, "off reference from step 10, max", "mm", figures.largest_mm);
    Add(system, "update, CPU time, median step", "ms", figures.median_ms);
  }
  std::vector<Measurement> Take() {
    std::stable_sort(rows_.begin(), rows_.end(),
                     [](const Measurement& a, const Measurement& b) { return a.metric < b.metric; });
    return std::move(rows_);
  }

 private:
  std::map<std::string, size_t> index_;
  std::vector<Measurement> rows_;
};

absl::Status MeasureOurs(const RealData& data, const std::shared_ptr<const maps::HallModel>& building,
                         const std::vector<ReferencePose>& reference, const maps::HallLayout& layout,
                         uint64_t seed, RealLogTable& table) {
  const maps::RegionIndex regions(layout);
  robot::LogReplay replay(building, data.drive, &regions, {}, seed);
  std::vector<Pose2> poses;
  std::vector<double> cpu_ms;
  std::map<std::string, size_t> entered;
  while (!replay.Done()) {
    const double before = CpuMillis();
    const absl::StatusOr<robot::ReplayedStep> step = replay.Next();
    if (!step.ok()) return step.status();
    if (step->number == 0) {
      table.Add("docent", "start from nothing, CPU time", "ms", CpuMillis() - before);
    } else {
      cpu_ms.push_back(CpuMillis() - before);
    }
    if (step->region != nullptr) entered.emplace(step->region->iri, step->number);
    poses.push_back(step->estimate.pose());
  }
  table.AddRun("docent", Figures(poses, reference, cpu_ms));
  for (const maps::Region& region : layout.regions) {
    const std::optional<size_t> expected = robot::StepOfEntry(reference, region);
    if (!expected || *expected == 0 || entered.count(region.iri) == 0) continue;
    const double late = static_cast<double>(entered[region.iri]) - static_cast<double>(*expected);
    table.Add("docent", "entry into " + region.name + ", late by", "steps", late);
  }
  return absl::OkStatus();
}

absl::Status MeasureStock(const RealData& data, const std::vector<ReferencePose>& reference, uint32_t seed,
                          RealLogTable& table) {
  StockFilter filter(data.scans, PfLocalization(), seed);
  if (absl::Status status = filter.StartAnywhere(kStart); !status.ok()) return status;
  std::vector<double> cpu_ms;
  const absl::StatusOr<std::vector<Pose2>> poses = RunStock(filter, data.drive, &cpu_ms);
  if (!poses.ok()) return poses.status();
  table.Add("mrpt pf-localization", "start from nothing, CPU time", "ms", cpu_ms[0]);
  table.AddRun("mrpt pf-localization", Figures(*poses, reference, cpu_ms));
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<std::vector<Measurement>> MeasureRealLog(const std::string& scenario, int seeds) {
  const absl::StatusOr<std::vector<ReferencePose>> reference =
      robot::ReadReference(scenario + "/reference.csv");
  if (!reference.ok()) return reference.status();
  const absl::StatusOr<maps::HallLayout> layout = maps::HallLayout::FromFile(scenario + "/layout.ttl");
  if (!layout.ok()) return layout.status();
  const absl::StatusOr<RealData> data = ReadData();
  if (!data.ok()) {
    return std::vector<Measurement>{{"localisation",
                                     "s02 real robot's log",
                                     "docent",
                                     "off reference from step 10, RMS",
                                     "mm",
                                     {},
                                     std::string(data.status().message())}};
  }
  const auto building = robot::BuildingFromSimplemap(*robot::FindMrptDataset(kMap));
  if (!building.ok()) return building.status();
  RealLogTable table;
  for (int seed = 1; seed <= seeds; ++seed) {
    if (absl::Status s =
            MeasureOurs(*data, *building, *reference, *layout, static_cast<uint64_t>(seed), table);
        !s.ok()) {
      return s;
    }
    if (absl::Status s = MeasureStock(*data, *reference, static_cast<uint32_t>(seed), table); !s.ok())
      return s;
  }
  return table.Take();
}

absl::Status MakeReference(const std::string& path) {
  const absl::StatusOr<RealData> data = ReadData();
  if (!data.ok()) return data.status();
  std::vector<std::vector<Pose2>> runs;
  for (uint32_t seed = 1; seed <= kReferenceRuns; ++seed) {
    std::fprintf(stderr, "reference: run %u of %d\n", seed, kReferenceRuns);
    absl::StatusOr<std::vector<Pose2>> run = ReferenceRun(*data, seed);
    if (run.ok()) {
      runs.push_back(*std::move(run));
    } else {
      std::fprintf(stderr, "reference: run %u left out: %s\n", seed,
                   std::string(run.status().message()).c_str());
    }
  }
  size_t agreeing = 0;
  std::vector<ReferencePose> poses = MeanOfAgreeing(runs, data->drive, &agreeing);
  if (agreeing < 3)
    return absl::InternalError(absl::StrFormat("only %d runs of MRPT's filter agree", agreeing));
  if (absl::Status status = AlignAll(*data, poses); !status.ok()) return status;
  return robot::WriteReference(
      path,
      {absl::StrFormat("Poses of the recorded drive %s, in the frame of %s.", kLog, kMap),
       "Made by: docent-bench localisation --make-reference",
       "MRPT's own particle filter with the settings of pf-localization's localization_demo.ini, on its own "
       "occupancy",
       absl::StrFormat("grid drawn from the recorded map, with at least %d particles: mean of the %d of %d "
                       "runs that agree.",
                       kReferenceParticles, agreeing, kReferenceRuns),
       "Each run first starts anywhere, then again from where the drive must have begun. The mean is then "
       "corrected by",
       "MRPT's scan matching (CICP) against the recorded map's points. Our map and our sensor model have no "
       "part in it.",
       "There is no ground truth: the recorded map itself is good to a few centimetres.",
       "spread_m is the standard deviation between the runs, before the correction."},
      poses);
}

}  // namespace docent::bench
