#include "topogeo/session/shared_map.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "topogeo/matching/matcher.hpp"
#include "topogeo/session/mapping_session.hpp"

#include "localization/session/remembering_pool.hpp"
#include "localization/session/robot_drives.hpp"
#include "stop_numbers.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;
using test::largest_error_m;
using test::Maps;
using test::one_after_the_other;
using test::RememberingPool;
using test::robot_drive;
using test::RobotDrive;
using test::truth;

const RobotDrive& a() {
  return test::drive_a();
}
const RobotDrive& b() {
  return test::drive_b();
}

/// Stops of both in turn, as long as each has some; `first` is one ahead.
Maps in_turn(const Maps& first, const Maps& second) {
  Maps out;
  for (std::size_t i = 0; i < std::max(first.size(), second.size()); ++i) {
    if (i < first.size()) out.push_back(first[i]);
    if (i < second.size()) out.push_back(second[i]);
  }
  return out;
}

/// Largest distance between the places of a stop in two maps, aligned at the first stop of `a`.
double largest_difference_m(const topomap::Trajectory& one, const topomap::Trajectory& other) {
  const auto pose = [](const topomap::Trajectory& trajectory, const topomap::StopId& stop) {
    return std::ranges::find(trajectory.stops, stop, &topomap::StopPose::stop)->T_map_robot;
  };
  const topomap::StopId first{21, 0};
  double largest_m = 0.0;
  for (const topomap::StopPose& stop : one.stops) {
    const Pose2 T_one = geometry::between(pose(one, first), stop.T_map_robot);
    const Pose2 T_other = geometry::between(pose(other, first), pose(other, stop.stop));
    largest_m = std::max(largest_m, geometry::between(T_one, T_other).position_m().norm());
  }
  return largest_m;
}

template <class Pool = RememberingPool>
topomap::Trajectory mapped(const Maps& stops) {
  Pool pool;
  SharedMap shared({}, pool);
  for (const auto& map : stops) shared.add(map);
  shared.finish();
  return shared.trajectory();
}

/// Both drive at the same time, `a` one stop ahead.
const topomap::Trajectory& both() {
  static const topomap::Trajectory trajectory = mapped(in_turn(a().maps, b().maps));
  return trajectory;
}

LocalizerConfig asking() {
  LocalizerConfig config;
  config.merge = MergePolicy::kAsk;
  return config;
}

TEST(SharedMap, JoinsTheMapsAsSoonAsARobotComesToWhereTheOtherWas) {
  RememberingPool pool;
  SharedMap shared({}, pool);
  std::optional<topomap::StopId> joined_at;
  std::size_t apart = 0;
  for (const auto& map : in_turn(a().maps, b().maps)) {
    shared.add(map);
    if (joined_at) continue;
    ASSERT_TRUE(shared.joined("a"));
    if (shared.joined("b")) {
      joined_at = map->stop;
    } else if (map->robot_id == "b") {
      EXPECT_EQ(shared.stops_apart(), ++apart);
      EXPECT_FALSE(shared.last_stop("b")->located);
      EXPECT_EQ(shared.status("b").state, LocalizationState::kSearching);
      for (const topomap::StopPose& stop : shared.trajectory().stops) {
        ASSERT_EQ(stop.stop.session, 21U);
      }
    }
  }
  ASSERT_TRUE(joined_at.has_value());
  EXPECT_EQ(joined_at->session, 22U);
  // It turned into the corridor at (1.3, 1.2), the start of `a`.
  EXPECT_GT(truth(*joined_at).x_m, 2.0);
  EXPECT_LT(truth(*joined_at).x_m, 8.0);
  EXPECT_EQ(shared.stops_apart(), 0U);
  EXPECT_EQ(shared.status("b").state, LocalizationState::kTracking);
  ASSERT_EQ(shared.proposals().size(), 1U);
  EXPECT_EQ(shared.proposals()[0].state, MergeProposal::State::kAccepted);
  EXPECT_EQ(shared.proposals()[0].robot, "b");
  EXPECT_EQ(shared.proposals()[0].other_robot, "a");
  EXPECT_GT(shared.proposals()[0].confidence, 0.9);
  shared.finish();
  const topomap::Trajectory trajectory = shared.trajectory();
  ASSERT_EQ(trajectory.stops.size(), a().maps.size() + b().maps.size());
  EXPECT_LT(largest_error_m(trajectory), 0.1);  // of `a` alone: 0.22 m, of `b`: 0.31 m
  const StoredMap map = shared.map();
  EXPECT_NO_THROW(check(map));
  for (std::size_t i = 0; i < trajectory.stops.size(); ++i) {
    EXPECT_EQ(map.maps[i].id, i);
    EXPECT_EQ(map.maps[i].stop, trajectory.stops[i].stop);
    EXPECT_EQ(map.maps[i].starts_drive, i == a().maps.size());
    EXPECT_EQ(map.maps[i].robot_id, i < a().maps.size() ? "a" : "b");
  }
}

TEST(SharedMap, IsTheSameMapOnEveryRun) {
  const auto again = mapped<InProcessPool>(in_turn(a().maps, b().maps));
  ASSERT_EQ(again.stops.size(), both().stops.size());
  for (std::size_t i = 0; i < again.stops.size(); ++i) {
    EXPECT_EQ(again.stops[i].T_map_robot, both().stops[i].T_map_robot) << i;
    EXPECT_EQ(again.stops[i].stop, both().stops[i].stop) << i;
  }
}

TEST(SharedMap, IsWithinTwoCentimetresOfAnyOtherOrderOfArrival) {
  EXPECT_LT(largest_difference_m(both(), mapped(in_turn(b().maps, a().maps))), 0.02);
  EXPECT_LT(largest_difference_m(both(), mapped(one_after_the_other(a().maps, b().maps))), 0.02);
  EXPECT_LT(largest_difference_m(both(), mapped(one_after_the_other(b().maps, a().maps))), 0.02);
}

// At its end `a` sees the start of `b` from behind, 7 m ahead: without that loop the heading of its
// part is off by a third of a degree, and its end by 0.2 m.
TEST(SharedMap, IsWithinFourCentimetresOfTheMapOfOneRobotThatDroveBoth) {
  RememberingPool pool;
  MappingSession one({}, pool);
  for (const auto& given : one_after_the_other(b().maps, a().maps)) {
    topomap::LocalMap map = *given;
    map.robot_id = "one";
    one.add(std::make_shared<const topomap::LocalMap>(std::move(map)));
  }
  one.finish();
  ASSERT_EQ(one.maps().size(), both().stops.size());
  EXPECT_LT(largest_difference_m(both(), one.trajectory()), 0.06);
  topomap::Trajectory common = both();
  std::erase_if(common.stops, [](const topomap::StopPose& stop) {
    const Pose2 T_world_robot = truth(stop.stop);
    return T_world_robot.x_m > 24.0 || T_world_robot.y_m > 2.0;
  });
  EXPECT_GT(common.stops.size(), 40U);
  EXPECT_LT(largest_difference_m(common, one.trajectory()), 0.04);
}

TEST(SharedMap, AsksBeforeItJoins) {
  RememberingPool pool;
  SharedMap shared(asking(), pool);
  for (const auto& map : in_turn(a().maps, b().maps)) shared.add(map);
  EXPECT_FALSE(shared.joined("b"));
  EXPECT_EQ(shared.stops_apart(), b().maps.size());
  ASSERT_EQ(shared.proposals().size(), 1U);
  const MergeProposal proposal = shared.proposals().front();
  EXPECT_EQ(proposal.state, MergeProposal::State::kOpen);
  EXPECT_GT(proposal.distance_m, 10.0);  // driven since it was found
  const Pose2 T_true = geometry::between(truth({21, 0}), truth({22, 0}));
  EXPECT_LT(geometry::between(T_true, proposal.T_other_own).position_m().norm(), 0.5);
  EXPECT_THROW(shared.accept(2), std::invalid_argument);
  shared.accept(1);
  EXPECT_TRUE(shared.joined("b"));
  EXPECT_EQ(shared.proposals().front().state, MergeProposal::State::kAccepted);
  EXPECT_THROW(shared.accept(1), std::invalid_argument);
  shared.finish();
  EXPECT_LT(largest_difference_m(both(), shared.trajectory()), 0.02);
}

TEST(SharedMap, WhatIsRefusedStaysApartAndIsAskedAgainForOtherPlacesOnly) {
  RememberingPool pool;
  SharedMap shared(asking(), pool);
  topomap::StopId refused{};
  topomap::StopId again{};
  for (const auto& map : in_turn(a().maps, b().maps)) {
    shared.add(map);
    if (shared.proposals().empty()) continue;
    if (refused.session == 0) {
      shared.refuse(1);
      refused = map->stop;
    } else if (again.session == 0 && shared.proposals().size() == 2) {
      again = map->stop;
    }
  }
  EXPECT_FALSE(shared.joined("b"));
  ASSERT_EQ(again.session, 22U);
  EXPECT_EQ(shared.proposals()[0].state, MergeProposal::State::kRefused);
  const double apart_m = (truth(again).position_m() - truth(refused).position_m()).norm();
  EXPECT_GE(apart_m, 9.5);
  EXPECT_LE(apart_m, 13.0);
}

TEST(SharedMap, RobotsOfOtherBuildingsStayApartAndTakeNoMoreMemoryThanTheyMay) {
  const RobotDrive room = robot_drive(test::drive(test::world("room"), {}), "room", 23);
  ASSERT_GT(room.maps.size(), 10U);
  constexpr std::size_t kMost = 6;
  RememberingPool pool;
  SharedMap shared({}, pool, nullptr, kMost);
  for (const auto& map : in_turn(a().maps, room.maps)) {
    shared.add(map);
    EXPECT_LE(shared.stops_apart(), kMost);
  }
  EXPECT_FALSE(shared.joined("room"));
  EXPECT_TRUE(shared.proposals().empty());
  EXPECT_EQ(shared.trajectory().stops.size(), a().maps.size());
}

TEST(SharedMap, GoesOnWithAStoredMapAndTheSessionsThatAreOnInIt) {
  const Maps all = in_turn(a().maps, b().maps);
  const std::size_t half = all.size() - 20;
  RememberingPool pool;
  SharedMap before({}, pool);
  for (std::size_t i = 0; i < half; ++i) before.add(all[i]);
  before.finish();  // all of them are numbered
  ASSERT_TRUE(before.joined("b"));
  RememberingPool other_pool;
  SharedMap after({}, other_pool, std::make_shared<const StoredMap>(before.map()));
  for (std::size_t i = half; i < all.size(); ++i) {
    after.add(all[i]);
    EXPECT_TRUE(after.joined(all[i]->robot_id)) << i;
  }
  after.finish();
  EXPECT_EQ(after.trajectory().stops.size(), all.size());
  EXPECT_LT(largest_difference_m(both(), after.trajectory()), 0.1);
}

TEST(SharedMap, AnotherSessionOfARobotIsADriveOfItsOwn) {
  RememberingPool pool;
  SharedMap shared({}, pool);
  for (const auto& map : a().maps) shared.add(map);
  for (const auto& given : b().maps) {
    topomap::LocalMap map = *given;
    map.robot_id = "a";
    shared.add(std::make_shared<const topomap::LocalMap>(map));
    if (map.id == 0) {
      EXPECT_FALSE(shared.joined("a"));
    }
  }
  EXPECT_TRUE(shared.joined("a"));
  shared.finish();
  EXPECT_LT(largest_difference_m(both(), shared.trajectory()), 0.02);
}

// Two robots drive the same corridor, each once a day. Drives within an hour are one time.
TEST(SharedMap, StopsGrowingWhenTheRobotsDriveTheSameWayEachDay) {
  constexpr std::size_t kPatrolStops = 24;
  constexpr std::uint64_t kPatrolDays = 6;
  constexpr std::int64_t kOneDay_ns = 86'400'000'000'000;
  RememberingPool pool;
  SharedMap shared({}, pool);
  std::size_t largest = 0;
  for (std::uint64_t day = 1; day <= kPatrolDays; ++day) {
    for (const std::string robot : {"a", "b"}) {
      for (std::size_t i = 0; i < kPatrolStops; ++i) {
        topomap::LocalMap map = *a().maps[i];
        map.robot_id = robot;
        map.stop.session = 2 * day + (robot == "a" ? 0 : 1);
        map.stamp_ns += static_cast<std::int64_t>(day) * kOneDay_ns;
        shared.add(std::make_shared<const topomap::LocalMap>(std::move(map)));
      }
      EXPECT_TRUE(shared.joined(robot)) << day;
    }
    largest = std::max(largest, shared.trajectory().stops.size());
  }
  shared.finish();
  const StoredMap map = shared.map();
  EXPECT_NO_THROW(check(map));
  // The oldest view, those of three times, and both present drives: as for one robot.
  EXPECT_LE(largest, 6 * kPatrolStops + kPatrolStops / 2);
  std::uint32_t views = 0;
  double largest_m = 0.0;
  const topomap::Trajectory& trajectory = map.trajectory;
  for (const topomap::StopPose& stop : trajectory.stops) {
    views += stop.views;
    const Pose2 T_true =
        geometry::between(a().T_world_robot[0], a().T_world_robot[stop.stop.number]);
    const Pose2 T = geometry::between(trajectory.stops.front().T_map_robot, stop.T_map_robot);
    largest_m = std::max(largest_m, geometry::between(T_true, T).position_m().norm());
  }
  EXPECT_EQ(views, 2 * kPatrolDays * kPatrolStops) << "nothing has gone that is not there any more";
  EXPECT_LT(largest_m, 0.15);
}

TEST(SharedMap, RefusesStopsOutOfTurnAndTheModeOfTheThesis) {
  RememberingPool pool;
  SharedMap shared({}, pool);
  shared.add(a().maps[0]);
  EXPECT_THROW(shared.add(a().maps[2]), std::invalid_argument);
  LocalizerConfig thesis;
  thesis.mode = SlamAlgorithm::kThesis;
  EXPECT_THROW(SharedMap(thesis, pool), std::invalid_argument);
}

// Each stop keeps its number until numbered_since changes.
TEST(SharedMap, NumbersOnlyChangeWithTheVersionThatSaysSo) {
  RememberingPool pool;
  SharedMap shared({}, pool);
  topomap::Trajectory before;
  std::size_t renumbered = 0;
  for (const auto& map : in_turn(a().maps, b().maps)) {
    shared.add(map);
    const topomap::Trajectory now = shared.trajectory();
    EXPECT_GT(now.version, before.version);
    if (now.numbered_since != before.numbered_since) {
      EXPECT_EQ(now.numbered_since, now.version);
      ++renumbered;
    } else {
      ASSERT_GE(now.stops.size(), before.stops.size());
      for (std::size_t i = 0; i < before.stops.size(); ++i) {
        EXPECT_EQ(now.stops[i].stop, before.stops[i].stop);
      }
    }
    before = now;
  }
  EXPECT_GE(renumbered, 1U);
  EXPECT_LE(renumbered, 1 + a().maps.size() / StopNumbers::kTogether);
}

}  // namespace
}  // namespace topogeo::localization
