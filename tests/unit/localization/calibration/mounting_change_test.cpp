// A laser that is turned on its robot in the middle of a drive.
#include "topogeo/calibration/mounting_change.hpp"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "localization/laser_drives.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;
using test::kRound_m;

const Pose2 kAhead{0.15, 0.0, 0.0};
const Pose2 kBack{-0.2, 0.0, std::numbers::pi};

/// A drive to and fro along a corridor, with a turn each two or three metres.
const test::Points_m kWinding_m = {{1.3, 1.2}, {5.0, 1.2}, {3.0, 1.2},  {7.0, 1.2}, {5.0, 1.2},
                                   {9.0, 1.2}, {7.0, 1.2}, {11.0, 1.2}, {9.0, 1.2}, {13.0, 1.2}};

/// The first scans of one drive, then the others of another one on the same path.
std::vector<scan::Scan> joined(std::vector<scan::Scan> first,
                               const std::vector<scan::Scan>& second) {
  for (std::size_t i = first.size() / 2; i < first.size(); ++i) first[i] = second.at(i);
  return first;
}

std::optional<MountingChange> change_of(const std::vector<scan::Scan>& scans) {
  const std::vector<LaserMotion> motions = test::motions_of(scans);
  return find_mounting_change(motions, find_mounting(motions));
}

TEST(MountingChangeTest, FindsALaserThatIsTurnedRound) {
  const auto scans =
      joined(test::drive("floor", kRound_m, kAhead), test::drive("floor", kRound_m, kBack));
  const auto change = change_of(scans);
  ASSERT_TRUE(change);
  EXPECT_NEAR(change->before.T_robot_laser.theta_rad, 0.0, 0.1);
  EXPECT_NEAR(std::fabs(change->after.T_robot_laser.theta_rad), std::numbers::pi, 0.1);
  const std::int64_t turned_ns = scans[scans.size() / 2].stamp_ns;
  const std::int64_t drive_ns = scans.back().stamp_ns - scans.front().stamp_ns;
  EXPECT_NEAR(static_cast<double>(change->stamp_ns - turned_ns), 0.0,
              0.15 * static_cast<double>(drive_ns));
}

TEST(MountingChangeTest, FindsALaserThatIsTurnedUpsideDown) {
  std::vector<scan::Scan> mirrored = test::drive("floor", kWinding_m, kAhead);
  test::mirror(mirrored);
  const auto change = change_of(joined(test::drive("floor", kWinding_m, kAhead), mirrored));
  ASSERT_TRUE(change);
  EXPECT_FALSE(change->before.upside_down);
  EXPECT_TRUE(change->after.upside_down);
}

TEST(MountingChangeTest, ALaserThatStaysDoesNotChange) {
  EXPECT_FALSE(change_of(test::drive("floor", kRound_m, kBack)));
  EXPECT_FALSE(find_mounting_change({}, {}));
}

TEST(MountingChangeTest, AHeadingOfOdometryThatBeginsAnewIsNoChange) {
  std::vector<scan::Scan> scans = test::drive("floor", kRound_m, kAhead);
  for (std::size_t i = scans.size() / 2; i < scans.size(); ++i) {
    double& heading_rad = scans[i].T_odom_robot.theta_rad;
    heading_rad = geometry::wrap_angle(heading_rad - 1.2);
  }
  EXPECT_FALSE(change_of(scans));
}

TEST(MountingChangeTest, OdometryThatIsWrongForAWhileIsNoChange) {
  std::vector<scan::Scan> scans = test::drive("floor", kRound_m, kAhead);
  // Stretches without a mounting that explains them decide for none.
  for (std::size_t i = scans.size() / 3; i < 2 * scans.size() / 3; ++i) {
    const double way = static_cast<double>(i);
    scans[i].T_odom_robot = {3.0 * std::sin(0.07 * way), 0.2 * std::cos(0.31 * way),
                             std::sin(0.11 * way)};
  }
  EXPECT_FALSE(change_of(scans));
}

}  // namespace
}  // namespace topogeo::localization
