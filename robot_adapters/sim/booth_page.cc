#include "robot_adapters/sim/booth_page.h"

#include <algorithm>
#include <numbers>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "graph/base/text.h"

namespace docent::robot {
namespace {

constexpr char kStyle[] = R"css(
  :root { --ink: #1d2733; --soft: #5b6b7c; --paper: #f6f4ef; --accent: #ad4620; --card: #ffffff; --line: #d9d4c8; }
  * { box-sizing: border-box; }
  body { margin: 0; min-height: 100vh; background: var(--paper); color: var(--ink);
         font: 20px/1.55 "Source Sans 3", "Noto Sans", "DejaVu Sans", system-ui, sans-serif; }
  header { display: flex; justify-content: space-between; align-items: baseline; padding: 1.1rem 3vw;
           border-bottom: 1px solid var(--line); color: var(--soft); font-size: .85rem; letter-spacing: .04em; }
  main { display: grid; grid-template-columns: minmax(0, 3fr) minmax(0, 2fr); gap: 3vw; padding: 4vh 3vw; }
  @media (max-width: 900px) { main { grid-template-columns: 1fr; } }
  .tag { display: inline-block; padding: .15em .7em; border-radius: 999px; background: var(--accent); color: #fff;
         font-weight: 700; letter-spacing: .05em; }
  h1 { margin: .35em 0 .1em; font-size: clamp(2.2rem, 5vw, 4rem); line-height: 1.08; }
  .slogan { margin: 0 0 1.2em; color: var(--accent); font-size: 1.35rem; font-style: italic; }
  .text { max-width: 34em; font-size: 1.25rem; }
  ul { list-style: none; padding: 0; margin: 1.6em 0 0; display: flex; flex-wrap: wrap; gap: .6em; }
  li { background: var(--card); border: 1px solid var(--line); border-radius: .5em; padding: .5em 1em; }
  figure { margin: 0; background: var(--card); border: 1px solid var(--line); border-radius: .8em; padding: 1rem; }
  figcaption { color: var(--soft); font-size: .85rem; margin-top: .6em; }
  svg { display: block; width: 100%; height: auto; }
  .side { display: grid; gap: 1.2rem; align-content: start; }
  .picture { padding: 0; overflow: hidden; }
  .picture img { display: block; width: 100%; max-height: 30vh; object-fit: cover; }
  .picture + figure svg { max-height: 27vh; }
  #spoken { position: fixed; inset: auto 0 0 0; margin: 0; padding: 1rem 3vw; background: var(--ink); color: #aab4bf;
            font-size: 1.35rem; line-height: 1.4; }
  #spoken .said { color: #fff; }
  #spoken .now { color: #fff; background: var(--accent); border-radius: .2em; box-shadow: 0 0 0 .15em var(--accent); }
  body:has(#spoken:not([hidden])) { padding-bottom: 9rem; }
)css";

std::string PointsOf(const maps::Polygon& polygon, double height_m) {
  std::string points;
  // SVG's y goes down, the hall's up.
  for (const maps::Point2& p : polygon) absl::StrAppendFormat(&points, "%.2f,%.2f ", p.x_m, height_m - p.y_m);
  return points;
}

// A plan of the hall with one highlighted booth and the robot.
std::string PlanOf(const maps::HallLayout& hall, std::string_view booth_iri, const maps::Pose2* robot) {
  if (hall.outline.empty()) return "";
  const maps::Bounds bounds = maps::BoundsOf(hall.outline);
  const double top = bounds.max_y_m;
  std::string svg =
      absl::StrFormat("<svg viewBox=\"%.2f %.2f %.2f %.2f\" role=\"img\" aria-label=\"Plan of the hall\">",
                      bounds.min_x_m - 0.3, -0.3, bounds.max_x_m - bounds.min_x_m + 0.6,
                      bounds.max_y_m - bounds.min_y_m + 0.6);
  absl::StrAppendFormat(&svg,
                        "<polygon points=\"%s\" fill=\"#fbfaf7\" stroke=\"#1d2733\" stroke-width=\".25\"/>",
                        PointsOf(hall.outline, top));
  for (const maps::Region& region : hall.regions) {
    if (!region.is_booth) continue;
    const bool shown = region.iri == booth_iri;
    absl::StrAppendFormat(&svg,
                          "<polygon points=\"%s\" fill=\"%s\" stroke=\"#b9b2a3\" stroke-width=\".06\"/>",
                          PointsOf(region.outline, top), shown ? "#f0b79f" : "#ece8de");
    const maps::Point2 middle = maps::Centroid(region.outline);
    absl::StrAppendFormat(
        &svg, "<text x=\"%.2f\" y=\"%.2f\" font-size=\"1\" text-anchor=\"middle\" fill=\"%s\">%s</text>",
        middle.x_m, top - middle.y_m + 0.35, shown ? "#8a2f10" : "#8b8576", EscapeHtml(region.name));
  }
  for (const maps::Obstacle& obstacle : hall.obstacles) {
    if (obstacle.disc) {
      absl::StrAppendFormat(&svg, "<circle cx=\"%.2f\" cy=\"%.2f\" r=\"%.2f\" fill=\"#5b6b7c\"/>",
                            obstacle.disc->center.x_m, top - obstacle.disc->center.y_m,
                            obstacle.disc->radius_m);
    } else {
      absl::StrAppendFormat(&svg, "<polygon points=\"%s\" fill=\"#5b6b7c\"/>",
                            PointsOf(obstacle.outline, top));
    }
  }
  if (robot != nullptr) {
    absl::StrAppendFormat(
        &svg,
        "<g transform=\"translate(%.2f %.2f) rotate(%.1f)\"><circle r=\".55\" fill=\"#ad4620\"/>"
        "<path d=\"M.5 0 -.2 .28 -.2 -.28Z\" fill=\"#fff\"/></g>",
        robot->x_m, top - robot->y_m, -robot->heading_rad * 180 / std::numbers::pi);
  }
  return svg + "</svg>";
}

std::string Document(const std::string& title, const std::string& hall_name, std::string_view robot_name,
                     const std::string& body) {
  return absl::StrCat(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>", title,
      "</title>\n<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<style>", kStyle,
      "</style>\n</head>\n<body>\n<header><span>", EscapeHtml(hall_name), "</span><span>",
      EscapeHtml(robot_name), "</span></header>\n<main>\n", body,
      "</main>\n<p id=\"spoken\" hidden></p>\n<script src=\"/-/screen.js\" "
      "defer></script>\n</body>\n</html>\n");
}

}  // namespace

std::string EscapeHtml(std::string_view text) {
  std::string out;
  for (char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&#39;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string BoothPage(const BoothInfo& booth, const std::string& picture, const maps::HallLayout& hall,
                      const maps::Pose2& robot_in_hall, std::string_view robot_name) {
  const std::string name = EscapeHtml(booth.name.empty() ? booth.iri : booth.name);
  const std::string heading = booth.exhibitor.empty() ? name : EscapeHtml(booth.exhibitor);
  std::string body =
      absl::StrCat("<section>\n<span class=\"tag\">Booth ", name, "</span>\n<h1>", heading, "</h1>\n");
  if (!booth.slogan.empty())
    absl::StrAppend(&body, "<p class=\"slogan\">", EscapeHtml(booth.slogan), "</p>\n");
  if (!booth.description.empty()) {
    absl::StrAppend(&body, "<p class=\"text\">", EscapeHtml(booth.description), "</p>\n");
  }
  if (!booth.products.empty()) {
    absl::StrAppend(&body, "<ul>");
    for (const std::string& product : booth.products)
      absl::StrAppend(&body, "<li>", EscapeHtml(product), "</li>");
    absl::StrAppend(&body, "</ul>\n");
  }
  absl::StrAppend(&body, "</section>\n<div class=\"side\">\n");
  if (!picture.empty()) {
    const std::string shown = booth.products.empty() ? heading : EscapeHtml(booth.products.front());
    absl::StrAppend(&body, "<figure class=\"picture\"><img alt=\"", shown, "\" src=\"", EscapeHtml(picture),
                    "\"></figure>\n");
  }
  const maps::Region* region = hall.FindRegion(booth.iri);
  const bool here =
      region != nullptr && maps::Contains(region->outline, {robot_in_hall.x_m, robot_in_hall.y_m});
  absl::StrAppend(&body, "<figure>", PlanOf(hall, booth.iri, &robot_in_hall), "<figcaption>",
                  here ? "You are here, at booth " : "Where you are, and booth ", name,
                  ".</figcaption></figure>\n</div>\n");
  return Document(absl::StrCat(heading, " – booth ", name), hall.name, robot_name, body);
}

std::string TextPage(const std::string& text, const std::string& language, const maps::HallLayout& hall,
                     std::string_view robot_name) {
  const std::string name = EscapeHtml(robot_name);
  const std::string tag = language.empty() ? "" : absl::StrCat(" lang=\"", EscapeHtml(language), "\"");
  return Document(name, hall.name, robot_name,
                  absl::StrCat("<section>\n<span class=\"tag\">", name, "</span>\n<h1", tag, ">",
                               EscapeHtml(text), "</h1>\n</section>\n"));
}

std::string StandbyPage(const maps::HallLayout& hall, std::string_view robot_name) {
  const std::string name = EscapeHtml(robot_name);
  const std::string body = absl::StrCat(
      "<section>\n<span class=\"tag\">", name, "</span>\n<h1>May I guide you?</h1>\n",
      "<p class=\"text\">Choose the guide service, and I will come to you.</p>\n", "</section>\n<figure>",
      PlanOf(hall, "", nullptr), "<figcaption>", EscapeHtml(hall.name), "</figcaption></figure>\n");
  return Document(name, hall.name, robot_name, body);
}

std::string SpokenText(const BoothInfo& booth) {
  std::string text = "Welcome to booth ";
  // "B03" would be spoken letter by letter with its zero; people say "B 3".
  const size_t digits = booth.name.find_first_of("0123456789");
  if (digits == std::string::npos) {
    text += booth.name;
  } else {
    const size_t number = std::min(booth.name.find_first_not_of('0', digits), booth.name.size() - 1);
    absl::StrAppend(&text, booth.name.substr(0, digits), " ", booth.name.substr(number));
  }
  if (!booth.exhibitor.empty()) absl::StrAppend(&text, " of ", booth.exhibitor);
  text += ".";
  if (!booth.slogan.empty()) absl::StrAppend(&text, " ", booth.slogan, ".");
  if (!booth.description.empty()) absl::StrAppend(&text, " ", booth.description);
  return text;
}

}  // namespace docent::robot
