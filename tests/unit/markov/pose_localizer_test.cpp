#include "topogeo/markov/pose_localizer.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "topogeo/scan/scan.hpp"
#include "topogeo/support/random.hpp"

#include "drawn_map.hpp"

namespace topogeo::markov::test {
namespace {

TEST(ConeRangesTable, AgreesWithRaysToTheWallsOfARoom) {
  const Room room{40, 30};
  const ObstacleCells cells = room.cells();
  ConeRanges ranges(cells, 15.0 * std::numbers::pi / 180.0, 5.0);
  support::Random random(3);
  for (int i = 0; i < 300; ++i) {
    // At the centre of a square, along a bearing of the table.
    const auto bearing = static_cast<double>(random.below(ConeRanges::kBearings));
    const geometry::Pose2 at{0.425 + 0.05 * static_cast<double>(random.below(68)),
                             0.425 + 0.05 * static_cast<double>(random.below(48)),
                             bearing * 2.0 * std::numbers::pi / ConeRanges::kBearings};
    const double exact_m =
        room.measured(at, {RangeSensor{{}, 15.0 * std::numbers::pi / 180.0}}).front();
    // The table's range ends halfway through the wall cell, not at its face.
    const double behind_m = ranges.range_m(at.position_m(), at.theta_rad) - exact_m;
    EXPECT_GT(behind_m, -0.002) << i;
    EXPECT_LT(behind_m, 0.075) << i;
  }
  EXPECT_LE(ranges.tables(), 300U);
}

TEST(ConeRangesTable, NothingInRangeIsTheLargestAndAnObstacleIsZero) {
  const ObstacleCells open = open_space(100, 100);
  ConeRanges ranges(open, 0.2, 3.0);
  EXPECT_DOUBLE_EQ(ranges.range_m({5.0, 5.0}, 1.0), 3.0);
  EXPECT_DOUBLE_EQ(ranges.range_m({-2.0, 5.0}, 1.0), 3.0);
  const ObstacleCells full = drawn({"###", "###", "###"});
  EXPECT_DOUBLE_EQ(ConeRanges(full, 0.2, 3.0).range_m({0.15, 0.15}, 0.0), 0.0);
  EXPECT_THROW(ConeRanges(open, 0.2, 0.0), std::invalid_argument);
}

TEST(PoseGridTest, DrivingMovesWhatHasAnotherHeadingAside) {
  PoseGrid grid(21, 0.05, 21, 0.05);
  grid.values()[grid.index(10, 10, 14)] = 1.0;  // 0.2 rad to the left
  grid.drive({1.0, 0.0});
  const PoseGrid::Moments moments = grid.moments();
  EXPECT_NEAR(moments.mean.x(), std::cos(0.2) - 1.0, 1e-9);
  EXPECT_NEAR(moments.mean.y(), std::sin(0.2), 1e-9);
  EXPECT_NEAR(moments.mean.z(), 0.2, 1e-9);
}

TEST(PoseGridTest, BlurAddsItsVarianceAndShiftMovesTheMean) {
  PoseGrid grid(61, 0.05, 41, 0.05);
  grid.set_normal(0.1, 0.1);
  grid.blur(0.02, 0.15);
  const PoseGrid::Moments wide = grid.moments();
  EXPECT_NEAR(wide.covariance(0, 0), 0.1 * 0.1 + 0.02 * 0.02, 4e-4);
  EXPECT_NEAR(wide.covariance(1, 1), 0.1 * 0.1 + 0.02 * 0.02, 4e-4);
  EXPECT_NEAR(wide.covariance(2, 2), 0.1 * 0.1 + 0.15 * 0.15, 2e-3);
  grid.shift(3, -2, 1);
  ASSERT_TRUE(grid.normalize());
  EXPECT_NEAR(grid.moments().mean.x(), 0.15, 1e-3);
  EXPECT_NEAR(grid.moments().mean.y(), -0.10, 1e-3);
  EXPECT_NEAR(grid.moments().mean.z(), 0.05, 1e-3);
  grid.shift(61, 0, 0);
  EXPECT_FALSE(grid.normalize());
}

/// A robot with noisy odometry in a room of 4 x 3 m; it reads the walls exactly.
class PoseLocalizerTest : public testing::Test {
 protected:
  void drive(const geometry::Pose2& step, const geometry::Pose2& measured) {
    truth = truth * step;
    localizer.move(measured);
    localizer.perceive(room.measured(truth, macondo_ring()));
  }

  [[nodiscard]] double off_m() const {
    return (localizer.estimate().T_map_robot.position_m() - truth.position_m()).norm();
  }
  [[nodiscard]] double off_rad() const {
    return std::fabs(
        geometry::wrap_angle(localizer.estimate().T_map_robot.theta_rad - truth.theta_rad));
  }

  Room room{40, 30};
  geometry::Pose2 truth{1.0, 1.1, 0.0};
  PoseLocalizer localizer{PoseGridConfig{}, room.cells(), macondo_ring(), 5.0, {1.05, 1.05, 0.03}};
};

TEST_F(PoseLocalizerTest, FindsHeadingAndPlaceFromWheelsThatErr) {
  for (int round = 0; round < 3; ++round) {
    for (int i = 0; i < 18; ++i) drive({0.1, 0.0, 0.0}, {0.095, 0.0, 0.02});
    for (int i = 0; i < 16; ++i) {
      const double turn_rad = std::numbers::pi / 16.0;
      drive({0.0, 0.0, turn_rad}, {0.0, 0.0, 0.9 * turn_rad});
    }
  }
  EXPECT_LT(off_m(), 0.08);
  EXPECT_LT(off_rad(), 0.12);
  EXPECT_TRUE(localizer.located());
  EXPECT_GT(localizer.agreement(), 0.7);
}

TEST_F(PoseLocalizerTest, OdometryAloneWouldBeLostThere) {
  geometry::Pose2 odometry{1.05, 1.05, 0.03};
  for (int round = 0; round < 3; ++round) {
    for (int i = 0; i < 18; ++i) odometry = odometry * geometry::Pose2{0.095, 0.0, 0.02};
    odometry = odometry * geometry::Pose2{0.0, 0.0, 0.9 * std::numbers::pi};
  }
  const geometry::Pose2 ends{2.8, 1.1, std::numbers::pi};
  EXPECT_GT((odometry.position_m() - ends.position_m()).norm(), 0.3);
}

TEST_F(PoseLocalizerTest, ReadingsThatNeverAgreeLoseThePose) {
  const std::vector<float> nonsense(6, 0.3F);
  for (int i = 0; i < 40 && localizer.located(); ++i) localizer.perceive(nonsense);
  EXPECT_FALSE(localizer.located());
  EXPECT_NE(localizer.reason().find("% of the readings agree"), std::string::npos);
}

TEST_F(PoseLocalizerTest, ReadingsWithoutEchoTellNothing) {
  const PoseEstimate before = localizer.estimate();
  localizer.perceive(std::vector<float>(6, scan::Scan::kNoReturn));
  EXPECT_NEAR(localizer.estimate().T_map_robot.x_m, before.T_map_robot.x_m, 1e-9);
  EXPECT_NEAR(localizer.estimate().covariance(0, 0), before.covariance(0, 0), 1e-9);
  EXPECT_THROW(localizer.perceive(std::vector<float>(5, 1.0F)), std::invalid_argument);
  EXPECT_THROW(localizer.perceive(std::vector<float>(6, -1.0F)), std::invalid_argument);
}

/// RMS error along x of several robots with a wall 4 m ahead as their only clue: one of four
/// readings is exact and three are off by up to 0.3 m.
double off_by_far_readings_m(double far_off_share) {
  constexpr int kRobots = 6;
  const Room hall{60, 60};
  const geometry::Pose2 truth{2.05, 3.05, 0.0};
  const std::vector<RangeSensor> ahead{{{}, 15.0 * std::numbers::pi / 180.0}};
  // The map has the wall in the middle of its cell.
  const float exact_m = hall.measured(truth, ahead).front() + 0.05F;
  PoseGridConfig config;
  config.station_sigma_m = 0.2;
  config.window_m = 1.1;
  config.heading_window_rad = 0.2;
  config.far_off_share = far_off_share;
  support::Random random(1);
  double squares_m2 = 0.0;
  for (int robot = 0; robot < kRobots; ++robot) {
    PoseLocalizer localizer(config, hall.cells(), ahead, 5.0, truth);
    for (int i = 0; i < 12; ++i) {
      const auto off_m = static_cast<float>(i % 4 == 0 ? 0.0 : random.uniform(-0.3, 0.3));
      localizer.perceive(std::vector<float>{exact_m + off_m});
    }
    const double error_m = localizer.estimate().T_map_robot.x_m - truth.x_m;
    squares_m2 += error_m * error_m;
  }
  return std::sqrt(squares_m2 / kRobots);
}

TEST(PoseLocalizerFar, TheExactOnesOfFarReadingsTellMoreThanTheirMean) {
  const double mixed_m = off_by_far_readings_m(0.75);
  EXPECT_LT(mixed_m, 0.05);
  EXPECT_LT(mixed_m, 0.75 * off_by_far_readings_m(1.0));
}

TEST(PoseLocalizerStart, AStationInAWallIsNamed) {
  const PoseLocalizer localizer(PoseGridConfig{}, Room{40, 30}.cells(), macondo_ring(), 5.0,
                                {0.02, 1.0, 0.0});
  EXPECT_FALSE(localizer.located());
  EXPECT_NE(localizer.reason().find("not in a free cell"), std::string::npos);
}

TEST(PoseLocalizerStart, SettingsThatDoNotFitAreRefused) {
  PoseGridConfig config;
  config.cell_m = 0.02;
  config.window_m = 5.0;
  EXPECT_THROW(check(config), std::invalid_argument);
  config = {};
  config.hit_share = 0.9;
  config.short_share = 0.3;
  EXPECT_THROW(check(config), std::invalid_argument);
}

}  // namespace
}  // namespace topogeo::markov::test
