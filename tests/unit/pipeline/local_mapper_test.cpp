#include "topogeo/pipeline/local_mapper.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "topogeo/simulation/laser.hpp"
#include "topogeo/world/world.hpp"

namespace topogeo::pipeline {
namespace {

using geometry::Pose2;

/// Noise-free scans of a room of 8 x 6 m with a column, taken at world poses; the odometry is the
/// truth.
class LocalMapperTest : public testing::Test {
 protected:
  scan::Scan scan_at(const Pose2& T_world_robot) {
    const simulation::BeamPattern beams;
    scan::Scan scan;
    scan.sequence = next_++;
    scan.stamp_ns = static_cast<std::int64_t>(scan.sequence) * 100'000'000;
    scan.angle_min_rad = beams.angle_min_rad;
    scan.angle_step_rad = beams.angle_step_rad;
    for (const double range_m : raycast(world_, T_world_robot, beams)) {
      scan.ranges_m.push_back(std::isfinite(range_m) ? static_cast<float>(range_m)
                                                     : scan::Scan::kNoReturn);
    }
    scan.T_odom_robot = T_world_robot;
    return scan;
  }

  /// Sequence numbers of the scans that became stops.
  std::vector<std::uint64_t> stops(LocalMapper& mapper, const std::vector<Pose2>& poses) {
    std::vector<std::uint64_t> result;
    for (const Pose2& pose : poses) {
      if (const auto map = mapper.add(scan_at(pose))) result.push_back(map->sequence);
    }
    return result;
  }

  world::World world_ = world::parse_world(
      "walls:\n"
      "  - {from: [0, 0], to: [8, 0]}\n"
      "  - {from: [8, 0], to: [8, 6]}\n"
      "  - {from: [8, 6], to: [0, 6]}\n"
      "  - {from: [0, 6], to: [0, 0]}\n"
      "boxes: [{from: [6, 4], to: [7, 5]}, {from: [5, 0.5], to: [6, 1]}]\n",
      "room");
  std::uint64_t next_ = 0;
};

TEST_F(LocalMapperTest, StopsByDistance) {
  LocalMapper mapper({}, "r");
  // Steps of 0.25 m: the path and half a step more reach 1 m at the fourth.
  std::vector<Pose2> poses;
  for (int i = 0; i <= 8; ++i) poses.push_back({2.0 + 0.25 * i, 3.0, 0.0});
  EXPECT_EQ(stops(mapper, poses), (std::vector<std::uint64_t>{0, 4, 8}));
}

TEST_F(LocalMapperTest, StopsByTurn) {
  LocalMapper mapper({}, "r");
  // Steps of 0.11 rad: 0.33 and half a step reach 0.35 at the third.
  std::vector<Pose2> poses;
  for (int i = 0; i <= 4; ++i) poses.push_back({3.0, 3.0, 0.11 * i});
  EXPECT_EQ(stops(mapper, poses), (std::vector<std::uint64_t>{0, 3}));
}

TEST_F(LocalMapperTest, ARobotThatStandsMakesNoStop) {
  LocalMapperConfig config;
  config.longest_track = 5;
  LocalMapper mapper(config, "r");
  const std::vector<Pose2> standing(1000, Pose2{3.0, 3.0, 0.0});
  EXPECT_EQ(stops(mapper, standing), (std::vector<std::uint64_t>{0}));
  ASSERT_NE(mapper.last_tracked(), nullptr);
  EXPECT_EQ(mapper.last_tracked()->sequence, 999U);

  const auto next = mapper.finish();
  ASSERT_TRUE(next);
  EXPECT_EQ(next->sequence, 999U);
  EXPECT_LE(next->track.size(), 5U);
}

TEST_F(LocalMapperTest, OdometryThatGoesOnMakesAStopWhereTheScansStandStill) {
  LocalMapper mapper({}, "r");
  // Wheels that spin in steps of 0.1 m: half as far again as between stops is 1.5 m.
  std::vector<std::uint64_t> stops;
  for (int i = 0; i <= 31; ++i) {
    scan::Scan scan = scan_at({3.0, 3.0, 0.0});
    scan.T_odom_robot.x_m += 0.1 * i + 1e-9;
    if (const auto map = mapper.add(scan)) stops.push_back(map->sequence);
  }
  EXPECT_EQ(stops, (std::vector<std::uint64_t>{0, 15, 30}));
}

TEST(BoundedTrack, KeepsEvenlySpreadScansAndTheLast) {
  BoundedTrack track(4);
  const auto sequences_after = [&track](std::uint64_t scans) {
    for (std::uint64_t i = 1; i <= scans; ++i) {
      topomap::TrackedScan scan;
      scan.sequence = i;
      track.add(scan);
    }
    std::vector<std::uint64_t> out;
    for (const topomap::TrackedScan& scan : track.take()) out.push_back(scan.sequence);
    return out;
  };
  using Sequences = std::vector<std::uint64_t>;
  EXPECT_EQ(sequences_after(4), (Sequences{1, 2, 3, 4}));
  EXPECT_EQ(sequences_after(5), (Sequences{1, 3, 5}));
  EXPECT_EQ(sequences_after(6), (Sequences{1, 3, 5, 6}));
  EXPECT_EQ(sequences_after(7), (Sequences{1, 3, 5, 7}));
  EXPECT_EQ(sequences_after(8), (Sequences{1, 5, 8}));
  EXPECT_EQ(sequences_after(9), (Sequences{1, 5, 9}));
  EXPECT_EQ(sequences_after(1000), (Sequences{1, 513, 1000}));
  EXPECT_TRUE(track.empty());
}

TEST_F(LocalMapperTest, MapCarriesTheScansSinceTheStopBefore) {
  LocalMapper mapper({}, "robot7");
  ASSERT_TRUE(mapper.add(scan_at({2.0, 3.0, 0.0})));
  std::optional<topomap::LocalMap> map;
  for (int i = 1; i <= 4 && !map; ++i) map = mapper.add(scan_at({2.0 + 0.25 * i, 3.0, 0.0}));
  ASSERT_TRUE(map);
  EXPECT_EQ(map->robot_id, "robot7");
  EXPECT_EQ(map->id, 1U);
  ASSERT_EQ(map->track.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    const topomap::TrackedScan& tracked = map->track[i];
    EXPECT_EQ(tracked.sequence, i + 1);
    EXPECT_TRUE(tracked.matched);
    EXPECT_NEAR(tracked.T_stop_robot.x_m, 0.25 * static_cast<double>(i + 1), 0.01);
    EXPECT_NEAR(tracked.T_stop_robot.y_m, 0.0, 0.01);
  }
  EXPECT_NEAR(map->T_previous_robot.x_m, 1.0, 0.01);
  EXPECT_FALSE(map->nodes.empty());
  EXPECT_FALSE(map->points.empty());
}

TEST_F(LocalMapperTest, FinishMakesAStopOfTheLastScanOnce) {
  LocalMapper mapper({}, "r");
  EXPECT_FALSE(mapper.finish()) << "there was no scan";
  ASSERT_TRUE(mapper.add(scan_at({2.0, 3.0, 0.0})));
  EXPECT_FALSE(mapper.finish()) << "the last scan is a stop already";
  ASSERT_FALSE(mapper.add(scan_at({2.2, 3.0, 0.0})));
  ASSERT_FALSE(mapper.add(scan_at({2.4, 3.0, 0.0})));

  const auto last = mapper.finish();
  ASSERT_TRUE(last);
  EXPECT_EQ(last->sequence, 2U);
  ASSERT_EQ(last->track.size(), 1U) << "the stop itself is no part of its track";
  EXPECT_EQ(last->track[0].sequence, 1U);
  EXPECT_NEAR(last->T_previous_robot.x_m, 0.4, 0.01);
  EXPECT_FALSE(mapper.finish());
}

// --- sessions and epochs of the odometry

TEST_F(LocalMapperTest, ASessionHasTheSameNumberEachTimeAndWithSaltAnother) {
  const scan::Scan scan = scan_at({2.0, 3.0, 0.0});
  LocalMapper a({}, "r");
  LocalMapper b({}, "r");
  LocalMapper salted({}, "r", 5);
  LocalMapper other_robot({}, "s");
  const std::uint64_t session = a.add(scan)->stop.session;
  EXPECT_NE(session, 0U);
  EXPECT_EQ(b.add(scan)->stop.session, session);
  EXPECT_NE(salted.add(scan)->stop.session, session);
  EXPECT_NE(other_robot.add(scan)->stop.session, session);
}

TEST_F(LocalMapperTest, GoesOnAfterTheLastStopOfAnotherLife) {
  LocalMapper before({}, "r");
  const topomap::LocalMap last = *before.add(scan_at({2.0, 3.0, 0.0}));
  LocalMapper mapper({}, "r");
  mapper.resume(last);
  EXPECT_EQ(mapper.last_stop(), last.stop);
  EXPECT_FALSE(mapper.add(scan_at({2.3, 3.0, 0.0})));
  const auto next = mapper.add(scan_at({3.0, 3.0, 0.0}));
  ASSERT_TRUE(next);
  EXPECT_EQ(next->stop, (topomap::StopId{last.stop.session, 1}));
  EXPECT_NEAR(next->T_previous_robot.x_m, 1.0, 0.02);
}

TEST_F(LocalMapperTest, ANewEpochNearTheLastScanStaysInTheSession) {
  LocalMapper mapper({}, "r");
  const topomap::LocalMap first = *mapper.add(scan_at({2.0, 3.0, 0.0}));
  EXPECT_FALSE(mapper.add(scan_at({2.4, 3.0, 0.0})));
  scan::Scan scan = scan_at({2.45, 3.02, 0.03});
  scan.odometry_epoch = 8;
  scan.T_odom_robot = {};
  const auto stop = mapper.add(scan);
  ASSERT_TRUE(stop) << "what was measured before has another origin";
  EXPECT_EQ(stop->stop, (topomap::StopId{first.stop.session, 1}));
  EXPECT_EQ(stop->odometry_epoch, 8U);
  EXPECT_LT(geometry::difference(stop->T_previous_robot, {0.45, 0.02, 0.03}).norm(), 0.02);
}

TEST_F(LocalMapperTest, ARobotThatDroveOnUntilItsWatchdogIsFoundAgain) {
  LocalMapper mapper({}, "r");
  const topomap::LocalMap first = *mapper.add(scan_at({2.0, 3.0, 0.0}));
  EXPECT_FALSE(mapper.add(scan_at({2.3, 3.0, 0.0})));
  scan::Scan scan = scan_at({3.1, 3.0, 0.02});
  scan.odometry_epoch = 8;
  scan.T_odom_robot = {};
  const auto stop = mapper.add(scan);
  ASSERT_TRUE(stop);
  EXPECT_EQ(stop->stop, (topomap::StopId{first.stop.session, 1}));
  EXPECT_LT(geometry::difference(stop->T_previous_robot, {1.1, 0.0, 0.02}).norm(), 0.02);
}

TEST_F(LocalMapperTest, ANewEpochElsewhereBeginsASession) {
  LocalMapper mapper({}, "r");
  const topomap::LocalMap first = *mapper.add(scan_at({2.0, 3.0, 0.0}));
  EXPECT_FALSE(mapper.add(scan_at({2.2, 3.0, 0.0})));
  scan::Scan scan = scan_at({3.5, 1.2, 1.5});  // the robot was carried
  scan.odometry_epoch = 8;
  scan.T_odom_robot = {};
  const auto stop = mapper.add(scan);
  ASSERT_TRUE(stop);
  EXPECT_NE(stop->stop.session, first.stop.session);
  EXPECT_EQ(stop->stop.number, 0U);
  EXPECT_TRUE(stop->track.empty());
  EXPECT_EQ(stop->T_previous_robot, Pose2{});
}

// --- a robot that is carried

/// At the robot's odometry, a scan from another place.
scan::Scan displaced(scan::Scan scan, const Pose2& T_odom_robot) {
  scan.T_odom_robot = T_odom_robot;
  return scan;
}

TEST_F(LocalMapperTest, ARobotThatIsCarriedOutOfSightBeginsASession) {
  LocalMapper mapper({}, "r");
  const topomap::LocalMap first = *mapper.add(scan_at({7.2, 2.5, 0.0}));
  EXPECT_FALSE(mapper.add(scan_at({7.25, 2.5, 0.0})));
  const Pose2 T_odom_lifted{7.25, 2.5, 0.0};
  std::optional<topomap::LocalMap> stop;
  int scans = 0;
  for (; scans < 30 && !stop; ++scans) {
    const double ahead_m = 0.02 * scans;  // it drives on at once
    stop = mapper.add(displaced(scan_at(Pose2{1.5, 3.0, 0.3} * Pose2{ahead_m, 0.0, 0.0}),
                                T_odom_lifted * Pose2{ahead_m, 0.0, 0.0}));
  }
  ASSERT_TRUE(stop);
  EXPECT_NE(stop->stop.session, first.stop.session);
  EXPECT_EQ(stop->stop.number, 0U);
  EXPECT_TRUE(stop->track.empty());
  EXPECT_LE(scans, 12) << "a second is enough";
}

TEST_F(LocalMapperTest, APersonBeforeTheLaserCarriesNothing) {
  LocalMapper mapper({}, "r");
  const topomap::LocalMap first = *mapper.add(scan_at({1.0, 1.0, 0.0}));
  for (int i = 0; i < 50; ++i) {
    scan::Scan scan = scan_at({1.0 + 0.002 * i, 1.0, 0.0});
    for (std::size_t beam = 0; beam < scan.ranges_m.size() * 3 / 4; ++beam) {
      scan.ranges_m[beam] = std::min(scan.ranges_m[beam], 0.6F);
    }
    const auto stop = mapper.add(scan);
    if (stop) {
      EXPECT_EQ(stop->stop.session, first.stop.session) << i;
    }
  }
}

}  // namespace
}  // namespace topogeo::pipeline
