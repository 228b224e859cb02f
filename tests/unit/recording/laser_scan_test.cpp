#include "topogeo/recording/laser_scan.hpp"

#include <limits>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "topogeo/recording/transform_tree.hpp"

namespace topogeo::recording {
namespace {

using testing::ElementsAre;
constexpr double kPi = std::numbers::pi;
constexpr double kLimit_m = 50.0;

/// Beams at -0.5, 0, 0.5 and 1 rad.
ros::LaserScan four_beams() {
  ros::LaserScan scan;
  scan.angle_min_(-0.5F);
  scan.angle_increment_(0.5F);
  scan.range_min_(0.1F);
  scan.range_max_(10.0F);
  scan.ranges_({1.0F, 2.0F, 3.0F, 4.0F});
  return scan;
}

ros::TransformStamped stated(const char* parent, const char* child, double x,
                             const Eigen::Quaterniond& q) {
  ros::TransformStamped transform;
  transform.header_().frame_id_(parent);
  transform.child_frame_id_(child);
  transform.transform_().translation_().x_(x);
  transform.transform_().rotation_().x_(q.x());
  transform.transform_().rotation_().y_(q.y());
  transform.transform_().rotation_().z_(q.z());
  transform.transform_().rotation_().w_(q.w());
  return transform;
}

Eigen::Quaterniond about(const Eigen::Vector3d& axis, double angle_rad) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle_rad, axis));
}

TEST(LaserScan, BeamsGoCounterClockwise) {
  const scan::Scan scan = to_scan(four_beams(), false, kLimit_m);
  EXPECT_DOUBLE_EQ(scan.angle_min_rad, -0.5);
  EXPECT_DOUBLE_EQ(scan.angle_step_rad, 0.5);
  EXPECT_THAT(scan.ranges_m, ElementsAre(1.0F, 2.0F, 3.0F, 4.0F));
}

TEST(LaserScan, OfAClockwiseScannerIsTurnedRound) {
  ros::LaserScan message = four_beams();
  message.angle_min_(1.0F);
  message.angle_increment_(-0.5F);
  const scan::Scan scan = to_scan(message, false, kLimit_m);
  EXPECT_DOUBLE_EQ(scan.angle_min_rad, -0.5);
  EXPECT_DOUBLE_EQ(scan.angle_step_rad, 0.5);
  EXPECT_THAT(scan.ranges_m, ElementsAre(4.0F, 3.0F, 2.0F, 1.0F));
}

// Each beam's end must be where the transform in space takes it.
TEST(LaserScan, OfALaserUpsideDownIsMirrored) {
  const Eigen::Isometry3d T_robot_laser =
      Eigen::Translation3d(0.3, 0.1, 0.4) * about({0, 0, 1}, 0.7) * about({1, 0, 0}, kPi);
  const LaserMounting mounting = planar_mounting(T_robot_laser);
  EXPECT_TRUE(mounting.upside_down);
  EXPECT_NEAR(mounting.T_robot_laser.theta_rad, 0.7, 1e-9);
  const ros::LaserScan message = four_beams();
  const scan::Scan scan = to_scan(message, mounting.upside_down, kLimit_m);
  for (std::size_t i = 0; i < 4; ++i) {
    const double angle = -0.5 + 0.5 * static_cast<double>(i);
    const double range = message.ranges_()[i];
    const Eigen::Vector3d end =
        T_robot_laser * Eigen::Vector3d(range * std::cos(angle), range * std::sin(angle), 0.0);
    const std::size_t beam = 3 - i;
    ASSERT_EQ(scan.ranges_m[beam], message.ranges_()[i]);
    const double ours = scan.angle_min_rad + static_cast<double>(beam) * scan.angle_step_rad;
    const Eigen::Vector2d our_end =
        mounting.T_robot_laser * Eigen::Vector2d(range * std::cos(ours), range * std::sin(ours));
    EXPECT_NEAR(our_end.x(), end.x(), 1e-6);
    EXPECT_NEAR(our_end.y(), end.y(), 1e-6);
  }
}

TEST(LaserScan, HasNoReturnsOutsideItsLimits) {
  constexpr float kInf = std::numeric_limits<float>::infinity();
  ros::LaserScan message = four_beams();
  message.ranges_({0.0F, 0.05F, 0.1F, 9.9F, 10.0F, kInf, -kInf,
                   std::numeric_limits<float>::quiet_NaN(), -1.0F});
  EXPECT_THAT(to_scan(message, false, kLimit_m).ranges_m,
              ElementsAre(0.0F, 0.0F, 0.1F, 9.9F, 0.0F, 0.0F, 0.0F, 0.0F, 0.0F));
  message.range_max_(0.0F);  // a driver that does not say it
  EXPECT_THAT(to_scan(message, false, 9.95).ranges_m,
              ElementsAre(0.0F, 0.0F, 0.1F, 9.9F, 0.0F, 0.0F, 0.0F, 0.0F, 0.0F));
}

TEST(LaserScan, OfTooManyBeamsKeepsEveryOther) {
  ros::LaserScan message = four_beams();
  message.angle_increment_(0.001F);
  message.ranges_().assign(3000, 1.0F);
  message.ranges_()[2] = 2.0F;
  const scan::Scan scan = to_scan(message, false, kLimit_m);
  EXPECT_EQ(scan.ranges_m.size(), 1500U);
  EXPECT_EQ(scan.ranges_m[1], 2.0F);
  EXPECT_NEAR(scan.angle_step_rad, 0.002, 1e-9);
}

TEST(LaserScan, IsRefusedWithAnglesOfNoLaser) {
  for (const float step : {0.0F, 7.0F, std::numeric_limits<float>::quiet_NaN()}) {
    ros::LaserScan message = four_beams();
    message.angle_increment_(step);
    EXPECT_THROW((void)to_scan(message, false, kLimit_m), std::invalid_argument);
  }
  ros::LaserScan message = four_beams();
  message.ranges_({1.0F});
  EXPECT_THROW((void)to_scan(message, false, kLimit_m), std::invalid_argument);
}

TEST(PlanarPose, IsSeenFromAbove) {
  ros::Pose pose;
  pose.position_().x_(1.0);
  EXPECT_FALSE(planar_pose(pose));  // a quaternion of no length
  const Eigen::Quaterniond q = about({0, 0, 1}, 2.5) * about({0, 1, 0}, 0.05);
  pose.orientation_().x_(3.0 * q.x());
  pose.orientation_().y_(3.0 * q.y());
  pose.orientation_().z_(3.0 * q.z());
  pose.orientation_().w_(3.0 * q.w());
  ASSERT_TRUE(planar_pose(pose));
  EXPECT_NEAR(planar_pose(pose)->theta_rad, 2.5, 1e-12);
}

TEST(TransformTree, FindsTheWayBetweenFrames) {
  ros::TfMessage fixed;
  fixed.transforms_() = {stated("/base_link", "plate", 1.0, about({0, 0, 1}, kPi / 2.0)),
                         stated("plate", "laser", 2.0, about({0, 0, 1}, 0.0))};
  TransformTree tree;
  tree.add(fixed, true);
  ros::TfMessage moving;
  moving.transforms_() = {stated("odom", "base_link", 5.0, about({0, 0, 1}, 0.0)),
                          stated("odom", "base_footprint", 4.0, about({0, 0, 1}, 0.0))};
  tree.add(moving, false);
  const auto T_base_laser = tree.find("base_link", "laser");
  ASSERT_TRUE(T_base_laser);
  EXPECT_TRUE(T_base_laser->translation().isApprox(Eigen::Vector3d(1.0, 2.0, 0.0)));
  const auto T_footprint_laser = tree.find("base_footprint", "laser");
  ASSERT_TRUE(T_footprint_laser);
  EXPECT_TRUE(T_footprint_laser->translation().isApprox(Eigen::Vector3d(2.0, 2.0, 0.0)));
  EXPECT_FALSE(tree.find("base_link", "camera"));
}

}  // namespace
}  // namespace topogeo::recording
