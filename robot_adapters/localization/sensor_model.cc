#include "robot_adapters/localization/sensor_model.h"

#include <algorithm>
#include <cmath>

namespace docent::robot {

BeamEnds EndsOf(const maps::LaserScan& scan, int max_beams) {
  BeamEnds ends;
  ends.sensor = scan.sensor_in_robot.position();
  const size_t n = scan.range_m.size();
  const size_t kept = std::min(n, static_cast<size_t>(max_beams));
  ends.x_m.reserve(kept);
  ends.y_m.reserve(kept);
  for (size_t k = 0; k < kept; ++k) {
    const size_t i = k * n / kept;
    const double range = scan.range_m[i];
    if (!(range > 0) || range >= scan.max_range_m) continue;
    const double bearing = scan.sensor_in_robot.heading_rad + scan.first_bearing_rad +
                           static_cast<double>(i) * scan.bearing_step_rad;
    ends.x_m.push_back(static_cast<float>(scan.sensor_in_robot.x_m + range * std::cos(bearing)));
    ends.y_m.push_back(static_cast<float>(scan.sensor_in_robot.y_m + range * std::sin(bearing)));
  }
  return ends;
}

SensorModel::SensorModel(const maps::DistanceGrid& laser_field, const SensorModelSettings& settings) {
  const double cell_m = std::min(settings.cell_m, laser_field.resolution_m);
  origin_x_m_ = laser_field.origin_x_m;
  origin_y_m_ = laser_field.origin_y_m;
  cells_per_m_ = 1 / cell_m;
  width_ = std::max(1, static_cast<int>(laser_field.width * laser_field.resolution_m / cell_m));
  height_ = std::max(1, static_cast<int>(laser_field.height * laser_field.resolution_m / cell_m));
  worst_ = static_cast<float>(settings.temper * std::log(settings.z_random));
  table_.reserve(static_cast<size_t>(width_) * height_);
  const double scale = -0.5 / (settings.sigma_hit_m * settings.sigma_hit_m);
  for (int j = 0; j < height_; ++j) {
    for (int i = 0; i < width_; ++i) {
      const double d =
          laser_field.DistanceAt({origin_x_m_ + (i + 0.5) * cell_m, origin_y_m_ + (j + 0.5) * cell_m});
      const double p = (1 - settings.z_random) * std::exp(scale * d * d) + settings.z_random;
      table_.push_back(static_cast<float>(settings.temper * std::log(p)));
    }
  }
}

double SensorModel::LogLikelihood(const BeamEnds& ends, const maps::Pose2& robot_in_hall) const {
  const float c = static_cast<float>(std::cos(robot_in_hall.heading_rad) * cells_per_m_);
  const float s = static_cast<float>(std::sin(robot_in_hall.heading_rad) * cells_per_m_);
  const float x0 = static_cast<float>((robot_in_hall.x_m - origin_x_m_) * cells_per_m_);
  const float y0 = static_cast<float>((robot_in_hall.y_m - origin_y_m_) * cells_per_m_);
  const float width = static_cast<float>(width_), height = static_cast<float>(height_);
  const float* const xs = ends.x_m.data();
  const float* const ys = ends.y_m.data();
  float sum = 0;
  for (size_t k = 0; k < ends.size(); ++k) {
    const float u = x0 + c * xs[k] - s * ys[k];
    const float v = y0 + s * xs[k] + c * ys[k];
    const bool inside = u >= 0 && v >= 0 && u < width && v < height;
    sum += inside ? table_[static_cast<int>(v) * width_ + static_cast<int>(u)] : worst_;
  }
  return sum;
}

double ShareThroughWalls(const maps::DistanceGrid& laser_field, const BeamEnds& ends,
                         const maps::Pose2& robot_in_hall, double margin_m) {
  if (ends.size() == 0) return 0;
  const maps::Pose2 sensor = maps::Compose(robot_in_hall, {ends.sensor.x_m, ends.sensor.y_m, 0});
  const double least_step_m = laser_field.resolution_m / 2;
  int through = 0;
  for (size_t k = 0; k < ends.size(); ++k) {
    const maps::Pose2 end = maps::Compose(robot_in_hall, {ends.x_m[k], ends.y_m[k], 0});
    const double range_m = maps::Distance(sensor.position(), end.position());
    const double dx = (end.x_m - sensor.x_m) / range_m, dy = (end.y_m - sensor.y_m) / range_m;
    // Sphere tracing (Hart 1996): the field gives a distance that is free of surfaces.
    double t = 0;
    while (t < range_m - margin_m) {
      const double d = laser_field.DistanceAt({sensor.x_m + t * dx, sensor.y_m + t * dy});
      if (d <= 0) {
        ++through;
        break;
      }
      t += std::max(d, least_step_m);
    }
  }
  return static_cast<double>(through) / static_cast<double>(ends.size());
}

}  // namespace docent::robot
