#include "maps/roadmap.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <queue>
#include <string>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/str_split.h"
#include "graph/base/workflow_limits.h"

namespace docent::maps {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
// Points that are nearer to a place than this are at it.
constexpr double kSamePlaceM = 0.001;
// Goals whose lengths are remembered; then all are forgotten.
constexpr size_t kGoalsRemembered = 64;
// Coordinates beyond this are no place of a hall, and too far to be counted in millimetres.
constexpr double kFarthest = 1e9;

absl::string_view View(std::string_view text) {
  return {text.data(), text.size()};
}

// The numbers of a text of points and lengths; nullopt: there is something else.
std::optional<std::vector<double>> NumbersIn(std::string_view text) {
  const std::string plain = absl::StrReplaceAll(View(text), {{"POINT", " "}, {"(", " "}, {")", " "}});
  std::vector<double> numbers;
  for (const absl::string_view word : absl::StrSplit(plain, ' ', absl::SkipEmpty())) {
    double number = 0;
    if (!absl::SimpleAtod(word, &number) || !(std::abs(number) <= kFarthest)) return std::nullopt;
    numbers.push_back(number);
  }
  return numbers;
}

using Millimetres = std::pair<int64_t, int64_t>;
Millimetres PlaceAt(double x_m, double y_m) {
  return {std::llround(x_m * 1000), std::llround(y_m * 1000)};
}

struct Lengths {
  double forward_m = kInfinite, backward_m = kInfinite;
};
using ReadWays = std::map<std::pair<Millimetres, Millimetres>, Lengths>;

absl::Status ReadOne(std::string_view text, ReadWays* ways) {
  const std::optional<std::vector<double>> numbers = NumbersIn(text);
  if (!numbers || (numbers->size() != 4 && numbers->size() != 5) ||
      (numbers->size() == 5 && numbers->back() < 0)) {
    return absl::InvalidArgumentError(
        absl::StrCat("the way \"", View(text), "\" is not X1 Y1 X2 Y2 or X1 Y1 X2 Y2 LENGTH, in metres"));
  }
  const std::vector<double>& at = *numbers;
  Millimetres from = PlaceAt(at[0], at[1]), to = PlaceAt(at[2], at[3]);
  if (from == to) return absl::OkStatus();
  const bool forward = from < to;
  if (!forward) std::swap(from, to);
  const double straight =
      std::hypot(static_cast<double>(to.first - from.first), static_cast<double>(to.second - from.second)) /
      1000;
  const double length = at.size() == 5 ? at[4] : straight;
  Lengths& way = (*ways)[{from, to}];
  double& in_direction = forward ? way.forward_m : way.backward_m;
  in_direction = std::min(in_direction, length);
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<Point2> ReadPoint(std::string_view text) {
  const std::optional<std::vector<double>> numbers = NumbersIn(text);
  if (numbers && numbers->size() == 2) return Point2{(*numbers)[0], (*numbers)[1]};
  return absl::InvalidArgumentError(
      absl::StrCat("\"", View(text), "\" is no point; write X Y, in metres, or POINT(X Y)"));
}

absl::StatusOr<Roadmap> Roadmap::Read(std::string_view text) {
  ReadWays read;  // in an order of their own
  size_t count = 0;
  for (const absl::string_view part : absl::StrSplit(View(text), ';', absl::SkipWhitespace())) {
    if (++count > kWorkflowLimits.roadmap_ways) {
      return absl::ResourceExhaustedError(absl::StrCat(
          "the roadmap has more ways than the limit roadmap_ways, ", kWorkflowLimits.roadmap_ways));
    }
    if (absl::Status status = ReadOne({part.data(), part.size()}, &read); !status.ok()) return status;
  }
  Roadmap out;
  std::map<Millimetres, size_t> places;
  const auto place = [&](const Millimetres& at) {
    const auto [known, is_new] = places.emplace(at, out.places_.size());
    if (is_new) {
      out.places_.push_back({static_cast<double>(at.first) / 1000, static_cast<double>(at.second) / 1000});
      out.ways_of_.emplace_back();
    }
    return known->second;
  };
  for (const auto& [ends, lengths] : read) {
    const Way way{place(ends.first), place(ends.second), lengths.forward_m, lengths.backward_m};
    out.ways_of_[way.from].push_back(out.ways_.size());
    out.ways_of_[way.to].push_back(out.ways_.size());
    out.ways_.push_back(way);
  }
  return out;
}

Roadmap::Access Roadmap::AccessOf(const Point2& point) const {
  Access nearest{kInfinite, 0, 0};
  for (size_t i = 0; i < ways_.size(); ++i) {
    const Point2 &a = places_[ways_[i].from], &b = places_[ways_[i].to];
    const double dx = b.x_m - a.x_m, dy = b.y_m - a.y_m;
    const double square = dx * dx + dy * dy;
    double along = std::clamp(((point.x_m - a.x_m) * dx + (point.y_m - a.y_m) * dy) / square, 0.0, 1.0);
    if (along * std::sqrt(square) < kSamePlaceM) along = 0;
    if ((1 - along) * std::sqrt(square) < kSamePlaceM) along = 1;
    const double distance = std::hypot(a.x_m + along * dx - point.x_m, a.y_m + along * dy - point.y_m);
    if (distance < nearest.distance_m) nearest = {distance, i, along};
  }
  return nearest;
}

// Dijkstra, Numerische Mathematik 1 (1959), against the directions of the ways, from both ends of the goal's.
const std::vector<double>& Roadmap::LengthsTo(const Access& goal) {
  if (lengths_to_.size() >= kGoalsRemembered) lengths_to_.clear();
  const auto [known, is_new] = lengths_to_.try_emplace({goal.way, goal.along});
  std::vector<double>& lengths = known->second;
  if (!is_new) return lengths;
  lengths.assign(places_.size(), kInfinite);
  using Reached = std::pair<double, size_t>;
  std::priority_queue<Reached, std::vector<Reached>, std::greater<>> next;
  const auto reach = [&](size_t place, double length) {
    if (!(length < lengths[place])) return;
    lengths[place] = length;
    next.emplace(length, place);
  };
  const Way& last = ways_[goal.way];
  if (goal.along == 0) reach(last.from, 0);
  if (goal.along == 1) reach(last.to, 0);
  if (last.forward_m < kInfinite) reach(last.from, goal.along * last.forward_m);
  if (last.backward_m < kInfinite) reach(last.to, (1 - goal.along) * last.backward_m);
  while (!next.empty()) {
    const auto [length, place] = next.top();
    next.pop();
    if (length > lengths[place]) continue;
    for (const size_t i : ways_of_[place]) {
      const Way& way = ways_[i];
      if (way.to == place) reach(way.from, length + way.forward_m);
      if (way.from == place) reach(way.to, length + way.backward_m);
    }
  }
  return lengths;
}

absl::StatusOr<double> Roadmap::RouteLength(const Point2& from, const Point2& to) {
  const double straight = Distance(from, to);
  if (ways_.empty()) return straight;
  const Access start = AccessOf(from), goal = AccessOf(to);
  const double beside = start.distance_m + goal.distance_m;
  if (straight <= beside) return straight;
  const std::vector<double>& lengths = LengthsTo(goal);
  const Way& first = ways_[start.way];
  double length = kInfinite;
  const auto take = [&length](double share, double of_way, double rest) {
    if (of_way < kInfinite) length = std::min(length, share * of_way + rest);
  };
  take(1 - start.along, first.forward_m, lengths[first.to]);
  take(start.along, first.backward_m, lengths[first.from]);
  if (start.way == goal.way) {
    const bool ahead = goal.along >= start.along;
    take(std::abs(goal.along - start.along), ahead ? first.forward_m : first.backward_m, 0);
  }
  // Without a way in the direction from here, a robot at the end of the way is at its place.
  if (start.along == 0) take(0, 0, lengths[first.from]);
  if (start.along == 1) take(0, 0, lengths[first.to]);
  if (length == kInfinite) return absl::NotFoundError("no ways lead from the one point to the other");
  return beside + length;
}

}  // namespace docent::maps
