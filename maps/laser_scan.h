// One sweep of a horizontal laser range finder. A value; any thread.
#ifndef DOCENT_MAPS_LASER_SCAN_H_
#define DOCENT_MAPS_LASER_SCAN_H_

#include <vector>

#include "maps/geometry.h"

namespace docent::maps {

struct LaserScan {
  double first_bearing_rad = 0;  // of range_m[0], in the sensor's frame
  double bearing_step_rad = 0;   // between neighbours; negative for a sensor that turns clockwise
  double max_range_m = 0;        // maximum range of the sensor
  Pose2 sensor_in_robot;         // mounting pose of the sensor
  std::vector<float> range_m;    // 0: no return (nothing within range, or the reading was lost)
};

}  // namespace docent::maps

#endif  // DOCENT_MAPS_LASER_SCAN_H_
