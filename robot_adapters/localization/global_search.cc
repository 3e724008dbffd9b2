#include "robot_adapters/localization/global_search.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace docent::robot {
namespace {

// Centres of the free places on a lattice over the map.
std::vector<maps::Point2> FreePlaces(const maps::DistanceGrid& clearance, const LocaliserSettings& settings) {
  std::vector<maps::Point2> places;
  const double width_m = clearance.width * clearance.resolution_m,
               height_m = clearance.height * clearance.resolution_m;
  for (double y = settings.search_step_m / 2; y < height_m; y += settings.search_step_m) {
    for (double x = settings.search_step_m / 2; x < width_m; x += settings.search_step_m) {
      const maps::Point2 p = {clearance.origin_x_m + x, clearance.origin_y_m + y};
      const double needed =
          std::min(settings.search_clearance_m, clearance.max_distance_m - clearance.resolution_m);
      if (clearance.StateAt(p) == maps::CellState::kFree && clearance.DistanceAt(p) >= needed)
        places.push_back(p);
    }
  }
  return places;
}

// Coordinate descent from `start` with shrinking steps to a local maximum of the likelihood.
Candidate Refine(const SensorModel& model, const BeamEnds& ends, const maps::Pose2& start,
                 const LocaliserSettings& settings) {
  Candidate best = {start, model.LogLikelihood(ends, start)};
  double step_m = settings.search_step_m / 2, step_rad = settings.search_step_rad / 2;
  for (int round = 0; round < 40 && step_m > 0.005; ++round) {
    bool better = false;
    for (int axis = 0; axis < 3; ++axis) {
      for (const double sign : {-1.0, 1.0}) {
        maps::Pose2 trial = best.robot_in_hall;
        if (axis == 0) trial.x_m += sign * step_m;
        if (axis == 1) trial.y_m += sign * step_m;
        if (axis == 2) trial.heading_rad = maps::WrapAngle(trial.heading_rad + sign * step_rad);
        const double score = model.LogLikelihood(ends, trial);
        if (score <= best.log_likelihood) continue;
        best = {trial, score};
        better = true;
      }
    }
    if (better) continue;
    step_m /= 2;
    step_rad /= 2;
  }
  return best;
}

bool Near(const maps::Pose2& a, const maps::Pose2& b, const LocaliserSettings& settings) {
  return maps::Distance(a.position(), b.position()) < settings.search_step_m &&
         std::abs(maps::WrapAngle(a.heading_rad - b.heading_rad)) < 2 * settings.search_step_rad;
}

bool Better(const Candidate& a, const Candidate& b) {
  return a.log_likelihood > b.log_likelihood;
}

}  // namespace

std::vector<Candidate> SearchGlobally(const maps::HallModel& hall, const SensorModel& model,
                                      const maps::LaserScan& scan, const LocaliserSettings& settings,
                                      int count) {
  const BeamEnds few = EndsOf(scan, settings.search_beams);
  const BeamEnds all = EndsOf(scan, settings.sensor.max_beams);
  if (few.size() == 0 || count < 1) return {};
  // On the coarse lattice the true pose may be half a step away, so the score uses a larger spread.
  SensorModelSettings coarse_settings = settings.sensor;
  coarse_settings.sigma_hit_m = std::max(settings.sensor.sigma_hit_m, settings.search_step_m / 2);
  const SensorModel coarse(hall.laser_field(), coarse_settings);

  const size_t kept = static_cast<size_t>(count) * 8;  // candidates of each round that are refined
  std::vector<Candidate> found;
  const auto prune = [&found, kept] {
    if (found.size() <= kept) return;
    std::nth_element(found.begin(), found.begin() + kept, found.end(), Better);
    found.resize(kept);
  };
  const int headings =
      std::max(1, static_cast<int>(std::ceil(2 * std::numbers::pi / settings.search_step_rad)));
  for (const maps::Point2& place : FreePlaces(hall.clearance(), settings)) {
    for (int k = 0; k < headings; ++k) {
      const maps::Pose2 pose = {place.x_m, place.y_m, maps::WrapAngle(2 * std::numbers::pi * k / headings)};
      found.push_back({pose, coarse.LogLikelihood(few, pose)});
    }
    if (found.size() > 64 * kept) prune();
  }
  prune();
  for (Candidate& candidate : found) candidate = Refine(model, all, candidate.robot_in_hall, settings);
  std::sort(found.begin(), found.end(), Better);
  std::vector<Candidate> distinct;
  for (const Candidate& candidate : found) {
    const bool known = std::any_of(distinct.begin(), distinct.end(), [&](const Candidate& other) {
      return Near(candidate.robot_in_hall, other.robot_in_hall, settings);
    });
    if (!known) distinct.push_back(candidate);
    if (distinct.size() == static_cast<size_t>(count)) break;
  }
  return distinct;
}

}  // namespace docent::robot
