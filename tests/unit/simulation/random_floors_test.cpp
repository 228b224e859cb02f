#include "topogeo/simulation/random_floors.hpp"

#include <cmath>
#include <functional>
#include <string>

#include <gtest/gtest.h>

#include "topogeo/simulation/drive.hpp"
#include "topogeo/simulation/laser.hpp"

namespace topogeo::simulation {
namespace {

struct Floor {
  const char* name;
  std::function<world::World(std::uint64_t)> draw;
  double shortest_m;  // of the tour
  double longest_m;
};

// Printed by the test runner instead of the bytes.
std::ostream& operator<<(std::ostream& out, const Floor& floor) {
  return out << floor.name;
}

double length_m(const world::World& world) {
  double sum_m = 0.0;
  for (std::size_t i = 1; i < world.tour_m.size(); ++i) {
    sum_m += (world.tour_m[i] - world.tour_m[i - 1]).norm();
  }
  return sum_m;
}

class RandomFloors : public ::testing::TestWithParam<Floor> {};

TEST_P(RandomFloors, TheTourKeepsClearOfEverythingWhateverTheSeed) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const world::World world = GetParam().draw(seed);
    EXPECT_GE(length_m(world), GetParam().shortest_m) << seed;
    EXPECT_LE(length_m(world), GetParam().longest_m) << seed;
    const auto poses = drive(world.tour_m, {});
    for (std::size_t i = 0; i < poses.size(); i += 10) {
      const Eigen::Vector2d here_m = poses[i].T_world_robot.position_m();
      ASSERT_GT(clearance_m(world, here_m), 0.3) << "seed " << seed << ": " << here_m.transpose();
    }
  }
}

// No beam may leave the building: the walls are closed for any arrangement of rooms.
TEST_P(RandomFloors, AreClosed) {
  const BeamPattern all_round{
      .angle_min_rad = -3.1, .angle_step_rad = 0.0155, .count = 400, .range_max_m = 200.0};
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const world::World world = GetParam().draw(seed);
    for (const Eigen::Vector2d& place_m : world.tour_m) {
      for (const double range_m : raycast(world, {place_m.x(), place_m.y(), 0.0}, all_round)) {
        ASSERT_FALSE(std::isinf(range_m)) << "seed " << seed << ": " << place_m.transpose();
      }
    }
  }
}

TEST_P(RandomFloors, DependOnTheSeedAlone) {
  const world::World first = GetParam().draw(5);
  const world::World again = GetParam().draw(5);
  const world::World other = GetParam().draw(6);
  ASSERT_EQ(first.segments.size(), again.segments.size());
  for (std::size_t i = 0; i < first.segments.size(); ++i) {
    ASSERT_EQ(first.segments[i].a_m, again.segments[i].a_m);
    ASSERT_EQ(first.segments[i].b_m, again.segments[i].b_m);
  }
  EXPECT_NE(first.tour_m[1], other.tour_m[1]);
}

INSTANTIATE_TEST_SUITE_P(
    Simulation, RandomFloors,
    ::testing::Values(Floor{"cyclic", cyclic_floor, 100.0, 140.0},
                      Floor{"corridor", corridor_there_and_back, 50.0, 80.0},
                      Floor{"two_loops", two_loops, 110.0, 190.0},
                      Floor{"bare_corridor", bare_corridor, 80.0, 110.0},
                      Floor{"symmetric", symmetric_building, 85.0, 120.0},
                      Floor{"long_corridors", long_corridors, 230.0, 1600.0},
                      Floor{"large", [](std::uint64_t seed) { return large_floor(seed, 300.0); },
                            300.0, 325.0}),
    [](const auto& tested) { return std::string(tested.param.name); });

TEST(SymmetricBuilding, ALaserSeesTheSameInBothWings) {
  const world::World world = symmetric_building(3);
  const double apart_m = world.tour_m[4].x() - world.tour_m[1].x();
  ASSERT_GE(apart_m, 13.0);
  const BeamPattern beams;
  const geometry::Pose2 first{world.tour_m[2].x(), world.tour_m[2].y() - 2.0, 1.2};
  const geometry::Pose2 second{first.x_m + apart_m, first.y_m, first.theta_rad};
  const auto seen_m = raycast(world, first, beams);
  const auto again_m = raycast(world, second, beams);
  for (std::size_t i = 0; i < seen_m.size(); ++i) ASSERT_NEAR(seen_m[i], again_m[i], 1e-6) << i;
}

TEST(BareCorridor, NothingStandsOnItsWalls) {
  const world::World world = bare_corridor(4);
  const double half_m = clearance_m(world, {15.0, 0.0});
  for (double x_m = 2.0; x_m < 32.0; x_m += 0.1) {
    ASSERT_NEAR(clearance_m(world, {x_m, 0.0}), half_m, 1e-9) << x_m;
  }
}

TEST(LargeFloor, AWayOutOfRangeIsAnError) {
  EXPECT_THROW(large_floor(1, 49.0), std::invalid_argument);
  EXPECT_THROW(large_floor(1, std::nan("")), std::invalid_argument);
  EXPECT_THROW(large_floor(1, 100.0, 0), std::invalid_argument);
  EXPECT_THROW(large_floor(1, 100.0, 41), std::invalid_argument);
}

TEST(B21Odometry, SystematicErrorsDifferBySeedAndStayWithinTheirBounds) {
  double least = 1.0;
  double most = -1.0;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const OdometryDrift drift = b21_odometry(seed);
    least = std::min(least, drift.range_scale_error);
    most = std::max(most, drift.range_scale_error);
    EXPECT_EQ(drift.range_sigma_m_per_sqrt_m, 0.057);
    EXPECT_LE(std::fabs(drift.heading_drift_rad_per_m), 0.0044);
    EXPECT_LE(std::fabs(drift.turn_scale_error), 0.03);
  }
  EXPECT_LT(least, -0.02);
  EXPECT_GE(least, -0.03);
  EXPECT_GT(most, 0.02);
  EXPECT_LE(most, 0.03);
}

}  // namespace
}  // namespace topogeo::simulation
