#include "robot_adapters/localization/particle_filter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace docent::robot {
namespace {

using maps::Pose2;

double Flat(const Pose2&) {
  return 0;
}

struct Spread {
  double mean_x = 0, mean_y = 0, sd_x = 0, sd_y = 0, sd_heading = 0;
};
Spread SpreadOf(const ParticleFilter& filter) {
  Spread out;
  const double n = static_cast<double>(filter.particles().size());
  double heading = 0;
  for (const Particle& p : filter.particles()) {
    out.mean_x += p.robot_in_hall.x_m / n;
    out.mean_y += p.robot_in_hall.y_m / n;
    heading += p.robot_in_hall.heading_rad / n;
  }
  for (const Particle& p : filter.particles()) {
    out.sd_x += std::pow(p.robot_in_hall.x_m - out.mean_x, 2) / n;
    out.sd_y += std::pow(p.robot_in_hall.y_m - out.mean_y, 2) / n;
    out.sd_heading += std::pow(p.robot_in_hall.heading_rad - heading, 2) / n;
  }
  out.sd_x = std::sqrt(out.sd_x);
  out.sd_y = std::sqrt(out.sd_y);
  out.sd_heading = std::sqrt(out.sd_heading);
  return out;
}

TEST(ParticleFilter, MovesByTheIncrementWithTheErrorsOfTheMotionModel) {
  std::mt19937_64 random(1);
  const MotionModelSettings motion;
  ParticleFilter filter(motion, 0.5, &random);
  filter.Spread({{{1, 2, M_PI / 2}, 1.0}}, 1e-9, 1e-9, 20000);
  EXPECT_NEAR(filter.Step({1, 0, 0.5}, Flat), 20000, 1e-6) << "all weigh the same";
  const Spread spread = SpreadOf(filter);
  EXPECT_NEAR(spread.mean_x, 1, 0.01);
  EXPECT_NEAR(spread.mean_y, 3, 0.01) << "its front looks along y";
  const double xy = motion.min_xy_m + motion.xy_per_m + motion.xy_per_rad / 2;
  EXPECT_NEAR(spread.sd_x, xy, 0.03 * xy);
  EXPECT_NEAR(spread.sd_y, xy, 0.03 * xy);
  const double heading = motion.min_heading_rad + motion.heading_per_m + motion.heading_per_rad / 2;
  EXPECT_NEAR(spread.sd_heading, heading, 0.03 * heading);
}

TEST(ParticleFilter, FewThatCarryTheWeightAreDrawnAgainInProportionToIt) {
  std::mt19937_64 random(2);
  MotionModelSettings still;
  still.min_xy_m = still.min_heading_rad = 1e-9;
  ParticleFilter filter(still, 0.5, &random);
  filter.Spread({{{0, 0, 0}, 0.25}, {{10, 0, 0}, 0.75}}, 1e-6, 1e-6, 10000);
  // Of the quarter at 0 each weighs nine times as much as one at 10.
  const double effective =
      filter.Step({0, 0, 0}, [](const Pose2& p) { return p.x_m < 5 ? std::log(9.0) : 0.0; });
  EXPECT_NEAR(effective, 10000 * 9.0 / 21, 150) << "(2500 * 9 + 7500)^2 / (2500 * 81 + 7500)";
  size_t left = 0;
  for (const Particle& p : filter.particles()) {
    left += p.robot_in_hall.x_m < 5 ? 1 : 0;
    EXPECT_EQ(p.log_weight, 0);
  }
  EXPECT_EQ(filter.particles().size(), 10000u);
  EXPECT_NEAR(static_cast<double>(left), 7500, 150);
}

TEST(ParticleFilter, ManyThatCarryTheWeightKeepIt) {
  std::mt19937_64 random(3);
  ParticleFilter filter({}, 0.5, &random);
  filter.Spread({{{0, 0, 0}, 1.0}}, 1, 0.1, 1000);
  const double effective =
      filter.Step({0, 0, 0}, [](const Pose2& p) { return p.x_m < 0 ? std::log(2.0) : 0.0; });
  EXPECT_GT(effective, 800);
  bool lighter = false;
  for (const Particle& p : filter.particles()) lighter = lighter || p.log_weight < -0.5;
  EXPECT_TRUE(lighter) << "the weights go on to the next step";
}

TEST(ParticleFilter, ImpossibleEverywhereIsAsGoodAsAnything) {
  std::mt19937_64 random(4);
  ParticleFilter filter({}, 0.5, &random);
  filter.Spread({{{0, 0, 0}, 1.0}}, 1, 0.1, 100);
  EXPECT_GT(filter.Step({0, 0, 0}, [](const Pose2&) { return -1e6; }), 99);
}

// MRPT's random numbers are those of the process or the thread: each step seeds them.
TEST(ParticleFilter, TheSameSeedGivesTheSameParticlesWhateverOthersDraw) {
  const auto run = [](bool beside_another) {
    std::mt19937_64 random(5), of_another(6);
    ParticleFilter filter({}, 0.9, &random), another({}, 0.9, &of_another);
    const auto weigh = [](const Pose2& p) { return -p.x_m * p.x_m; };
    filter.Spread({{{0, 0, 0}, 1.0}}, 1, 0.1, 200);
    another.Spread({{{0, 0, 0}, 1.0}}, 1, 0.1, 300);
    for (int step = 0; step < 5; ++step) {
      filter.Step({0.1, 0, 0.1}, weigh);
      if (beside_another) another.Step({0.1, 0, 0.1}, weigh);
    }
    return filter.particles();
  };
  const std::vector<Particle> alone = run(false), beside = run(true);
  ASSERT_EQ(alone.size(), beside.size());
  for (size_t i = 0; i < alone.size(); ++i) {
    EXPECT_EQ(alone[i].robot_in_hall, beside[i].robot_in_hall);
    EXPECT_EQ(alone[i].log_weight, beside[i].log_weight);
  }
}

}  // namespace
}  // namespace docent::robot
