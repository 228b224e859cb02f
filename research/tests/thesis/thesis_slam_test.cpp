#include "topogeo/thesis/thesis_slam.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "topogeo/matching/matcher.hpp"

#include "localization/simulated_maps.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;
using test::DrivenMaps;
using test::round_trip;

struct ThesisOutcome {
  topomap::Trajectory trajectory;
  std::vector<topomap::LoopClosure> closures;
  std::vector<LoopDecision> decisions;
  SlamCounts counts;
  int corrections = 0;  // steps that moved earlier poses
};

ThesisOutcome map_by_thesis(const test::Maps& maps, const ThesisSlamConfig& config = {}) {
  InProcessPool pool;
  ThesisSlam slam(config, pool);
  ThesisOutcome outcome;
  for (const auto& map : maps) outcome.corrections += slam.add(map) ? 1 : 0;
  slam.finish();
  outcome.trajectory = slam.trajectory();
  outcome.closures = slam.loop_closures();
  outcome.decisions = slam.loop_decisions();
  outcome.counts = slam.counts();
  return outcome;
}

double end_error_m(const ThesisOutcome& outcome, const DrivenMaps& driven) {
  const Pose2 found = outcome.trajectory.stops.back().T_map_robot;
  const Pose2 truth = geometry::between(driven.T_world_robot.front(), driven.T_world_robot.back());
  return (found.position_m() - truth.position_m()).norm();
}

TEST(ThesisSlam, ClosesTheCycleOfTheFloor) {
  const ThesisOutcome outcome = map_by_thesis(round_trip().maps);
  ASSERT_EQ(outcome.trajectory.stops.size(), round_trip().maps.size());
  EXPECT_EQ(outcome.trajectory.stops.front().T_map_robot, Pose2{});
  EXPECT_GT(outcome.corrections, 0);
  ASSERT_FALSE(outcome.closures.empty());
  for (const topomap::LoopClosure& closure : outcome.closures) {
    const Pose2 truth = geometry::between(round_trip().T_world_robot[closure.earlier_id],
                                          round_trip().T_world_robot[closure.later_id]);
    EXPECT_LT((closure.T_earlier_later.position_m() - truth.position_m()).norm(), 0.3);
  }
  ThesisSlamConfig open;
  open.revisit_matches = 0;
  const ThesisOutcome forward = map_by_thesis(round_trip().maps, open);
  EXPECT_TRUE(forward.closures.empty());
  EXPECT_EQ(forward.corrections, 0);
  EXPECT_LT(end_error_m(outcome, round_trip()), 0.3);
  EXPECT_LT(end_error_m(outcome, round_trip()), end_error_m(forward, round_trip()));
}

TEST(ThesisSlam, ExplainsEveryLoopThatItConsidered) {
  const ThesisOutcome outcome = map_by_thesis(round_trip().maps);
  std::size_t accepted = 0;
  for (const LoopDecision& decision : outcome.decisions) {
    EXPECT_LT(decision.earlier_id, decision.later_id);
    EXPECT_EQ(decision.step, decision.later_id);
    EXPECT_EQ(decision.outcome == LoopOutcome::kGate,
              decision.reason != Reason::kNone && decision.reason != Reason::kSecondSolution);
    if (decision.outcome == LoopOutcome::kAccepted) ++accepted;
  }
  EXPECT_GE(accepted, outcome.closures.size());
}

TEST(ThesisSlam, GivesTheSameBitsAgain) {
  const test::Maps maps(round_trip().maps.begin(), round_trip().maps.begin() + 40);
  const ThesisOutcome a = map_by_thesis(maps);
  const ThesisOutcome b = map_by_thesis(maps);
  EXPECT_EQ(a.trajectory.version, b.trajectory.version);
  for (std::size_t i = 0; i < maps.size(); ++i) {
    EXPECT_EQ(a.trajectory.stops[i].T_map_robot, b.trajectory.stops[i].T_map_robot);
    EXPECT_EQ(a.trajectory.stops[i].covariance, b.trajectory.stops[i].covariance);
  }
}

// A blind laser: nothing to match, so odometry remains.
TEST(ThesisSlam, GoesByOdometryWhereNothingMatches) {
  test::Maps maps;
  for (std::uint32_t id = 0; id < 3; ++id) {
    auto map = std::make_shared<topomap::LocalMap>();
    map->robot_id = "robot";
    map->id = id;
    map->T_odom_robot = {1.0 * id, 0.5 * id, 0.1 * id};
    maps.push_back(map);
  }
  const ThesisOutcome outcome = map_by_thesis(maps);
  const Eigen::Vector3d off =
      geometry::difference(outcome.trajectory.stops[2].T_map_robot, maps[2]->T_odom_robot);
  EXPECT_LT(off.norm(), 1e-12);
  EXPECT_EQ(outcome.counts.steps_in_doubt, 2U);
  EXPECT_GT(outcome.trajectory.stops[2].covariance(0, 0), 0.0);
}

TEST(ThesisSlam, RefusesMapsOutOfOrderOrOfAnotherRobot) {
  InProcessPool pool;
  ThesisSlam slam({}, pool);
  auto second = std::make_shared<topomap::LocalMap>();
  second->id = 1;
  EXPECT_THROW(slam.add(second), std::invalid_argument);
  slam.add(round_trip().maps[0]);
  second->robot_id = "another";
  EXPECT_THROW(slam.add(second), std::invalid_argument);
}

}  // namespace
}  // namespace topogeo::localization
