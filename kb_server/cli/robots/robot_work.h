// What a robot works for, in words. Values; any thread.
#ifndef DOCENT_KB_SERVER_CLI_ROBOTS_ROBOT_WORK_H_
#define DOCENT_KB_SERVER_CLI_ROBOTS_ROBOT_WORK_H_

#include <string>

#include "docent/v1/fleet.pb.h"

namespace docent::server {

// "BoothGuide-1/Move2User moveToUser, ending"; empty: no run holds the robot.
std::string HeldText(const v1::RobotStatus& robot);

// What a robot that was taken out of service goes on with: a sentence on a line; empty: it did nothing.
std::string WorkAfterOut(const v1::RobotStatus& robot);

}  // namespace docent::server

#endif  // DOCENT_KB_SERVER_CLI_ROBOTS_ROBOT_WORK_H_
