#include "topogeo/matching/laser_odometry.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "topogeo/simulation/random_floors.hpp"
#include "topogeo/topomap/local_map_builder.hpp"

#include "laser_track.hpp"
#include "localization/hand_held.hpp"
#include "localization/hand_scenes.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;
using test::Followed;
using test::kDegree;

// The largest error of a step within an epoch, and of the last pose of the first epoch.
struct Errors {
  double step_m = 0.0;
  double step_rad = 0.0;
  double end_m = 0.0;
};

Errors errors_of(const Followed& followed) {
  const auto& [scans, truth] = followed.log;
  Errors errors;
  for (std::size_t i = 1; i < scans.size(); ++i) {
    if (scans[i].odometry_epoch != scans[i - 1].odometry_epoch) continue;
    const Eigen::Vector3d off =
        geometry::difference(geometry::between(scans[i - 1].T_odom_robot, scans[i].T_odom_robot),
                             geometry::between(truth[i - 1], truth[i]));
    errors.step_m = std::max(errors.step_m, off.head<2>().norm());
    errors.step_rad = std::max(errors.step_rad, std::fabs(off.z()));
    if (scans[i].odometry_epoch > 0) continue;
    errors.end_m = (scans[i].T_odom_robot.position_m() -
                    geometry::between(truth.front(), truth[i]).position_m())
                       .norm();
  }
  return errors;
}

TEST(LaserOdometryTest, FollowsAHandHeldLaserRoundAFloor) {
  const auto log = test::hand_held_drive(simulation::two_loops(1), test::hand_held_options(1));
  const Followed followed = test::follow(log);
  EXPECT_EQ(followed.log.scans.size(), log.scans.size());
  EXPECT_EQ(followed.counts.breaks, 0U);
  EXPECT_EQ(followed.counts.unplaced, 0U);
  const Errors errors = errors_of(followed);
  EXPECT_LT(errors.step_m, 0.06);
  EXPECT_LT(errors.step_rad, 2.0 * kDegree);
  EXPECT_LT(errors.end_m, 3.0);  // of more than 100 m
}

TEST(LaserOdometryTest, TakesOutTheMotionDuringAScanIfItKnowsTheTimesOfTheBeams) {
  const auto ticks = [] {
    return simulation::simulate_log(simulation::cyclic_floor(1), test::hand_held_options(1));
  };
  const Followed known = test::follow(test::skewed(ticks(), true));
  EXPECT_EQ(known.counts.breaks, 0U);
  EXPECT_LT(errors_of(known).step_m, 0.10);
  EXPECT_LT(errors_of(known).step_rad, 4.0 * kDegree);
  for (const scan::Scan& scan : known.log.scans) {
    EXPECT_EQ(scan.beam_step_s, 0.0) << "nobody takes it out again";
  }
  // A turn of 9 degrees during a scan bends the walls.
  const Followed unknown = test::follow(test::skewed(ticks(), false));
  EXPECT_LT(errors_of(known).end_m, 0.5 * errors_of(unknown).end_m);
}

TEST(LaserOdometryTest, NumbersThePlacedScansWithoutGaps) {
  auto log = test::hand_held_drive(simulation::cyclic_floor(2), test::hand_held_options(2));
  log.scans.resize(100);
  std::ranges::fill(log.scans[40].ranges_m, scan::Scan::kNoReturn);
  const Followed followed = test::follow(log);
  EXPECT_EQ(followed.counts.unplaced, 1U);
  ASSERT_EQ(followed.log.scans.size(), 99U);
  for (std::size_t i = 0; i < 99; ++i) EXPECT_EQ(followed.log.scans[i].sequence, i);
}

TEST(LaserOdometryTest, AHandOverTheLaserDoesNotBreakTheTrack) {
  simulation::SimulationOptions options = test::hand_held_options(3);
  options.blindings = {{{12.0, 12.7}, 0.15}};  // half a second
  const Followed followed =
      test::follow(test::hand_held_drive(simulation::cyclic_floor(3), options));
  EXPECT_EQ(followed.counts.breaks, 0U);
  EXPECT_GE(followed.counts.unplaced, 5U);
  EXPECT_LE(followed.counts.unplaced, 10U);
  EXPECT_LT(errors_of(followed).step_m, 0.15);  // over the gap too
}

TEST(LaserOdometryTest, ALostTrackBeginsAnotherEpoch) {
  simulation::SimulationOptions options = test::hand_held_options(4);
  options.kidnappings = {{30.0, 45.0}};
  const Followed followed = test::follow(test::hand_held_drive(simulation::two_loops(4), options));
  EXPECT_EQ(followed.counts.breaks, 1U);
  EXPECT_EQ(followed.log.scans.back().odometry_epoch, 1U);
  const auto first = std::ranges::find(followed.log.scans, 1U, &scan::Scan::odometry_epoch);
  EXPECT_EQ(first->T_odom_robot, Pose2{});
  EXPECT_LT(errors_of(followed).step_m, 0.06);  // none within an epoch crosses the jump
}

// A drive from one room through a bare corridor to another. The laser stands at first, then drives
// where it sees nothing that moves.
Followed through_corridor(double length_m) {
  const double end_m = 3.0 + length_m;
  world::World floor;
  for (const double side : {-1.0, 1.0}) {
    floor.segments.push_back({{3.0, side * 0.9}, {end_m, side * 0.9}});
    floor.segments.push_back({{3.0, side * 0.9}, {3.0, side * 2.0}});
    floor.segments.push_back({{end_m, side * 0.9}, {end_m, side * 2.5}});
    floor.segments.push_back({{0.0, side * 2.0}, {3.0, side * 2.0}});
    floor.segments.push_back({{end_m, side * 2.5}, {end_m + 3.0, side * 2.5}});
  }
  floor.segments.push_back({{0.0, -2.0}, {0.0, 2.0}});
  floor.segments.push_back({{end_m + 3.0, -2.5}, {end_m + 3.0, 2.5}});
  const simulation::BeamPattern beams{-std::numbers::pi, kDegree, 360, 2.5};
  support::Random random(5);
  simulation::SimulatedLog log;
  const int scans = static_cast<int>(end_m / 0.05);
  for (int tenth = 0; tenth < scans; ++tenth) {
    scan::Scan& scan = log.scans.emplace_back();
    scan.stamp_ns = 100'000'000LL * tenth;
    scan.angle_min_rad = beams.angle_min_rad;
    scan.angle_step_rad = beams.angle_step_rad;
    const Pose2 T{1.5 + 0.05 * tenth, 0.0, 0.0};
    scan.ranges_m = simulation::measure(simulation::raycast(floor, T, beams), {}, random);
    log.T_world_robot.push_back(T);
  }
  return test::follow(log);
}

TEST(LaserOdometryTest, ALongBareCorridorBeginsAnotherEpoch) {
  const Followed followed = through_corridor(16.0);
  EXPECT_EQ(followed.counts.breaks, 1U);
  EXPECT_GT(followed.counts.unseen, 150U);  // 10 m without an end in view
  EXPECT_EQ(followed.log.scans.back().odometry_epoch, 1U);
  EXPECT_LT(errors_of(followed).step_m, 0.06);
}

TEST(LaserOdometryTest, AShortBareCorridorKeepsItsScans) {
  const Followed followed = through_corridor(2.0);
  EXPECT_EQ(followed.counts.breaks, 0U);
  EXPECT_EQ(followed.counts.unseen, 0U);
  EXPECT_EQ(followed.counts.unplaced, 0U);
  EXPECT_LT(errors_of(followed).end_m, 0.3);
}

// Both ends of the corridor are out of range, so that only the prediction knows the way along it.
TEST(LaserTrackTest, AlongABareCorridorItIsAsUncertainAsThePrediction) {
  world::World corridor;
  corridor.segments = {{{-40.0, -0.9}, {40.0, -0.9}}, {{-40.0, 1.1}, {40.0, 1.1}}};
  const simulation::BeamPattern beams{-std::numbers::pi, kDegree, 360, 12.0};
  support::Random random(5);
  const auto seen_at = [&](int tenth) {
    scan::Scan scan;
    scan.angle_min_rad = beams.angle_min_rad;
    scan.angle_step_rad = beams.angle_step_rad;
    const Pose2 T{0.12 * tenth, 0.0, 0.02};
    scan.ranges_m = simulation::measure(simulation::raycast(corridor, T, beams), {}, random);
    const auto points = topomap::scan_points(scan, {}, 50.0);
    return TimedFeatures{100'000'000LL * tenth,
                         std::make_shared<const MatchFeatures>(extract_scan_features(points, {}))};
  };
  LaserTrack track(seen_at(0));
  for (int tenth = 1; tenth <= 20; ++tenth) {
    const std::optional<LaserStep> step = track.add(seen_at(tenth));
    ASSERT_TRUE(step) << tenth;
    EXPECT_GT(step->covariance(0, 0), 10.0 * step->covariance(1, 1)) << tenth;
    EXPECT_GT(std::sqrt(step->covariance(0, 0)), 0.05) << tenth;
    EXPECT_LT(std::sqrt(step->covariance(1, 1)), 0.03) << tenth;
  }
}

// A board of 20 cm to the side of a narrow view: a turn and a shift look nearly the same.
TEST(LaserTrackTest, KeepsACovarianceInANarrowView) {
  world::World board;
  board.segments = {{{2.0, 1.0}, {2.0, 1.2}}};
  const simulation::BeamPattern beams{0.4, 0.05 * kDegree, 200, 4.0};
  support::Random random(5);
  const auto seen_at = [&](int tenth) {
    scan::Scan scan;
    scan.angle_min_rad = beams.angle_min_rad;
    scan.angle_step_rad = beams.angle_step_rad;
    scan.ranges_m = simulation::measure(simulation::raycast(board, {}, beams), {}, random);
    const auto points = topomap::scan_points(scan, {}, 50.0);
    return TimedFeatures{100'000'000LL * tenth,
                         std::make_shared<const MatchFeatures>(extract_scan_features(points, {}))};
  };
  LaserTrack track(seen_at(0));
  int placed = 0;
  for (int tenth = 1; tenth <= 40; ++tenth) {
    const std::optional<LaserStep> step = track.add(seen_at(tenth));
    if (!step) continue;
    ++placed;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(step->covariance);
    ASSERT_GT(axes.eigenvalues().minCoeff(), 0.0) << tenth;
  }
  EXPECT_GE(placed, 3);
}

TEST(LaserTrackTest, WaitsForAScanThatShowsEnough) {
  const MatchFeatures nothing = extract_scan_features({}, {});
  EXPECT_FALSE(LaserTrack::can_begin(nothing));
  LaserOdometry odometry({}, 50.0);
  scan::Scan blind;
  blind.angle_step_rad = kDegree;
  blind.ranges_m.assign(180, scan::Scan::kNoReturn);
  odometry.add(blind);
  odometry.finish();
  EXPECT_TRUE(odometry.take().empty());
  EXPECT_EQ(odometry.counts().unplaced, 1U);
}

}  // namespace
}  // namespace topogeo::localization
