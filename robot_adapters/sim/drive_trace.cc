#include "robot_adapters/sim/drive_trace.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "absl/strings/str_format.h"
#include "maps/hall_picture.h"
#include "robot_adapters/sim/text_file.h"

namespace docent::robot {
namespace {

constexpr double kDegreesPerRad = 180 / std::numbers::pi;

std::string CsvOf(const std::vector<TracePoint>& trace) {
  std::string csv =
      "time_s,true_x_m,true_y_m,true_heading_rad,estimated_x_m,estimated_y_m,estimated_heading_rad\n";
  for (const TracePoint& p : trace) {
    absl::StrAppendFormat(&csv, "%.2f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f\n", p.time_s, p.truth.x_m, p.truth.y_m,
                          p.truth.heading_rad, p.estimate.x_m, p.estimate.y_m, p.estimate.heading_rad);
  }
  return csv;
}

std::string JsonOf(const DriveReport& report, const PathError& error) {
  return absl::StrFormat(
      "{\"robot\": \"%s\", \"seed\": %d, \"path_m\": %.3f, \"simulated_s\": %.2f, \"points\": %d, "
      "\"rmse_mm\": %.3f, "
      "\"rmse_deg\": %.4f, \"max_error_mm\": %.3f, \"max_error_deg\": %.4f, \"bumps\": %d, "
      "\"relocalisations\": %d}\n",
      report.robot, report.seed, report.path_m, report.simulated_s, error.points, error.rmse_mm,
      error.rmse_deg, error.max_error_mm, error.max_error_deg, report.bumps, report.relocalisations);
}

absl::Status WritePicture(const DriveReport& report, const PathError& error, const maps::HallLayout& layout,
                          const std::string& path) {
  maps::HallPicture picture;
  picture.title = layout.name + ": the way of " + FileNameOf(report.robot);
  picture.subtitle =
      absl::StrFormat("%.1f m driven; error of the estimate: RMSE %.1f mm and %.2f°, largest %.1f mm",
                      report.path_m, error.rmse_mm, error.rmse_deg, error.max_error_mm);
  maps::PicturePath truth{"true path", maps::kTruthColor, {}, false};
  maps::PicturePath estimate{"estimated path", maps::kEstimateColor, {}, true};
  for (const TracePoint& p : report.trace) {
    truth.points.push_back(p.truth.position());
    estimate.points.push_back(p.estimate.position());
  }
  if (!report.trace.empty()) {
    picture.marks.push_back({maps::PictureMark::Kind::kStart, report.trace.front().truth, "start"});
    picture.marks.push_back({maps::PictureMark::Kind::kRobot, report.trace.back().truth, ""});
  }
  picture.paths = {std::move(truth), std::move(estimate)};
  return maps::WritePng(layout, picture, path);
}

}  // namespace

PathError ErrorOf(const std::vector<TracePoint>& trace) {
  PathError error;
  double square_m2 = 0, square_rad2 = 0;
  for (const TracePoint& p : trace) {
    const double off_m = maps::Distance(p.truth.position(), p.estimate.position());
    const double off_rad = std::abs(maps::WrapAngle(p.truth.heading_rad - p.estimate.heading_rad));
    square_m2 += off_m * off_m;
    square_rad2 += off_rad * off_rad;
    error.max_error_mm = std::max(error.max_error_mm, 1000 * off_m);
    error.max_error_deg = std::max(error.max_error_deg, kDegreesPerRad * off_rad);
  }
  error.points = trace.size();
  if (trace.empty()) return error;
  error.rmse_mm = 1000 * std::sqrt(square_m2 / static_cast<double>(trace.size()));
  error.rmse_deg = kDegreesPerRad * std::sqrt(square_rad2 / static_cast<double>(trace.size()));
  return error;
}

absl::Status WriteReport(const DriveReport& report, const maps::HallLayout& layout,
                         const std::string& folder) {
  const PathError error = ErrorOf(report.trace);
  if (absl::Status status = WriteTextFile(folder + "/path.csv", CsvOf(report.trace)); !status.ok())
    return status;
  if (absl::Status status = WriteTextFile(folder + "/report.json", JsonOf(report, error)); !status.ok())
    return status;
  return WritePicture(report, error, layout, folder + "/path.png");
}

}  // namespace docent::robot
