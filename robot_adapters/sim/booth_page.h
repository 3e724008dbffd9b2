// Page for the robot's screen: presents a booth, with its place in the hall. Pure; any thread.
#ifndef DOCENT_ROBOT_ADAPTERS_SIM_BOOTH_PAGE_H_
#define DOCENT_ROBOT_ADAPTERS_SIM_BOOTH_PAGE_H_

#include <string>
#include <string_view>

#include "maps/hall_layout.h"
#include "robot_adapters/sim/graph_questions.h"

namespace docent::robot {

// &, <, >, " and ' as character references.
std::string EscapeHtml(std::string_view text);

// A complete HTML 5 document: style and a plan of the hall with booth and robot are inside. A script of the screen
// (ScreenServer) shows below it what the robot says; without it the page is whole.
// The texts of `booth` are plain text; they are escaped here. `picture`: a data: URI, or empty for none.
std::string BoothPage(const BoothInfo& booth, const std::string& picture, const maps::HallLayout& hall,
                      const maps::Pose2& robot_in_hall, std::string_view robot_name);

// A page with one text in large letters; `language` is its language tag, or empty.
std::string TextPage(const std::string& text, const std::string& language, const maps::HallLayout& hall,
                     std::string_view robot_name);

// The page while there is no booth to present.
std::string StandbyPage(const maps::HallLayout& hall, std::string_view robot_name);

// The spoken text about a booth.
std::string SpokenText(const BoothInfo& booth);

}  // namespace docent::robot

#endif  // DOCENT_ROBOT_ADAPTERS_SIM_BOOTH_PAGE_H_
