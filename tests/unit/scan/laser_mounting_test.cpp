// The mounting of the laser, from the two poses of each line of a log.
#include "topogeo/scan/laser_mounting.hpp"

#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "topogeo/scan/carmen_log_writer.hpp"

#include "log_files.hpp"

namespace topogeo::scan {
namespace {

using geometry::Pose2;

/// Pose at the i-th scan of a robot that drives in circles.
Pose2 on_circle(int i) {
  const double turn_rad = 0.1 * i;
  return {3.0 * std::cos(turn_rad), 3.0 * std::sin(turn_rad), geometry::wrap_angle(turn_rad)};
}

std::string pose_text(const Pose2& pose, int digits) {
  std::ostringstream text;
  text << std::fixed;
  text.precision(digits);
  text << ' ' << pose.x_m << ' ' << pose.y_m << ' ' << pose.theta_rad;
  return text.str();
}

/// A log of `count` scans on the circle whose first poses are `laser(i)`.
std::string circle_log(int count, const std::function<Pose2(int)>& laser, int digits = 6) {
  std::string text;
  for (int i = 0; i < count; ++i) {
    text += "FLASER 2 1.00 2.00" + pose_text(laser(i), digits) + pose_text(on_circle(i), digits) +
            " " + std::to_string(i + 1) + ".0 host 1.0\n";
  }
  return text;
}

/// The same with this mounting of the laser.
std::string circle_log(int count, const Pose2& T_robot_laser, int digits = 6) {
  return circle_log(
      count, [&](int i) { return on_circle(i) * T_robot_laser; }, digits);
}

TEST_F(LogFiles, OnePoseGivenTwicePutsTheLaserAtTheRobotsPoint) {
  const auto mounting = mounting_in_log(plain(circle_log(50, Pose2{})));
  ASSERT_TRUE(mounting);
  EXPECT_EQ(*mounting, Pose2{});
  EXPECT_FALSE(std::signbit(mounting->x_m) || std::signbit(mounting->y_m) ||
               std::signbit(mounting->theta_rad));
}

TEST_F(LogFiles, TheMountingIsFoundWithoutTheNoiseOfTheLastDigits) {
  for (const Pose2& mounting :
       {Pose2{0.25, 0.0, 0.0}, Pose2{0.895, -0.1, 0.3}, Pose2{-0.2, 0.0, 3.14159}}) {
    for (const int digits : {6, 9, 15}) {
      EXPECT_EQ(mounting_in_log(gzip(circle_log(200, mounting, digits))), mounting) << digits;
    }
  }
}

TEST_F(LogFiles, TwoDigitsAreEnough) {
  const auto mounting = mounting_in_log(plain(circle_log(400, {0.4, 0.1, 0.0}, 2)));
  ASSERT_TRUE(mounting);
  EXPECT_NEAR(mounting->x_m, 0.4, 0.003);
  EXPECT_NEAR(mounting->y_m, 0.1, 0.003);
  EXPECT_NEAR(mounting->theta_rad, 0.0, 0.003);
}

TEST_F(LogFiles, FewDeviatingPosesDoNotMatter) {
  const auto log_with = [&](int each) {
    return plain(circle_log(200, [each](int i) {
      return i % each == 0 ? Pose2{100.0, -7.0, 2.0} : on_circle(i) * Pose2{0.4, 0.0, 0.0};
    }));
  };
  EXPECT_EQ(mounting_in_log(log_with(20)), (Pose2{0.4, 0.0, 0.0}));
  EXPECT_FALSE(mounting_in_log(log_with(5)));
}

TEST_F(LogFiles, DamagedLinesAndDamagedPosesAreLeftOut) {
  const std::string good = circle_log(60, {0.4, 0.0, 0.0});
  const std::string damaged = "FLASER 2 1 2 nan 0 0 1 1 1 1.0 h 1.0\nFLASER 9 1 2\nROBOTLASER1\n";
  EXPECT_EQ(mounting_in_log(plain(damaged + good + damaged)), (Pose2{0.4, 0.0, 0.0}));
}

TEST_F(LogFiles, PosesThatDifferByNoConstantStateNothing) {
  // The first pose is from a trajectory in another frame, then from one that drifts away.
  const Pose2 T_map_odom{1.0, 2.0, 0.4};
  EXPECT_FALSE(
      mounting_in_log(plain(circle_log(100, [&](int i) { return T_map_odom * on_circle(i); }))));
  EXPECT_FALSE(mounting_in_log(plain(circle_log(100, [](int i) {
    return Pose2{0.01 * i, 0.0, 0.001 * i} * on_circle(i);
  }))));
  EXPECT_FALSE(mounting_in_log(plain(circle_log(100, [](int) { return Pose2{}; }))));
}

/// A log of a drive along squares of 3 m with turns at their corners. The poses of the laser are
/// true, odometry has its own frame and lengths, and drifts to one side.
std::string corrected_log(const Pose2& T_robot_laser, double length) {
  std::string text;
  Pose2 T_map_robot;
  Pose2 T_odom_robot{5.0, 1.0, 0.8};
  for (int i = 0; i < 200; ++i) {
    const bool turns = i % 20 >= 15;
    T_map_robot = T_map_robot * (turns ? Pose2{0.0, 0.0, 0.3} : Pose2{0.2, 0.0, 0.0});
    T_odom_robot =
        T_odom_robot * (turns ? Pose2{0.0, 0.0, 0.301} : Pose2{0.2 * length, 0.0, 0.001});
    text += "FLASER 2 1.00 2.00" + pose_text(T_map_robot * T_robot_laser, 6) +
            pose_text(T_odom_robot, 6) + " " + std::to_string(i + 1) + ".0 host 1.0\n";
  }
  return text;
}

TEST_F(LogFiles, ACorrectedTrajectoryOfTheLaserStatesTheMountingByItsMotions) {
  for (const Pose2& T_robot_laser : {Pose2{0.15, 0.0, 0.0}, Pose2{-0.2, 0.1, 3.14159}}) {
    const auto mounting = mounting_in_log(plain(corrected_log(T_robot_laser, 1.03)));
    ASSERT_TRUE(mounting);
    const Eigen::Vector3d apart = difference(*mounting, T_robot_laser);
    EXPECT_LT(apart.head<2>().norm(), 0.01);
    EXPECT_NEAR(apart.z(), 0.0, 0.01);
  }
  EXPECT_FALSE(mounting_in_log(plain(corrected_log({}, 1.03)))) << "nothing to correct";
  EXPECT_FALSE(mounting_in_log(plain(corrected_log({0.15, 0.0, 0.0}, 2.0)))) << "another robot";
}

TEST_F(LogFiles, ARobotThatStandsStatesNothing) {
  std::string log;
  for (int i = 0; i < 300; ++i) log += "FLASER 2 1 2 1.5 2 0 1 1 0 " + std::to_string(i) + " h 1\n";
  EXPECT_FALSE(mounting_in_log(plain(log)));
  EXPECT_FALSE(mounting_in_log(plain(circle_log(9, {0.4, 0.0, 0.0}))));
  EXPECT_FALSE(mounting_in_log(plain("# no laser line\n")));
  EXPECT_THROW((void)mounting_in_log(path("none.clf")), std::runtime_error);
}

TEST_F(LogFiles, NoRobotIsTenMetresLong) {
  EXPECT_FALSE(mounting_in_log(plain(circle_log(100, {5.2, 0.0, 0.0}))));
}

TEST_F(LogFiles, WrittenLogsStateTheMountingAndKeepTheOdometry) {
  const Pose2 mounting{0.1234, -0.05, 1.5708};
  for (const std::size_t beams : {180U, 100U}) {  // the latter become ROBOTLASER1 lines
    std::vector<Scan> written;
    CarmenLogWriter writer(path("w.clf"), mounting);
    for (int i = 0; i < 40; ++i) {
      Scan scan;
      scan.stamp_ns = 1'000'000'000 * std::int64_t{i};
      scan.angle_min_rad = -std::numbers::pi / 2.0;
      scan.angle_step_rad = std::numbers::pi / 180.0;
      scan.ranges_m.assign(beams, 2.0F);
      scan.ranges_m.front() += 0.01F * static_cast<float>(i);
      scan.T_odom_robot = on_circle(i);
      writer.write(scan);
      written.push_back(scan);
    }
    writer.close();
    EXPECT_EQ(mounting_in_log(path("w.clf")), mounting) << beams;
    CarmenLogReader reader(path("w.clf"));
    const std::vector<Scan> scans = read_all(reader);
    ASSERT_EQ(scans.size(), written.size());
    for (std::size_t i = 0; i < scans.size(); ++i) {
      EXPECT_EQ(scans[i].T_odom_robot, written[i].T_odom_robot);
    }
  }
}

}  // namespace
}  // namespace topogeo::scan
