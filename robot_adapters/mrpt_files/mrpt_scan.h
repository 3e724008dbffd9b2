// Conversion of laser scans to MRPT and back. Pure functions; any thread.
#ifndef DOCENT_ROBOT_ADAPTERS_MRPT_FILES_MRPT_SCAN_H_
#define DOCENT_ROBOT_ADAPTERS_MRPT_FILES_MRPT_SCAN_H_

#include <mrpt/obs/CObservation2DRangeScan.h>

#include "maps/laser_scan.h"

namespace docent::robot {

// The observation's time stamp is left unset.
mrpt::obs::CObservation2DRangeScan::Ptr ToMrpt(const maps::LaserScan& scan);
maps::LaserScan FromMrpt(const mrpt::obs::CObservation2DRangeScan& observation);

}  // namespace docent::robot

#endif  // DOCENT_ROBOT_ADAPTERS_MRPT_FILES_MRPT_SCAN_H_
