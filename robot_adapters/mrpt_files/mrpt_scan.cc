#include "robot_adapters/mrpt_files/mrpt_scan.h"

#include <mrpt/poses/CPose3D.h>

#include <cmath>

namespace docent::robot {

mrpt::obs::CObservation2DRangeScan::Ptr ToMrpt(const maps::LaserScan& scan) {
  auto observation = mrpt::obs::CObservation2DRangeScan::Create();
  const size_t n = scan.range_m.size();
  observation->rightToLeft = scan.bearing_step_rad >= 0;
  observation->aperture =
      static_cast<float>(std::abs(scan.bearing_step_rad) * static_cast<double>(n > 0 ? n - 1 : 0));
  observation->maxRange = static_cast<float>(scan.max_range_m);
  // MRPT's scans are symmetric about the sensor's x axis: the remaining angle turns the sensor.
  const double middle =
      scan.first_bearing_rad + scan.bearing_step_rad * (n > 0 ? static_cast<double>(n - 1) / 2 : 0);
  observation->sensorPose = mrpt::poses::CPose3D(scan.sensor_in_robot.x_m, scan.sensor_in_robot.y_m, 0,
                                                 scan.sensor_in_robot.heading_rad + middle, 0, 0);
  observation->resizeScan(n);
  for (size_t i = 0; i < n; ++i) {
    observation->setScanRange(i, scan.range_m[i]);
    observation->setScanRangeValidity(i, scan.range_m[i] > 0 && scan.range_m[i] < scan.max_range_m);
  }
  return observation;
}

maps::LaserScan FromMrpt(const mrpt::obs::CObservation2DRangeScan& observation) {
  maps::LaserScan scan;
  const size_t n = observation.getScanSize();
  const double step = n > 1 ? observation.aperture / static_cast<double>(n - 1) : 0;
  const double sign = observation.rightToLeft ? 1 : -1;
  scan.first_bearing_rad = n > 1 ? -sign * observation.aperture / 2 : 0;
  scan.bearing_step_rad = sign * step;
  scan.max_range_m = observation.maxRange;
  scan.sensor_in_robot = {observation.sensorPose.x(), observation.sensorPose.y(),
                          observation.sensorPose.yaw()};
  scan.range_m.resize(n);
  for (size_t i = 0; i < n; ++i) {
    scan.range_m[i] = observation.getScanRangeValidity(i) ? observation.getScanRange(i) : 0.0f;
  }
  return scan;
}

}  // namespace docent::robot
