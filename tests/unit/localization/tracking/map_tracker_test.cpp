#include "topogeo/relocalization/map_tracker.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "topogeo/matching/matcher.hpp"
#include "topogeo/simulation/random_floors.hpp"

#include "localization/simulated_maps.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;

const Eigen::Matrix3d kKnown = Eigen::Vector3d(0.01, 0.01, 0.001).asDiagonal();

std::shared_ptr<const StoredMap> stored(const test::DrivenMaps& driven) {
  auto map = std::make_shared<StoredMap>();
  for (std::size_t i = 0; i < driven.maps.size(); ++i) {
    map->maps.push_back(*driven.maps[i]);
    map->trajectory.stops.push_back({driven.maps[i]->id, driven.maps[i]->stamp_ns,
                                     driven.T_world_robot[i], Eigen::Matrix3d::Zero()});
  }
  return map;
}

/// The floor mapped by one drive, with true poses, and another drive through it.
class MapTrackerTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    stored_ = stored(test::drive(test::world("floor"), {}));
    drive_ = new test::DrivenMaps(test::drive(test::world("floor"), {}, 0.41));
  }
  static void TearDownTestSuite() {
    stored_.reset();
    delete drive_;
    drive_ = nullptr;
  }

  MapTracker make() { return MapTracker({}, stored_, pool_); }

  /// Adds the drive's stop as the `id`th; by odometry it is at `T_step` from the last one.
  void add(MapTracker& tracker, std::size_t stop, const Pose2& T_step) {
    topomap::LocalMap map = *drive_->maps[stop];
    map.id = tracker.added_stops();
    map.stop = {2, map.id};
    T_odom_ = T_odom_ * T_step;
    map.T_odom_robot = T_odom_;
    map.T_previous_robot = T_step;
    map.track.clear();
    tracker.add(std::make_shared<const topomap::LocalMap>(map));
  }
  void follow(MapTracker& tracker, std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i) {
      const Pose2 T_step =
          tracker.stops().empty()
              ? Pose2{}
              : geometry::between(drive_->maps[i - 1]->T_odom_robot, drive_->maps[i]->T_odom_robot);
      add(tracker, i, T_step);
    }
  }
  static bool right(const MapTracker& tracker, std::size_t stop) {
    const Pose2 error =
        geometry::between(tracker.stops().back().T_map_robot, drive_->T_world_robot[stop]);
    return error.position_m().norm() < 0.1 && std::fabs(error.theta_rad) < 0.05;
  }

  static std::shared_ptr<const StoredMap> stored_;
  static test::DrivenMaps* drive_;
  InProcessPool pool_;
  Pose2 T_odom_;
};

std::shared_ptr<const StoredMap> MapTrackerTest::stored_;
test::DrivenMaps* MapTrackerTest::drive_ = nullptr;

TEST_F(MapTrackerTest, FollowsAnotherDriveFromAnInitialPose) {
  MapTracker tracker = make();
  tracker.set_pose(drive_->T_world_robot[0], kKnown);
  for (std::size_t i = 0; i < 60; ++i) {
    follow(tracker, i, i + 1);
    EXPECT_TRUE(right(tracker, i)) << i;
    EXPECT_EQ(tracker.status().state, LocalizationState::kTracking) << i;
    EXPECT_GT(tracker.status().confidence, 0.8) << i;
  }
  EXPECT_EQ(tracker.searches(), 0U);
}

// Users of these matches treat the prediction as a separate measurement.
TEST_F(MapTrackerTest, MatchesByTheScansAloneDoNotDependOnWhatWasPredicted) {
  const Eigen::Matrix3d surely = Eigen::Vector3d(0.0025, 0.0025, 0.0004).asDiagonal();
  double largest_m = 0.0;
  std::size_t compared = 0;
  for (const std::size_t stop : {5U, 12U, 30U, 48U}) {
    std::vector<TrackedStep> steps;
    for (const double off_m : {-0.1, 0.1}) {
      InProcessPool pool;
      MapTracker tracker({}, stored_, pool);
      tracker.set_pose(drive_->T_world_robot[stop] * Pose2{off_m, 0.0, 0.0}, surely);
      add(tracker, stop, {});
      steps.push_back(*tracker.last_step());
    }
    for (std::size_t i = 0; i < steps[0].accepted.size(); ++i) {
      for (std::size_t k = 0; k < steps[1].accepted.size(); ++k) {
        if (steps[0].accepted[i].stop != steps[1].accepted[k].stop) continue;
        const Pose2 apart =
            geometry::between(steps[0].scans_alone[i].T_a_b, steps[1].scans_alone[k].T_a_b);
        largest_m = std::max(largest_m, apart.position_m().norm());
        ++compared;
      }
    }
  }
  EXPECT_GE(compared, 4U);
  EXPECT_LT(largest_m, 0.02);
}

TEST_F(MapTrackerTest, FindsItselfWithoutAPose) {
  MapTracker tracker = make();
  add(tracker, 40, {});
  EXPECT_NE(tracker.status().state, LocalizationState::kTracking);  // one scan is not enough
  follow(tracker, 41, 48);
  EXPECT_EQ(tracker.status().state, LocalizationState::kTracking);
  EXPECT_TRUE(right(tracker, 47));
}

TEST_F(MapTrackerTest, ACarriedRobotIsLostWithinThreeStopsAndFindsItself) {
  MapTracker tracker = make();
  tracker.set_pose(drive_->T_world_robot[0], kKnown);
  follow(tracker, 0, 12);
  ASSERT_EQ(tracker.status().state, LocalizationState::kTracking);
  const std::size_t elsewhere = 60;
  add(tracker, elsewhere, {1.0, 0.0, 0.0});  // unnoticed by odometry
  follow(tracker, elsewhere + 1, elsewhere + 3);
  bool lost = false;
  for (std::size_t i = 12; i < 15; ++i) {
    lost |= tracker.stops()[i].status.state == LocalizationState::kLost;
  }
  EXPECT_TRUE(lost);
  follow(tracker, elsewhere + 3, elsewhere + 9);
  EXPECT_EQ(tracker.status().state, LocalizationState::kTracking);
  EXPECT_TRUE(right(tracker, elsewhere + 8));
  EXPECT_EQ(tracker.searches(), 1U);
}

TEST_F(MapTrackerTest, ABlindedRobotIsLostAndFindsItselfWhenItSeesAgain) {
  MapTracker tracker = make();
  tracker.set_pose(drive_->T_world_robot[0], kKnown);
  follow(tracker, 0, 10);
  for (int i = 0; i < 3; ++i) {
    topomap::LocalMap blind;
    blind.robot_id = "robot";
    blind.id = tracker.added_stops();
    blind.stop = {2, blind.id};
    T_odom_ = T_odom_ * Pose2{0.1, 0.0, 0.0};
    blind.T_odom_robot = T_odom_;
    tracker.add(std::make_shared<const topomap::LocalMap>(blind));
  }
  EXPECT_FALSE(tracker.status().state == LocalizationState::kTracking);
  EXPECT_LT(tracker.status().confidence, 0.3);
  add(tracker, 14, {0.5, 0.0, 0.0});
  follow(tracker, 15, 20);
  EXPECT_EQ(tracker.status().state, LocalizationState::kTracking);
  EXPECT_TRUE(right(tracker, 19));
}

TEST_F(MapTrackerTest, InAnotherBuildingItNeverTracks) {
  const test::DrivenMaps other = test::drive(test::world("room"), {});
  MapTracker tracker = make();
  for (std::size_t i = 0; i < std::min<std::size_t>(other.maps.size(), 20); ++i) {
    tracker.add(other.maps[i]);
    EXPECT_NE(tracker.status().state, LocalizationState::kTracking) << i;
  }
}

TEST_F(MapTrackerTest, AWrongInitialPoseIsNotBelievedForLong) {
  MapTracker tracker = make();
  tracker.set_pose(drive_->T_world_robot[70], kKnown);
  follow(tracker, 0, 12);
  EXPECT_EQ(tracker.status().state, LocalizationState::kTracking);
  EXPECT_TRUE(right(tracker, 11));
}

TEST_F(MapTrackerTest, SearchesOnDemandAndTakesAPoseAtAnyTime) {
  MapTracker tracker = make();
  tracker.set_pose(drive_->T_world_robot[0], kKnown);
  follow(tracker, 0, 5);
  tracker.search();
  EXPECT_EQ(tracker.status().state, LocalizationState::kSearching);
  follow(tracker, 5, 6);
  tracker.set_pose(drive_->T_world_robot[5], kKnown);
  follow(tracker, 6, 7);
  EXPECT_EQ(tracker.status().state, LocalizationState::kTracking);
  EXPECT_TRUE(right(tracker, 6));
}

// A service follows for weeks: its memory must be bounded, its counters need not.
TEST_F(MapTrackerTest, ForgetsOldStopsAndNumbersTheOthersAnew) {
  MapTracker tracker = make();
  tracker.set_pose(drive_->T_world_robot[0], kKnown);
  follow(tracker, 0, 19);
  tracker.forget_stops(10);
  EXPECT_EQ(tracker.stops().size(), 19U) << "not at every stop";
  EXPECT_EQ(tracker.trajectory().numbered_since, 0U);
  follow(tracker, 19, 20);
  tracker.forget_stops(10);
  const topomap::Trajectory trajectory = tracker.trajectory();
  ASSERT_EQ(trajectory.stops.size(), 10U);
  EXPECT_EQ(trajectory.stops.front().stop.number, 10U);
  EXPECT_EQ(trajectory.stops.front().local_map_id, 0U);
  EXPECT_EQ(trajectory.numbered_since, trajectory.version);
  follow(tracker, 20, 21);
  EXPECT_LT(tracker.trajectory().numbered_since, tracker.trajectory().version);
  EXPECT_THAT(tracker.stops_by_state(), testing::ElementsAre(21, 0, 0, 0));
  tracker.set_pose(drive_->T_world_robot[20], kKnown);
  EXPECT_THAT(tracker.stops_by_state(), testing::ElementsAre(20, 1, 0, 0))
      << "the last one is ambiguous now";
}

TEST_F(MapTrackerTest, AMapOutOfTurnIsAnError) {
  MapTracker tracker = make();
  tracker.add(drive_->maps[1]);
  EXPECT_THROW(tracker.add(drive_->maps[1]), std::invalid_argument);
  EXPECT_THROW(tracker.add(drive_->maps[3]), std::invalid_argument);
}

TEST_F(MapTrackerTest, AnotherSessionIsSearchedFor) {
  MapTracker tracker = make();
  tracker.set_pose(drive_->T_world_robot[0], kKnown);
  follow(tracker, 0, 8);
  ASSERT_EQ(tracker.status().state, LocalizationState::kTracking);
  topomap::LocalMap elsewhere = *drive_->maps[30];
  elsewhere.stop = {99, 0};
  elsewhere.T_odom_robot = {};
  tracker.add(std::make_shared<const topomap::LocalMap>(elsewhere));
  EXPECT_EQ(tracker.searches(), 1U);
  EXPECT_FALSE(tracker.status().state == LocalizationState::kTracking && !right(tracker, 30))
      << "the odometry of one session says nothing of another";
  const topomap::Trajectory trajectory = tracker.trajectory();
  EXPECT_EQ(trajectory.stops.back().stop, elsewhere.stop);
  EXPECT_EQ(trajectory.stops.back().local_map_id, trajectory.stops.size() - 1)
      << "numbered as the trajectory is, whatever the sessions";
}

// A restarted local mapper: the robot stood still or drove on in the meantime.
TEST_F(MapTrackerTest, AnotherSessionOfTheSameOdometryGoesOn) {
  for (const std::size_t stop : {7U, 9U}) {
    MapTracker tracker = make();
    tracker.set_pose(drive_->T_world_robot[0], kKnown);
    const auto add_to = [&](std::uint64_t session, std::size_t first, std::size_t i) {
      topomap::LocalMap map = *drive_->maps[i];
      map.stop = {session, static_cast<std::uint32_t>(i - first)};
      map.odometry_epoch = 5;
      if (i == first) map.T_previous_robot = {};
      tracker.add(std::make_shared<const topomap::LocalMap>(map));
    };
    for (std::size_t i = 0; i < 8; ++i) add_to(2, 0, i);
    add_to(99, stop, stop);
    EXPECT_EQ(tracker.searches(), 0U) << stop;
    EXPECT_EQ(tracker.status().state, LocalizationState::kTracking) << stop;
    EXPECT_TRUE(right(tracker, stop)) << stop;
    add_to(99, stop, stop + 1);
    EXPECT_EQ(tracker.status().state, LocalizationState::kTracking) << stop;
    EXPECT_TRUE(right(tracker, stop + 1)) << stop;
  }
}

TEST_F(MapTrackerTest, APoseThatIsSetBeforeAnotherSessionHolds) {
  MapTracker tracker = make();
  tracker.set_pose(drive_->T_world_robot[0], kKnown);
  follow(tracker, 0, 4);
  tracker.set_pose(drive_->T_world_robot[30], kKnown);
  topomap::LocalMap elsewhere = *drive_->maps[30];
  elsewhere.stop = {99, 0};
  elsewhere.odometry_epoch = 6;
  tracker.add(std::make_shared<const topomap::LocalMap>(elsewhere));
  EXPECT_EQ(tracker.searches(), 0U);
  EXPECT_TRUE(right(tracker, 30));
}

// The localizer was restarted.
TEST_F(MapTrackerTest, GoesOnAfterTheLastPlaceOfAnotherProcess) {
  constexpr std::uint64_t kEpoch = 5;
  for (const std::uint64_t epoch : {kEpoch, kEpoch + 1}) {
    MapTracker tracker = make();
    tracker.start_after(
        {{drive_->T_world_robot[7], kKnown}, drive_->maps[7]->T_odom_robot, kEpoch});
    topomap::LocalMap map = *drive_->maps[8];
    map.odometry_epoch = epoch;
    tracker.add(std::make_shared<const topomap::LocalMap>(map));
    EXPECT_EQ(tracker.searches(), epoch == kEpoch ? 0U : 1U);
    if (epoch == kEpoch) {
      EXPECT_TRUE(right(tracker, 8));
    }
  }
}

// Two identical wings. The map has only the first one; the robot drives through it and on to the
// second, with every step matched.
/// Follows the true poses through the room, in its finished map, and expects that no pose is sure
/// and wrong. All stops have good odometry.
void expect_honest(std::shared_ptr<const StoredMap> map, const std::vector<Pose2>& truth) {
  const world::World room = test::world("room");
  InProcessPool pool;
  MapTracker tracker({}, std::move(map), pool);
  tracker.set_pose(truth.front(), kKnown);
  for (std::uint32_t id = 0; id < truth.size(); ++id) {
    auto stop = std::make_shared<topomap::LocalMap>(test::map_at(room, truth[id], id));
    if (id > 0) stop->T_previous_robot = geometry::between(truth[id - 1], truth[id]);
    tracker.add(std::move(stop));
    if (tracker.status().state != LocalizationState::kTracking) continue;
    EXPECT_LT(geometry::difference(tracker.stops().back().T_map_robot, truth[id]).norm(), 0.3)
        << "stop " << id << ", confidence " << tracker.status().confidence;
  }
}

// The robot turns at its destination and drives on unmapped, for example because its local mapper
// was frozen: the next view shares little with the previous ones, and a room looks alike after a
// quarter turn. Such places were taken for right, with a confidence of 0.996.
TEST(MapTracker, AfterAStepThatNobodyMappedNoWrongPlaceIsSure) {
  const auto map = stored(test::drive(test::world("room"), {}));
  for (double back_m = 0.6; back_m <= 3.01; back_m += 0.2) {
    for (const double turned_rad : {1.8, 2.3, 2.8, 3.13}) {
      SCOPED_TRACE(testing::Message() << back_m << " m, " << turned_rad << " rad");
      std::vector<Pose2> truth = {{1.0, 1.0, 0.0},  {2.0, 1.0, -0.1}, {3.0, 0.95, 0.0},
                                  {4.0, 1.0, 0.15}, {4.0, 1.0, 0.5},  {4.0, 1.0, 0.85},
                                  {4.0, 1.0, 1.15}};
      for (const double further_rad : {0.0, 0.35, 0.7, 1.05}) {
        truth.push_back({4.0 - back_m, 1.02, turned_rad + further_rad});
      }
      expect_honest(map, truth);
    }
  }
}

TEST(MapTracker, ALookAlikeBeyondTheMapIsNotTaken) {
  const world::World world = simulation::symmetric_building(1);
  const auto& tour_m = world.tour_m;
  const auto map = stored(test::drive(world, {tour_m.begin(), tour_m.begin() + 4}));
  const test::DrivenMaps driven = test::drive(world, {tour_m.begin(), tour_m.begin() + 7}, 0.41);
  InProcessPool pool;
  MapTracker tracker({}, map, pool);
  std::size_t tracked = 0;
  std::size_t unknown = 0;
  for (std::size_t i = 0; i < driven.maps.size(); ++i) {
    tracker.add(driven.maps[i]);
    if (tracker.status().state != LocalizationState::kTracking) {
      ++unknown;
      continue;
    }
    ++tracked;
    const Pose2 error =
        geometry::between(tracker.stops().back().T_map_robot, driven.T_world_robot[i]);
    EXPECT_LT(error.position_m().norm(), 0.5) << i;
  }
  EXPECT_GT(tracked, 30U);
  EXPECT_GT(unknown, 20U);
}

}  // namespace
}  // namespace topogeo::localization
