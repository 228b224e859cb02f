#include "topogeo/simulation/sonar.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "topogeo/scan/scan.hpp"
#include "topogeo/simulation/laser.hpp"

namespace topogeo::simulation {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

world::World with_wall(std::vector<world::Segment> segments,
                       std::vector<world::Circle> circles = {}) {
  world::World world;
  world.segments = std::move(segments);
  world.circles = std::move(circles);
  return world;
}

TEST(Echo, ComesFromTheNearestPointInTheCone) {
  const geometry::Pose2 origin;
  // A wall across the cone: its foot; a wall beside it: its intersection with the cone's edge.
  const Echo across = echo(with_wall({{{2, -5}, {2, 5}}}), origin, 30.0 * kDegree, 9.0);
  EXPECT_NEAR(across.range_m, 2.0, 1e-12);
  EXPECT_NEAR(across.incidence_rad, 0.0, 1e-12);
  const Echo beside = echo(with_wall({{{-5, 1}, {5, 1}}}), origin, 30.0 * kDegree, 9.0);
  EXPECT_NEAR(beside.range_m, 2.0, 1e-12);  // 1 / sin 30
  EXPECT_NEAR(beside.incidence_rad, 60.0 * kDegree, 1e-12);
  // The end of a wall is an edge, which reflects sound in all directions.
  const Echo end = echo(with_wall({{{3, 0.5}, {3, 5}}}), origin, 30.0 * kDegree, 9.0);
  EXPECT_NEAR(end.range_m, std::hypot(3.0, 0.5), 1e-12);
  EXPECT_NEAR(end.incidence_rad, 0.0, 1e-12);
}

TEST(Echo, HearsNothingBehindBesideOrTooFar) {
  const geometry::Pose2 origin;
  EXPECT_TRUE(std::isinf(echo(with_wall({{{-1, -1}, {-1, 1}}}), origin, 0.3, 9.0).range_m));
  EXPECT_TRUE(std::isinf(echo(with_wall({{{1, 2}, {2, 2}}}), origin, 0.3, 9.0).range_m));
  EXPECT_TRUE(std::isinf(echo(with_wall({{{9, -1}, {9, 1}}}), origin, 0.3, 9.0).range_m));
  EXPECT_TRUE(std::isinf(echo(with_wall({}, {{{-2, 0}, 0.5}}), origin, 0.3, 9.0).range_m));
}

TEST(Echo, ComesFromColumns) {
  EXPECT_NEAR(echo(with_wall({}, {{{3, 0.2}, 0.5}}), {}, 0.3, 9.0).range_m,
              std::hypot(3.0, 0.2) - 0.5, 1e-12);
  // Its near side is outside the cone: the cone's edge is a tangent at 60 degrees.
  const Echo brushed =
      echo(with_wall({}, {{{2.0 * std::cos(0.6), 2.0 * std::sin(0.6)}, 1.0}}), {}, 0.3, 9.0);
  EXPECT_NEAR(brushed.range_m,
              2.0 * std::cos(0.3) - std::sqrt(1.0 - std::pow(2.0 * std::sin(0.3), 2)), 1e-12);
}

// Compared with a fan of thousands of rays on the shipped floor.
TEST(Echo, IsTheNearestOfManyRays) {
  const world::World floor =
      world::load_world(std::string(TOPOGEO_SHARE) + "/worlds/floor.world.yaml");
  constexpr double kHalf_rad = 15.0 * kDegree;
  constexpr double kMax_m = 5.0;
  support::Random random(3);
  int heard = 0;
  for (int round = 0; round < 300; ++round) {
    const geometry::Pose2 pose{random.uniform(0.0, 30.0), random.uniform(0.0, 20.0),
                               random.uniform(-std::numbers::pi, std::numbers::pi)};
    const BeamPattern fan{-kHalf_rad, 2.0 * kHalf_rad / 2000.0, 2001, kMax_m};
    const std::vector<double> rays_m = raycast(floor, pose, fan);
    const double nearest_m = *std::min_element(rays_m.begin(), rays_m.end());
    const Echo exact = echo(floor, pose, kHalf_rad, kMax_m);
    // No ray is nearer; the nearest ray exceeds it at most by the spacing to the next ray.
    EXPECT_LE(exact.range_m, nearest_m + 1e-9) << round;
    if (std::isinf(nearest_m)) continue;
    EXPECT_NEAR(exact.range_m, nearest_m, 0.02) << round;
    ++heard;
  }
  EXPECT_GT(heard, 150);
}

TEST(Measure, ReadsNoneMinAndNoise) {
  const SonarNoise exact{.sigma_m = 0.0, .resolution_m = 0.0};
  support::Random random(1);
  const auto readings_m = measure({{.range_m = 1.234}, {.range_m = 0.05}, {}}, exact, random);
  EXPECT_FLOAT_EQ(readings_m[0], 1.234F);
  EXPECT_FLOAT_EQ(readings_m[1], 0.15F);
  EXPECT_EQ(readings_m[2], scan::Scan::kNoReturn);
  const SonarNoise noisy{.sigma_m = 0.1, .resolution_m = 0.0};
  double sum2 = 0.0;
  for (int i = 0; i < 4000; ++i) {
    const double error_m = static_cast<double>(measure({{.range_m = 2.0}}, noisy, random)[0]) - 2.0;
    sum2 += error_m * error_m;
  }
  EXPECT_NEAR(std::sqrt(sum2 / 4000.0), 0.1, 0.01);
}

TEST(Measure, SmoothWallsThrowObliqueSoundElsewhere) {
  SonarNoise noise{.sigma_m = 0.0};
  noise.specular_loss_probability = 1.0;
  support::Random random(1);
  const auto readings_m = measure({{2.0, 20.0 * kDegree}, {2.0, 40.0 * kDegree}}, noise, random);
  EXPECT_FLOAT_EQ(readings_m[0], 2.0F);
  EXPECT_EQ(readings_m[1], scan::Scan::kNoReturn);
}

TEST(Measure, FarReadingsErrAsMacondoFound) {
  SonarNoise noise = macondo_sonar_noise();
  noise.sigma_m = 0.0;
  noise.resolution_m = 0.0;
  noise.missing_probability = 0.0;
  support::Random random(2);
  int off = 0;
  constexpr int kRounds = 4000;
  for (int i = 0; i < kRounds; ++i) {
    const auto readings_m = measure({{.range_m = 2.4}, {.range_m = 4.0}}, noise, random);
    EXPECT_FLOAT_EQ(readings_m[0], 2.4F);
    EXPECT_NEAR(readings_m[1], 4.0, 0.3 + 1e-6);
    off += std::fabs(readings_m[1] - 4.0F) > 1e-6F ? 1 : 0;
  }
  EXPECT_NEAR(off / static_cast<double>(kRounds), 0.75, 0.03);
}

TEST(Measure, ReflectedSoundReadsLongerAndSomeEchoesAreMissing) {
  SonarNoise noise{.sigma_m = 0.0, .resolution_m = 0.0};
  noise.specular_loss_probability = 1.0;
  noise.reflection_probability = 0.5;
  noise.reflection_detour_m = 1.0;
  noise.missing_probability = 0.1;
  support::Random random(4);
  int longer = 0;
  int missing = 0;
  constexpr int kRounds = 4000;
  for (int i = 0; i < kRounds; ++i) {
    const auto readings_m = measure({{1.0, 40.0 * kDegree}, {1.0, 0.0}}, noise, random);
    missing += readings_m[1] == scan::Scan::kNoReturn ? 1 : 0;
    if (readings_m[0] == scan::Scan::kNoReturn) continue;
    EXPECT_GE(readings_m[0], 1.0F);
    EXPECT_LE(readings_m[0], 2.0F);
    ++longer;
  }
  EXPECT_NEAR(longer / static_cast<double>(kRounds), 0.5 * 0.9, 0.03);
  EXPECT_NEAR(missing / static_cast<double>(kRounds), 0.1, 0.02);
}

}  // namespace
}  // namespace topogeo::simulation
