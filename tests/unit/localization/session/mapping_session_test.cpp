#include "topogeo/session/mapping_session.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "topogeo/matching/matcher.hpp"

#include "localization/session/robot_drives.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;
using test::Maps;

/// Stops [begin, end) of a drive as a separate drive, with arbitrary odometry start.
Maps part(const Maps& maps, std::size_t begin, std::size_t end) {
  Maps out;
  for (std::size_t i = begin; i < end; ++i) {
    topomap::LocalMap map = *maps[i];
    map.id = static_cast<std::uint32_t>(out.size());
    map.stop = {2, map.id};
    map.T_odom_robot = Pose2{100.0, 50.0, 2.0} * map.T_odom_robot;
    if (out.empty()) {
      map.track.clear();
      map.T_previous_robot = {};
    }
    for (topomap::TrackedScan& scan : map.track) {
      scan.T_odom_robot = Pose2{100.0, 50.0, 2.0} * scan.T_odom_robot;
    }
    out.push_back(std::make_shared<const topomap::LocalMap>(map));
  }
  return out;
}

/// The floor, mapped up to the end of the first drive; a second one begins there.
class MappingSessionTest : public ::testing::Test {
 protected:
  static constexpr std::size_t kFirst = 60;   // stops of the first drive
  static constexpr std::size_t kSecond = 40;  // of the second

  static void SetUpTestSuite() {
    driven_ = new test::DrivenMaps(test::drive(test::world("floor"), {}));
    InProcessPool pool;
    MappingSession session({}, pool);
    for (const auto& map : part(driven_->maps, 0, kFirst)) session.add(map);
    session.finish();
    auto stored = std::make_shared<StoredMap>();
    for (const auto& map : session.maps()) stored->maps.push_back(*map);
    stored->trajectory = session.trajectory();
    stored->loop_closures = session.loop_closures();
    stored_ = stored;
  }
  static void TearDownTestSuite() {
    stored_.reset();
    delete driven_;
    driven_ = nullptr;
  }

  static Maps second() { return part(driven_->maps, kFirst, kFirst + kSecond); }

  /// Largest distance of a stop from its true place, with the first stop at its true one.
  static double largest_error_m(const topomap::Trajectory& trajectory) {
    double largest_m = 0.0;
    for (std::size_t i = 0; i < trajectory.stops.size(); ++i) {
      const Pose2 truth = geometry::between(driven_->T_world_robot[0], driven_->T_world_robot[i]);
      const Pose2 error = geometry::between(truth, trajectory.stops[i].T_map_robot);
      largest_m = std::max(largest_m, error.position_m().norm());
    }
    return largest_m;
  }
  static bool same_poses(const topomap::Trajectory& a, const topomap::Trajectory& b) {
    return std::equal(a.stops.begin(), a.stops.end(), b.stops.begin(), b.stops.end(),
                      [](const auto& x, const auto& y) { return x.T_map_robot == y.T_map_robot; });
  }

  static std::shared_ptr<const StoredMap> stored_;
  static test::DrivenMaps* driven_;
  InProcessPool pool_;
};

std::shared_ptr<const StoredMap> MappingSessionTest::stored_;
test::DrivenMaps* MappingSessionTest::driven_ = nullptr;

TEST_F(MappingSessionTest, ADriveOfItsOwnIsMappedAsByPoseGraphSlam) {
  PoseGraphSlam slam({}, pool_);
  InProcessPool pool;
  MappingSession session({}, pool);
  for (const auto& map : part(driven_->maps, 0, 30)) {
    EXPECT_EQ(session.add(map), slam.add(map)) << map->id;
    EXPECT_EQ(session.last_stop()->T_map_robot, slam.trajectory().stops.back().T_map_robot);
  }
  slam.finish();
  session.finish();
  EXPECT_TRUE(same_poses(session.trajectory(), slam.trajectory()));
  EXPECT_EQ(session.counts().tasks, slam.counts().tasks);
  EXPECT_EQ(session.unmapped_stops(), 0U);
}

TEST_F(MappingSessionTest, FindsItselfInAStoredMapAndExtendsItBackToItsFirstStop) {
  MappingSession session({}, pool_, nullptr, stored_, std::nullopt);
  EXPECT_EQ(session.maps().size(), kFirst);
  std::size_t joined_at = 0;
  for (const auto& map : second()) {
    session.add(map);
    if (session.waiting_stops() > 0) {
      EXPECT_EQ(session.maps().size(), kFirst);
      EXPECT_TRUE(same_poses(session.trajectory(), stored_->trajectory));
      joined_at = map->id + 1;
    }
  }
  EXPECT_GT(joined_at, 0U) << "one stop cannot be enough";
  EXPECT_LT(joined_at, kSecond / 2);
  session.finish();
  const topomap::Trajectory trajectory = session.trajectory();
  ASSERT_EQ(trajectory.stops.size(), kFirst + kSecond);
  EXPECT_EQ(session.unmapped_stops(), 0U);
  EXPECT_LT(largest_error_m(trajectory), 0.25);
  for (std::size_t i = 0; i < trajectory.stops.size(); ++i) {
    EXPECT_EQ(session.maps()[i]->id, i);
    EXPECT_EQ(trajectory.stops[i].local_map_id, i);
    EXPECT_EQ(session.maps()[i]->starts_drive, i == kFirst);
    EXPECT_EQ(trajectory.stops[i].stop.number, i < kFirst ? i : i - kFirst);
  }
  EXPECT_TRUE(session.maps()[kFirst]->track.empty());
  const auto loops = session.loop_closures();
  EXPECT_TRUE(std::any_of(loops.begin(), loops.end(), [](const topomap::LoopClosure& loop) {
    return loop.earlier_id < kFirst && loop.later_id >= kFirst;
  }));
}

/// The floor on another day: cupboards of the south corridor are gone, three of its doors are shut,
/// and people stand about.
world::World floor_on_another_day() {
  world::World world = test::world("floor");
  std::erase_if(world.segments, [](const world::Segment& segment) {
    const auto at_south_wall = [](const Eigen::Vector2d& p) {
      return p.x() > 4.0 && p.x() < 20.0 && p.y() > 0.05 && p.y() < 0.6;
    };
    return at_south_wall(segment.a_m) && at_south_wall(segment.b_m);
  });
  for (const double door_m : {11.9, 15.0, 18.7}) {
    world.segments.push_back({{door_m - 0.8, 2.2}, {door_m + 0.8, 2.2}});
  }
  for (const Eigen::Vector2d& person : {Eigen::Vector2d(14.0, 1.7), Eigen::Vector2d(17.5, 0.5),
                                        Eigen::Vector2d(22.0, 1.8), Eigen::Vector2d(28.4, 6.0)}) {
    world.circles.push_back({person, 0.2});
  }
  return world;
}

TEST_F(MappingSessionTest, JoinsTheMapOfADayWithOtherDoorsAndPeople) {
  const test::DrivenMaps& before = test::round_trip();
  MappingSession first({}, pool_);
  for (const auto& map : before.maps) first.add(map);
  first.finish();
  auto stored = std::make_shared<StoredMap>();
  for (const auto& map : first.maps()) stored->maps.push_back(*map);
  stored->trajectory = first.trajectory();
  stored->loop_closures = first.loop_closures();

  const test::DrivenMaps after =
      test::drive(floor_on_another_day(), {{12.0, 1.15}, {28.9, 1.2}, {28.9, 15.0}});
  InProcessPool pool;
  MappingSession session({}, pool, nullptr, stored, std::nullopt);
  for (const auto& map : after.maps) session.add(map);
  session.finish();
  ASSERT_EQ(session.maps().size(), before.maps.size() + after.maps.size());
  const topomap::Trajectory trajectory = session.trajectory();
  for (std::size_t i = 0; i < after.maps.size(); ++i) {
    const Pose2 truth = geometry::between(before.T_world_robot[0], after.T_world_robot[i]);
    const Pose2 error =
        geometry::between(truth, trajectory.stops[before.maps.size() + i].T_map_robot);
    EXPECT_LT(error.position_m().norm(), 0.3) << i;
    EXPECT_LT(std::fabs(error.theta_rad), 0.05) << i;
  }
}

TEST_F(MappingSessionTest, AnInitialPoseSparesTheSearch) {
  const Pose2 T_map_start =
      geometry::between(driven_->T_world_robot[0], driven_->T_world_robot[kFirst]);
  const UncertainPose initial{T_map_start, Eigen::Vector3d(0.09, 0.09, 0.03).asDiagonal()};
  MappingSession session({}, pool_, nullptr, stored_, initial);
  const Maps drive = second();
  for (std::size_t i = 0; i < 3; ++i) session.add(drive[i]);
  EXPECT_EQ(session.maps().size(), kFirst + 3);
  EXPECT_EQ(session.status().state, LocalizationState::kTracking);
}

TEST_F(MappingSessionTest, InAnotherBuildingTheMapStaysAsItWas) {
  MappingSession session({}, pool_, nullptr, stored_, std::nullopt);
  const Maps other = test::drive(test::world("room"), {}).maps;
  for (const auto& map : other) session.add(map);
  session.finish();
  EXPECT_EQ(session.maps().size(), kFirst);
  EXPECT_EQ(session.unmapped_stops(), other.size());
  EXPECT_EQ(session.waiting_stops(), other.size());
  EXPECT_TRUE(same_poses(session.trajectory(), stored_->trajectory));
  EXPECT_EQ(session.trajectory().version, stored_->trajectory.version);
  EXPECT_NE(session.status().state, LocalizationState::kTracking);
}

TEST_F(MappingSessionTest, StopsAndResumesMapping) {
  MappingSession session({}, pool_);
  EXPECT_THROW(session.stop_mapping(), std::logic_error);  // nothing to localize in
  const Maps drive = part(driven_->maps, 0, 60);
  for (std::size_t i = 0; i < 30; ++i) session.add(drive[i]);
  EXPECT_THROW(session.resume_mapping(), std::logic_error);
  session.stop_mapping();
  EXPECT_THROW(session.stop_mapping(), std::logic_error);
  const topomap::Trajectory before = session.trajectory();
  for (std::size_t i = 30; i < 36; ++i) {
    session.add(drive[i]);
    EXPECT_EQ(session.trajectory().version, before.version);
    EXPECT_TRUE(same_poses(session.trajectory(), before));
  }
  EXPECT_EQ(session.unmapped_stops(), 6U);
  session.resume_mapping();
  EXPECT_TRUE(session.mapping());
  for (std::size_t i = 36; i < 60; ++i) session.add(drive[i]);
  session.finish();
  EXPECT_EQ(session.maps().size(), 54U);
  EXPECT_EQ(session.unmapped_stops(), 6U);
  const topomap::Trajectory after = session.trajectory();
  EXPECT_EQ(after.stops[29].stop.number, 29U);
  EXPECT_EQ(after.stops[30].stop.number, 36U);
  EXPECT_TRUE(session.maps()[30]->starts_drive);
  const Pose2 truth = geometry::between(driven_->T_world_robot[0], driven_->T_world_robot[59]);
  EXPECT_LT(geometry::between(truth, after.stops.back().T_map_robot).position_m().norm(), 0.25);
}

TEST_F(MappingSessionTest, AnotherSessionIsAnotherDriveThatFindsItsPlace) {
  MappingSession session({}, pool_);
  for (std::size_t i = 0; i < kFirst; ++i) session.add(driven_->maps[i]);
  const std::uint64_t version = session.trajectory().version;
  const Maps second = part(driven_->maps, kFirst, kFirst + kSecond);
  for (const auto& map : second) session.add(map);
  session.finish();
  EXPECT_EQ(session.unmapped_stops(), 0U);
  ASSERT_EQ(session.maps().size(), kFirst + kSecond);
  const topomap::Trajectory after = session.trajectory();
  EXPECT_GT(after.version, version);
  EXPECT_TRUE(session.maps()[kFirst]->starts_drive);
  EXPECT_EQ(after.stops[kFirst].stop, (topomap::StopId{2, 0}));
  EXPECT_LT(largest_error_m(after), 0.25);
}

// The second drive begins in an unmapped part of the floor, 40 m before it reaches the start of the
// first one. Its first stops lie across other corridors by odometry.
TEST_F(MappingSessionTest, ADriveThatMeetsTheMapLateIsComparedWithItOnceItHasItsPlace) {
  MappingSession session({}, pool_);
  for (const auto& given : test::one_after_the_other(test::drive_a().maps, test::drive_b().maps)) {
    topomap::LocalMap map = *given;
    map.robot_id = "robot";
    session.add(std::make_shared<const topomap::LocalMap>(std::move(map)));
  }
  session.finish();
  EXPECT_EQ(session.unmapped_stops(), 0U);
  EXPECT_LT(test::largest_error_m(session.trajectory()), 0.25);
}

TEST_F(MappingSessionTest, TheMapOfAPatrolStopsGrowing) {
  constexpr std::size_t kStopsOfDay = 30;
  constexpr std::int64_t kBetween_ns = 86'400'000'000'000;
  MappingSession session({}, pool_);
  std::uint64_t numbered_since = 0;
  std::size_t renewals = 0;
  for (std::uint64_t day = 1; day <= 7; ++day) {
    for (std::size_t i = 0; i < kStopsOfDay; ++i) {
      topomap::LocalMap map = *driven_->maps[i];
      map.stop.session = day;
      map.stamp_ns += static_cast<std::int64_t>(day) * kBetween_ns;
      session.add(std::make_shared<const topomap::LocalMap>(map));
    }
    session.finish();
    EXPECT_EQ(session.unmapped_stops(), 0U) << day;
    const topomap::Trajectory trajectory = session.trajectory();
    renewals += trajectory.numbered_since != numbered_since ? 1 : 0;
    numbered_since = trajectory.numbered_since;
    ASSERT_EQ(trajectory.stops.size(), session.maps().size());
    std::uint32_t views = 0;
    for (std::size_t i = 0; i < trajectory.stops.size(); ++i) {
      EXPECT_EQ(session.maps()[i]->id, i);
      EXPECT_EQ(trajectory.stops[i].stop, session.maps()[i]->stop);
      views += trajectory.stops[i].views;
    }
    EXPECT_EQ(views, day * kStopsOfDay) << "nothing has gone that is not there any more";
    EXPECT_LE(session.maps().size(), 5 * kStopsOfDay + kStopsOfDay / 2);
  }
  EXPECT_EQ(session.added_stops(), 7 * kStopsOfDay);
  EXPECT_EQ(renewals, 2U) << "when the sixth and the seventh drive joined";
  EXPECT_LE(numbered_since, session.trajectory().version);
  // The last drive coincides with the first.
  const topomap::Trajectory trajectory = session.trajectory();
  for (std::size_t i = 0; i < kStopsOfDay; ++i) {
    const Pose2 truth = geometry::between(driven_->T_world_robot[0], driven_->T_world_robot[i]);
    const Pose2 last = trajectory.stops[trajectory.stops.size() - kStopsOfDay + i].T_map_robot;
    EXPECT_LT(geometry::between(truth, last).position_m().norm(), 0.1) << i;
  }
}

// A robot that is never switched off: stop after stop of one session, back and forth along the same
// path, two hours each way, with limits of a fortieth.
TEST_F(MappingSessionTest, TheMapOfADriveWithoutEndStopsGrowing) {
  constexpr std::size_t kWay = 25;
  constexpr std::size_t kWays = 16;
  constexpr std::int64_t kOfWay_ns = 7'200'000'000'000;
  const MappingSession::LongDrive limits{
      .stops = 4 * kWay, .stops_of_drive = 2 * kWay, .untouched = 10};
  MappingSession session({}, pool_);
  session.set_long_drive(limits);
  std::size_t most = 0;
  std::size_t renewals = 0;
  std::uint64_t numbered_since = 0;
  std::uint32_t number = 0;
  Pose2 T_odom_last;
  for (std::size_t way = 0; way < kWays; ++way) {
    for (std::size_t k = 0; k < kWay; ++k) {
      const std::size_t i = way % 2 == 0 ? k : kWay - 1 - k;
      topomap::LocalMap map = *driven_->maps[i];
      map.id = number;
      map.stop = {7, number++};
      map.stamp_ns =
          static_cast<std::int64_t>(way) * kOfWay_ns + 1'000'000'000 * static_cast<std::int64_t>(k);
      // Scans between stops exist only in the forward direction.
      map.track.clear();
      map.T_previous_robot = geometry::between(T_odom_last, map.T_odom_robot);
      T_odom_last = map.T_odom_robot;
      session.add(std::make_shared<const topomap::LocalMap>(map));
      most = std::max(most, session.maps().size());
      const topomap::Trajectory trajectory = session.trajectory();
      renewals += trajectory.numbered_since != numbered_since ? 1 : 0;
      numbered_since = trajectory.numbered_since;
      const auto& stops = trajectory.stops;
      ASSERT_EQ(stops.size(), session.maps().size());
      const bool ascend =
          std::adjacent_find(stops.begin(), stops.end(), [](const auto& a, const auto& b) {
            return a.stop.number >= b.stop.number;
          }) == stops.end();
      ASSERT_TRUE(ascend) << number;
      ASSERT_EQ(session.maps().front()->stop.number, 0U) << "the origin stays";
    }
  }
  session.finish();
  EXPECT_EQ(session.unmapped_stops(), 0U);
  EXPECT_EQ(session.added_stops(), kWays * kWay);
  EXPECT_GE(renewals, 2U);
  // The oldest views, those of the last three times, and the stops since the last renewal.
  EXPECT_LE(most, (1 + kKeptTimes) * limits.stops_of_drive + limits.stops / 2);
  const topomap::Trajectory trajectory = session.trajectory();
  for (std::size_t i = 0; i < trajectory.stops.size(); ++i) {
    const std::uint32_t stop = trajectory.stops[i].stop.number;
    const std::size_t way = stop / kWay;
    const std::size_t place = way % 2 == 0 ? stop % kWay : kWay - 1 - stop % kWay;
    const Pose2 truth = geometry::between(driven_->T_world_robot[0], driven_->T_world_robot[place]);
    EXPECT_LT(geometry::between(truth, trajectory.stops[i].T_map_robot).position_m().norm(), 0.15)
        << stop;
  }
}

TEST_F(MappingSessionTest, StopsOfASessionThatFoundNoPlaceAreGivenUpWithIt) {
  MappingSession session({}, pool_);
  for (std::size_t i = 0; i < kFirst; ++i) session.add(driven_->maps[i]);
  Maps other = part(driven_->maps, kFirst, kFirst + 2);  // too few to be sure
  for (const auto& map : other) session.add(map);
  EXPECT_EQ(session.waiting_stops(), 2U);
  topomap::LocalMap next = *driven_->maps[kFirst];
  next.stop = {3, 0};
  session.add(std::make_shared<const topomap::LocalMap>(next));
  EXPECT_EQ(session.waiting_stops(), 1U);
  EXPECT_EQ(session.unmapped_stops(), 3U);
}

TEST_F(MappingSessionTest, GoesOnAtTheLastStopOfTheStoredMap) {
  MappingSession session({}, pool_, nullptr, stored_, std::nullopt);
  session.resume_session();
  const Maps drive = part(driven_->maps, 0, kFirst + kSecond);
  for (std::size_t i = kFirst; i < kFirst + kSecond; ++i) {
    session.add(drive[i]);
    EXPECT_EQ(session.unmapped_stops(), 0U) << "there is nothing to search for";
  }
  session.finish();
  ASSERT_EQ(session.maps().size(), kFirst + kSecond);
  EXPECT_FALSE(session.maps()[kFirst]->starts_drive);
  EXPECT_LT(largest_error_m(session.trajectory()), 0.25);
}

TEST_F(MappingSessionTest, RefusesAnotherRobotAStopOutOfTurnAndTheAlgorithmThatCannot) {
  MappingSession session({}, pool_, nullptr, stored_, std::nullopt);
  topomap::LocalMap map = *driven_->maps[0];
  session.add(std::make_shared<const topomap::LocalMap>(map));
  EXPECT_THROW(session.add(std::make_shared<const topomap::LocalMap>(map)), std::invalid_argument);
  map = *driven_->maps[2];
  EXPECT_THROW(session.add(std::make_shared<const topomap::LocalMap>(map)), std::invalid_argument);
  map = *driven_->maps[1];
  map.robot_id = "another";
  EXPECT_THROW(session.add(std::make_shared<const topomap::LocalMap>(map)), std::invalid_argument);
  LocalizerConfig thesis;
  thesis.mode = SlamAlgorithm::kThesis;
  EXPECT_THROW(MappingSession(thesis, pool_, nullptr, stored_, std::nullopt),
               std::invalid_argument);
}

}  // namespace
}  // namespace topogeo::localization
