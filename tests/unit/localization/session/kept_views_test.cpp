#include "topogeo/session/kept_views.hpp"

#include <algorithm>
#include <cstdint>
#include <numeric>

#include <gtest/gtest.h>

#include "localization/simulated_maps.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;

constexpr std::int64_t kHour_ns = 3'600'000'000'000;
constexpr std::int64_t kDay_ns = 24 * kHour_ns;
constexpr std::uint32_t kStops = 11;  // of a drive

/// A hall of 12 x 3 m with objects at its walls. Every drive goes along it, a stop each metre.
class KeptViewsTest : public testing::Test {
 protected:
  static world::World hall(const std::string& more = "") {
    return world::parse_world(
        "walls:\n"
        "  - {from: [0, 0], to: [12, 0]}\n"
        "  - {from: [12, 0], to: [12, 3]}\n"
        "  - {from: [12, 3], to: [0, 3]}\n"
        "  - {from: [0, 3], to: [0, 0]}\n"
        "boxes: [{from: [4, 0], to: [4.4, 0.5]}, {from: [8, 2.6], to: [9, 3]}" +
            more + "]\n",
        "hall");
  }

  void drive(const world::World& world, std::int64_t stamp_ns) {
    const auto session = static_cast<std::uint64_t>(++drives_);
    for (std::uint32_t i = 0; i < kStops; ++i) {
      const auto id = static_cast<std::uint32_t>(map_.maps.size());
      const Pose2 pose{0.8 + i + 0.05 * (drives_ % 5), 1.4 + 0.04 * (drives_ % 3), 0.0};
      topomap::LocalMap map = test::map_at(world, pose, id);
      map.stop = {session, i};
      map.stamp_ns = stamp_ns + i * 1'000'000'000LL;
      map.starts_drive = id > 0 && i == 0;
      topomap::StopPose stop;
      stop.local_map_id = id;
      stop.stamp_ns = map.stamp_ns;
      stop.T_map_robot = pose;
      stop.stop = map.stop;
      map_.maps.push_back(std::move(map));
      map_.trajectory.stops.push_back(stop);
      if (id >= kStops) map_.loop_closures.push_back({id - kStops, id, between(id - kStops, id)});
    }
    map_.trajectory.version = 7;
  }
  [[nodiscard]] Pose2 between(std::uint32_t a, std::uint32_t b) const {
    const Pose2 T_b =
        b < map_.trajectory.stops.size() ? map_.trajectory.stops[b].T_map_robot : Pose2{};
    return geometry::between(map_.trajectory.stops[a].T_map_robot, T_b);
  }
  [[nodiscard]] KeptViews keep(std::size_t untouched = 0) const {
    return {map_.maps, map_.trajectory.stops, kKeptTimes, untouched};
  }
  /// Points on the front of the cupboard. The first stop is always kept.
  static std::size_t points_on_cupboard(const StoredMap& map) {
    std::size_t count = 0;
    for (std::size_t i = 1; i < map.maps.size(); ++i) {
      for (const topomap::ScanPoint& p : map.maps[i].points) {
        const Eigen::Vector2d at =
            map.trajectory.stops[i].T_map_robot * Eigen::Vector2d(p.x_m, p.y_m);
        count += at.x() > 6.1 && at.x() < 6.9 && std::fabs(at.y() - 0.6) < 0.1 ? 1 : 0;
      }
    }
    return count;
  }
  [[nodiscard]] std::size_t kept_of_drive(const KeptViews& kept, int drive) const {
    return static_cast<std::size_t>(std::ranges::count_if(kept.kept(), [&](std::uint32_t stop) {
      return map_.maps[stop].stop.session == static_cast<std::uint64_t>(drive);
    }));
  }

  StoredMap map_;
  int drives_ = 0;
};

TEST_F(KeptViewsTest, KeepsTheOldestViewOfAPlaceAndThoseOfTheLastTimes) {
  for (int day = 0; day < 8; ++day) drive(hall(), day * kDay_ns);
  const KeptViews kept = keep();
  EXPECT_EQ(kept_of_drive(kept, 1), kStops);
  for (const int drive : {6, 7, 8}) EXPECT_EQ(kept_of_drive(kept, drive), kStops) << drive;
  // At the end of the hall, views differ more.
  for (const int drive : {2, 3, 4, 5}) EXPECT_LE(kept_of_drive(kept, drive), 1U) << drive;
}

TEST_F(KeptViewsTest, StaysAsItIsWhenKeptViewsAreChosenAgain) {
  for (int day = 0; day < 8; ++day) drive(hall(), day * kDay_ns);
  map_ = with_kept_views(map_, keep());
  EXPECT_EQ(keep().dropped(), 0U);
}

TEST_F(KeptViewsTest, ADriveAloneStaysWhole) {
  drive(hall(), 0);
  EXPECT_EQ(keep().dropped(), 0U);
  EXPECT_EQ(KeptViews({}, {}).dropped(), 0U);
}

TEST_F(KeptViewsTest, DrivesWithinAnHourAreOneTime) {
  for (int i = 0; i < 6; ++i) drive(hall(), i * kHour_ns / 10);
  drive(hall(), 2 * kHour_ns);
  const KeptViews kept = keep();
  EXPECT_EQ(kept_of_drive(kept, 1), kStops);
  EXPECT_EQ(kept_of_drive(kept, 7), kStops);
  EXPECT_EQ(kept.kept().size(), 2 * kStops);
}

TEST_F(KeptViewsTest, TheLastStopsStayUntouched) {
  for (int i = 0; i < 2; ++i) drive(hall(), i * kHour_ns / 10);
  EXPECT_EQ(keep().kept().size(), kStops);
  EXPECT_EQ(keep(3).kept().size(), kStops + 3);
  EXPECT_EQ(keep(100).kept().size(), 2 * kStops);
}

TEST_F(KeptViewsTest, ViewsOfWhatIsGoneAgeOut) {
  const world::World with_cupboard = hall(", {from: [6, 0], to: [7, 0.6]}");
  for (int day = 0; day < 4; ++day) drive(with_cupboard, day * kDay_ns);
  for (int day = 4; day < 8; ++day) drive(hall(), day * kDay_ns);
  const KeptViews kept = keep();
  // Only stops in front of the cupboard see it.
  std::size_t outdated = 0;
  for (std::uint32_t stop = 1; stop < kStops; ++stop) outdated += kept.outdated(stop) ? 1 : 0;
  EXPECT_GE(outdated, 4U);
  EXPECT_LT(outdated, kStops - 1U);
  const StoredMap after = with_kept_views(map_, kept);
  EXPECT_GT(points_on_cupboard(map_), 100U);
  EXPECT_LE(points_on_cupboard(after), 10U) << "single points that were seen from afar";
}

TEST_F(KeptViewsTest, WhoStandsThereOnceIsNoReasonToForget) {
  drive(hall(), 0);
  drive(hall(", {from: [6, 1.8], to: [6.4, 2.2]}"), kDay_ns);  // a person
  for (int day = 2; day < 6; ++day) drive(hall(), day * kDay_ns);
  const KeptViews kept = keep();
  EXPECT_EQ(kept_of_drive(kept, 1), kStops);
  EXPECT_LE(kept_of_drive(kept, 2), 1U);
}

TEST_F(KeptViewsTest, WhatIsDroppedLeavesItsViewsAndLoopsBehind) {
  for (int day = 0; day < 8; ++day) drive(hall(), day * kDay_ns);
  map_.trajectory.stops[2 * kStops + 1].views = 10;
  const StoredMap after = with_kept_views(map_, keep());
  EXPECT_EQ(after.trajectory.version, 8U);
  EXPECT_EQ(after.trajectory.numbered_since, 8U);
  std::uint32_t views = 0;
  for (std::uint32_t i = 0; i < after.maps.size(); ++i) {
    EXPECT_EQ(after.maps[i].id, i);
    EXPECT_EQ(after.trajectory.stops[i].local_map_id, i);
    EXPECT_EQ(after.trajectory.stops[i].stop, after.maps[i].stop);
    const bool follows = i > 0 && after.maps[i - 1].stop.next() == after.maps[i].stop;
    EXPECT_EQ(after.maps[i].starts_drive, i > 0 && !follows);
    views += after.trajectory.stops[i].views;
  }
  EXPECT_EQ(views, 8 * kStops + 9);
  // The oldest views were seen again on the days of the dropped views.
  EXPECT_GE(after.trajectory.stops[1].last_seen_ns(), 4 * kDay_ns);

  std::vector<std::uint32_t> loops_to_oldest(kStops);
  for (const topomap::LoopClosure& loop : after.loop_closures) {
    ASSERT_LT(loop.earlier_id, loop.later_id);
    ASSERT_LT(loop.later_id, after.maps.size());
    const Pose2 apart = geometry::between(after.trajectory.stops[loop.earlier_id].T_map_robot,
                                          after.trajectory.stops[loop.later_id].T_map_robot);
    EXPECT_LT(geometry::difference(apart, loop.T_earlier_later).norm(), 1e-9);
    if (loop.earlier_id < kStops && loop.later_id >= kStops) ++loops_to_oldest[loop.earlier_id];
  }
  // At the end of the hall, views of the days between are kept, too.
  for (std::uint32_t i = 1; i + 1 < kStops; ++i) EXPECT_GE(loops_to_oldest[i], 1U) << i;
}

TEST_F(KeptViewsTest, MeasurementsThatAreKnownStayKnown) {
  for (int day = 0; day < 8; ++day) drive(hall(), day * kDay_ns);
  const Eigen::Matrix3d covariance = 0.5 * usual_match_covariance();
  for (std::uint32_t id = 1; id < map_.maps.size(); ++id) {
    map_.edges.push_back({id - 1, id, EdgeKind::kOdometry, between(id - 1, id), covariance});
    if (id < kStops) continue;
    map_.edges.push_back(
        {id - kStops, id, EdgeKind::kRevisit, between(id - kStops, id), covariance});
  }
  const KeptViews kept = keep();
  const StoredMap after = with_kept_views(map_, kept);
  check(after);
  std::size_t measured = 0;
  for (const PoseGraphEdge& edge : after.edges) {
    const bool as_measured = edge.covariance == covariance;
    measured += as_measured ? 1 : 0;
    EXPECT_TRUE(as_measured || edge.kind == EdgeKind::kRevisit);
    EXPECT_TRUE(as_measured || edge.covariance(0, 0) > usual_match_covariance()(0, 0));
  }
  EXPECT_GT(measured, 5 * kStops) << "between the last drives and along each";
  EXPECT_GT(after.edges.size(), measured) << "from the oldest drive to the last ones";
}

TEST_F(KeptViewsTest, BehindAWallIsAnotherPlace) {
  const world::World halved = world::parse_world(
      "walls:\n"
      "  - {from: [0, 0], to: [12, 0]}\n"
      "  - {from: [0, 1.5], to: [12, 1.5]}\n"
      "  - {from: [0, 3], to: [12, 3]}\n"
      "boxes: [{from: [4, 0], to: [4.4, 0.5]}, {from: [8, 2.6], to: [9, 3]}]\n",
      "two corridors");
  for (int day = 0; day < 5; ++day) {
    const std::size_t first = map_.maps.size();
    drive(halved, day * kDay_ns);
    // Every second day on the other side of the wall, half a metre away.
    for (std::size_t i = first; i < map_.maps.size(); ++i) {
      Pose2& pose = map_.trajectory.stops[i].T_map_robot;
      pose.y_m = day % 2 == 0 ? 1.1 : 1.9;
      const topomap::StopId stop = map_.maps[i].stop;
      const std::int64_t stamp_ns = map_.maps[i].stamp_ns;
      map_.maps[i] = test::map_at(halved, pose, static_cast<std::uint32_t>(i));
      map_.maps[i].stop = stop;
      map_.maps[i].stamp_ns = stamp_ns;
    }
  }
  EXPECT_EQ(keep().dropped(), 0U) << "three views on one side, two on the other";
}

}  // namespace
}  // namespace topogeo::localization
