// Stops without scans, whose view is defined by nodes alone: a rectangle of 4 m by 2 m ahead.
#include "topogeo/thesis/thesis_map.hpp"

#include <memory>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "localization/hand_scenes.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;

std::shared_ptr<topomap::LocalMap> stop_at(std::uint32_t id, const Pose2& T_odom_robot) {
  auto map = std::make_shared<topomap::LocalMap>();
  map->robot_id = "robot";
  map->id = id;
  map->T_odom_robot = T_odom_robot;
  map->nodes = {test::node(4.0, -1.0, 1.0), test::node(4.0, 1.0, 1.0)};
  return map;
}

/// Stops 1 m apart along x, placed by odometry alone.
ThesisMap along_x(std::uint32_t stops) {
  ThesisMap map({}, 40);
  for (std::uint32_t i = 0; i < stops; ++i) {
    map.append(stop_at(i, {1.0 * i, 0.0, 0.0}));
    if (i == 0) {
      map.place_first();
    } else {
      map.place(i - 1, map.stop(i).T_previous_this, false);
    }
  }
  return map;
}

ThesisMatch match_with(std::uint32_t earlier, const Pose2& T_new_earlier) {
  ThesisMatch match;
  match.earlier = earlier;
  match.result.status = MatchStatus::kSolved;
  match.result.T_reference_query = T_new_earlier;
  match.result.fitness = 0.7;
  match.result.solutions = {{T_new_earlier, 0.9}, {{T_new_earlier.x_m + 1.0, 0.0, 0.0}, 0.6}};
  match.T_earlier_new = {geometry::inverse(T_new_earlier), 0.01 * Eigen::Matrix3d::Identity()};
  return match;
}

TEST(ThesisMap, PlacesStopsByTheirSteps) {
  const ThesisMap map = along_x(3);
  ASSERT_EQ(map.size(), 3U);
  EXPECT_NEAR(map.poses()[2].x_m, 2.0, 1e-12);
  EXPECT_NEAR(map.stop(2).path_m, 2.0, 1e-12);
  EXPECT_GT(map.pose_of(2).covariance(0, 0), map.pose_of(1).covariance(0, 0));
  EXPECT_EQ(map.pose_of(0).T_map_robot, Pose2{});
}

TEST(ThesisMap, RecentIsByTheDistanceDriven) {
  const ThesisMap map = along_x(10);  // recent: 6 m
  EXPECT_TRUE(map.recent(3, 9));
  EXPECT_FALSE(map.recent(2, 9));
}

TEST(ThesisMap, MapsOverlapWhereTheirRectanglesDo) {
  const ThesisMap map = along_x(7);
  EXPECT_TRUE(map.overlap_now(0, 4));  // 0 sees up to x = 4
  EXPECT_FALSE(map.overlap_now(0, 5));
}

// Without scan points no overlap is predicted: only the previous stop is worth a match.
TEST(ThesisMap, TheStopBeforeIsANeighbourInAnyCase) {
  const ThesisMap map = along_x(4);
  const auto neighbours = map.neighbours(3, map.poses()[3], map.relative_to(3));
  ASSERT_EQ(neighbours.size(), 1U);
  EXPECT_EQ(neighbours[0].id, 2U);
  EXPECT_NEAR(neighbours[0].T_new_earlier.T_a_b.x_m, -1.0, 1e-9);
}

TEST(ThesisMap, KeepsTheRefinedSolutionAndThoseElsewhere) {
  ThesisMap map = along_x(2);
  map.store(1, match_with(0, {-1.0, 0.0, 0.0}));
  const auto solutions = map.solutions().find(0, 1);
  ASSERT_EQ(solutions.size(), 2U);  // the first one is the refined one
  EXPECT_NEAR(solutions[0].T_earlier_later.x_m, 1.0, 1e-12);
  EXPECT_EQ(solutions[0].fitness, 0.7);
  EXPECT_NEAR(solutions[1].T_earlier_later.x_m, 0.0, 1e-12);
  EXPECT_EQ(solutions[1].fitness, 0.6);
}

TEST(ThesisMap, MovesAllPosesAndCountsTheVersion) {
  ThesisMap map = along_x(3);
  const std::uint64_t version = map.version();
  std::vector<Pose2> poses = map.poses();
  poses[2].y_m = 0.5;
  const double before = map.stop(2).covariance(0, 0);
  map.add_closure(2, match_with(0, {-2.0, 0.0, 0.0}));
  map.move(poses);
  EXPECT_EQ(map.poses()[2].y_m, 0.5);
  EXPECT_EQ(map.version(), version + 1);
  EXPECT_LT(map.stop(2).covariance(0, 0), before);  // the closure constrains it
}

TEST(ThesisMap, RefusesAStopOutOfTurnOrOfAnotherRobot) {
  ThesisMap map = along_x(2);
  EXPECT_THROW(map.append(stop_at(3, {})), std::invalid_argument);
  auto stranger = stop_at(2, {});
  stranger->robot_id = "another";
  EXPECT_THROW(map.append(stranger), std::invalid_argument);
  EXPECT_EQ(map.size(), 2U);
}

}  // namespace
}  // namespace topogeo::localization
