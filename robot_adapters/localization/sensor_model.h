// Sensor model: the likelihood of a laser scan from a pose, from a table of tempered log-likelihoods over the
// laser's plane that is read at every beam's end.
//
// A beam that ends outside the map or far from any surface gets log(z_random), never 0, so a pose gains
// nothing from beams that hit nothing. Immutable; any thread; no MRPT.
#ifndef DOCENT_ROBOT_ADAPTERS_LOCALIZATION_SENSOR_MODEL_H_
#define DOCENT_ROBOT_ADAPTERS_LOCALIZATION_SENSOR_MODEL_H_

#include <vector>

#include "maps/distance_grid.h"
#include "maps/laser_scan.h"
#include "robot_adapters/localization/localiser_settings.h"

namespace docent::robot {

// The ends of a scan's beams in the robot's frame; beams without return are left out.
struct BeamEnds {
  std::vector<float> x_m;
  std::vector<float> y_m;
  maps::Point2 sensor;  // origin of the beams
  size_t size() const { return x_m.size(); }
};

// At most `max_beams` beams, evenly thinned.
BeamEnds EndsOf(const maps::LaserScan& scan, int max_beams);

class SensorModel {
 public:
  SensorModel(const maps::DistanceGrid& laser_field, const SensorModelSettings& settings);

  // temper * sum over the beams of log p(beam | pose), with p scaled so that a beam that ends on a surface
  // has p = 1. The maximum is 0; the minimum is ends.size() * worst_beam().
  double LogLikelihood(const BeamEnds& ends, const maps::Pose2& robot_in_hall) const;

  // The tempered log-likelihood of a beam that fits no surface.
  double worst_beam() const { return worst_; }

 private:
  double origin_x_m_ = 0;
  double origin_y_m_ = 0;
  double cells_per_m_ = 0;
  int width_ = 0;
  int height_ = 0;
  float worst_ = 0;
  std::vector<float> table_;
};

// The share of beams that end more than `margin_m` behind the first mapped surface on their way: 0 for the
// true pose, even with people around, large for a wrong one. Rays are followed by sphere tracing on the
// field.
double ShareThroughWalls(const maps::DistanceGrid& laser_field, const BeamEnds& ends,
                         const maps::Pose2& robot_in_hall, double margin_m);

}  // namespace docent::robot

#endif  // DOCENT_ROBOT_ADAPTERS_LOCALIZATION_SENSOR_MODEL_H_
