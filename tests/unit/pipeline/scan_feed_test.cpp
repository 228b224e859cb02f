#include "topogeo/pipeline/scan_feed.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "topogeo/pipeline/config.hpp"
#include "topogeo/pipeline/mapping_run.hpp"
#include "topogeo/pipeline/trajectory_error.hpp"
#include "topogeo/simulation/random_floors.hpp"
#include "topogeo/topomap/trajectory.hpp"

#include "localization/hand_held.hpp"

namespace topogeo::pipeline {
namespace {

using localization::LaserOdometry;
using localization::LaserOdometryCounts;
using localization::test::hand_held_drive;
using localization::test::hand_held_options;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

NextScan scans_of(const std::vector<scan::Scan>& scans) {
  return [&scans, next = std::size_t{0}]() mutable -> std::optional<scan::Scan> {
    if (next == scans.size()) return std::nullopt;
    return scans[next++];
  };
}

const simulation::SimulatedLog& drive() {
  static const simulation::SimulatedLog log =
      hand_held_drive(simulation::cyclic_floor(1), hand_held_options(1));
  return log;
}

TEST(ScanFeedTest, KeepsTheOdometryOfTheLog) {
  std::vector<scan::Scan> scans(3);
  for (std::size_t i = 0; i < 3; ++i)
    scans[i].T_odom_robot = {1.0 * static_cast<double>(i), 2.0, 0.5};
  ScanFeed feed(scans_of(scans));
  for (const scan::Scan& scan : scans) EXPECT_EQ(feed.next()->T_odom_robot, scan.T_odom_robot);
  EXPECT_FALSE(feed.next());
  EXPECT_EQ(feed.laser_counts(), nullptr);
}

TEST(ScanFeedTest, OdometryStandsOnlyIfNoPoseDiffers) {
  std::vector<scan::Scan> scans(3);
  for (scan::Scan& scan : scans) scan.T_odom_robot = {1.0, 2.0, 0.5};
  EXPECT_TRUE(odometry_stands(scans_of(scans)));
  scans.back().T_odom_robot.theta_rad = 0.52;
  EXPECT_FALSE(odometry_stands(scans_of(scans)));
}

TEST(ScanFeedTest, TheScansShowWhetherTheLaserMoves) {
  EXPECT_TRUE(laser_moves(scans_of(drive().scans), LaserOdometry({}, 50.0)));
  std::vector<scan::Scan> standing(50, drive().scans.front());
  for (std::size_t i = 0; i < standing.size(); ++i) {
    standing[i].stamp_ns = 100'000'000 * static_cast<std::int64_t>(i + 1);
  }
  EXPECT_FALSE(laser_moves(scans_of(standing), LaserOdometry({}, 50.0)));
}

TEST(ScanFeedTest, ALogOfAHandHeldLaserBecomesAMap) {
  ScanFeed feed(scans_of(drive().scans), LaserOdometry({}, 50.0));
  MappingRun run(Config{}, "robot");
  while (const std::optional<scan::Scan> scan = feed.next()) run.add(*scan);
  const storage::MapDocument map = run.finish();
  EXPECT_EQ(feed.laser_counts()->unplaced, 0U);
  EXPECT_THAT(too_sparse(*feed.laser_counts()), IsEmpty());
  std::vector<topomap::StampedPose> truth;
  for (std::size_t i = 0; i < drive().scans.size(); ++i) {
    truth.push_back({i, drive().scans[i].stamp_ns, drive().T_world_robot[i]});
  }
  const auto corrected = topomap::expand_trajectory(map.trajectory, map.local_maps);
  EXPECT_LT(trajectory_error(corrected, truth).rms_m, 0.10);
  EXPECT_FALSE(map.loop_closures.empty());
}

TEST(ScanFeedTest, SaysThatScansAreTooSparse) {
  LaserOdometryCounts counts;
  counts.scans = 100;
  counts.steps_m.assign(99, 0.3);
  EXPECT_THAT(too_sparse(counts), IsEmpty());
  counts.unplaced = 60;
  EXPECT_THAT(too_sparse(counts), HasSubstr("60 of 100 do not match"));
  counts.unplaced = 0;
  counts.unseen = 60;
  EXPECT_THAT(too_sparse(counts), HasSubstr("60 of 100 see only bare walls"));
  counts.unseen = 0;
  counts.steps_m.assign(99, 0.96);
  EXPECT_THAT(too_sparse(counts), HasSubstr("0.96 m apart, expected at most 0.8 m"));
}

TEST(ScanFeedTest, StandingScansDoNotCountAsSteps) {
  LaserOdometryCounts counts;
  counts.steps_m.assign(500, 0.001);
  EXPECT_EQ(usual_step_m(counts), 0.0);
  counts.steps_m.insert(counts.steps_m.end(), 9, 0.9);
  EXPECT_EQ(usual_step_m(counts), 0.9);
}

}  // namespace
}  // namespace topogeo::pipeline
