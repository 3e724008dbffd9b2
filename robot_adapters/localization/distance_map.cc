#include "robot_adapters/localization/distance_map.h"

#include <mrpt/poses/CPose3D.h>
#include <mrpt/serialization/CArchive.h>

#include <cmath>
#include <stdexcept>

namespace docent::robot {

IMPLEMENTS_SERIALIZABLE(DistanceMap, mrpt::maps::CMetricMap, docent::robot)

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

void DistanceMap::Prepare(const mrpt::obs::CObservation2DRangeScan& observation) {
  prepared_ends_ = EndsOf(FromMrpt(observation), max_beams_);
  prepared_ = &observation;
}

double DistanceMap::internal_computeObservationLikelihood(const mrpt::obs::CObservation& observation,
                                                          const mrpt::poses::CPose3D& robot_in_hall) const {
  const maps::Pose2 pose = {robot_in_hall.x(), robot_in_hall.y(), robot_in_hall.yaw()};
  if (&observation == prepared_) return model_->LogLikelihood(prepared_ends_, pose);
  const auto& scan = dynamic_cast<const mrpt::obs::CObservation2DRangeScan&>(observation);
  return model_->LogLikelihood(EndsOf(FromMrpt(scan), max_beams_), pose);
}

bool DistanceMap::internal_canComputeObservationLikelihood(const mrpt::obs::CObservation& observation) const {
  return model_ != nullptr &&
         dynamic_cast<const mrpt::obs::CObservation2DRangeScan*>(&observation) != nullptr;
}

bool DistanceMap::internal_insertObservation(const mrpt::obs::CObservation&,
                                             const std::optional<const mrpt::poses::CPose3D>&) {
  return false;
}

void DistanceMap::internal_clear() {
  model_.reset();
  prepared_ = nullptr;
}

void DistanceMap::saveMetricMapRepresentationToFile(const std::string&) const {}

void DistanceMap::getVisualizationInto(mrpt::opengl::CSetOfObjects&) const {}

std::string DistanceMap::asString() const {
  return "likelihood field on the hall's distance grid";
}

// The map is made from the hall model, which has a file format of its own.
uint8_t DistanceMap::serializeGetVersion() const {
  return 0;
}
void DistanceMap::serializeTo(mrpt::serialization::CArchive&) const {
  throw std::logic_error("DistanceMap is not serialised; save the HallModel");
}
void DistanceMap::serializeFrom(mrpt::serialization::CArchive&, uint8_t) {
  throw std::logic_error("DistanceMap is not serialised; load the HallModel");
}

}  // namespace docent::robot
