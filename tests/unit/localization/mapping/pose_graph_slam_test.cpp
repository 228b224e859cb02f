#include "topogeo/slam/pose_graph_slam.hpp"

#include <array>
#include <chrono>
#include <cmath>
#include <future>
#include <memory>
#include <set>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "topogeo/matching/matcher.hpp"
#include "topogeo/slam/graph_optimization.hpp"

#include "localization/hand_scenes.hpp"
#include "localization/simulated_maps.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;
using test::DrivenMaps;
using test::round_trip;

struct Outcome {
  topomap::Trajectory trajectory;
  std::vector<topomap::LoopClosure> closures;
  SlamCounts counts;
  int corrections = 0;  // steps that moved earlier poses
};

Outcome map_drive(const test::Maps& maps, MatchPool& pool, const LocalizerConfig& config = {}) {
  PoseGraphSlam slam(config, pool);
  Outcome outcome;
  for (const auto& map : maps) outcome.corrections += slam.add(map) ? 1 : 0;
  slam.finish();
  outcome.trajectory = slam.trajectory();
  outcome.closures = slam.loop_closures();
  outcome.counts = slam.counts();
  return outcome;
}

Outcome map_drive(const test::Maps& maps, const LocalizerConfig& config = {}) {
  InProcessPool pool;
  return map_drive(maps, pool, config);
}

// Root mean square position error when the first poses coincide.
double position_error_m(const std::vector<Pose2>& poses, const std::vector<Pose2>& truth) {
  double sum = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    sum += (geometry::between(poses[0], poses[i]).position_m() -
            geometry::between(truth[0], truth[i]).position_m())
               .squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(truth.size()));
}

std::vector<Pose2> poses_of(const topomap::Trajectory& trajectory) {
  std::vector<Pose2> poses;
  for (const topomap::StopPose& stop : trajectory.stops) poses.push_back(stop.T_map_robot);
  return poses;
}

void expect_same(const Outcome& a, const Outcome& b) {
  ASSERT_EQ(a.trajectory.stops.size(), b.trajectory.stops.size());
  EXPECT_EQ(a.trajectory.version, b.trajectory.version);
  for (std::size_t i = 0; i < a.trajectory.stops.size(); ++i) {
    ASSERT_EQ(a.trajectory.stops[i].T_map_robot, b.trajectory.stops[i].T_map_robot) << i;
    ASSERT_EQ(a.trajectory.stops[i].covariance, b.trajectory.stops[i].covariance) << i;
  }
  ASSERT_EQ(a.closures.size(), b.closures.size());
  for (std::size_t i = 0; i < a.closures.size(); ++i) {
    EXPECT_EQ(a.closures[i].earlier_id, b.closures[i].earlier_id);
    EXPECT_EQ(a.closures[i].T_earlier_later, b.closures[i].T_earlier_later);
  }
  EXPECT_EQ(a.counts.evaluations, b.counts.evaluations);
  EXPECT_EQ(a.counts.reasons, b.counts.reasons);
}

/// Expects the last stop of a drive through the room at its true place, though odometry errs in the
/// unmapped step to it; returns the status.
LocalizationStatus expect_placed(const std::vector<Pose2>& truth, const Pose2& odometry_error) {
  const world::World room = test::world("room");
  InProcessPool pool;
  PoseGraphSlam slam({}, pool);
  for (std::uint32_t id = 0; id < truth.size(); ++id) {
    auto map = std::make_shared<topomap::LocalMap>(test::map_at(room, truth[id], id));
    if (id > 0) map->T_previous_robot = geometry::between(truth[id - 1], truth[id]);
    if (id + 1 == truth.size()) map->T_odom_robot = map->T_odom_robot * odometry_error;
    slam.add(std::move(map));
  }
  const Pose2 T_map_robot = slam.trajectory().stops.back().T_map_robot;
  EXPECT_LT(geometry::difference(T_map_robot, geometry::between(truth[0], truth.back())).norm(),
            0.3);
  return slam.status();
}

// The robot turns at its destination and drives back unmapped: its next view shares little with the
// last ones, and a corner of the room looks alike after a quarter turn.
TEST(PoseGraphSlamTest, ALookAlikeFarFromGoodOdometryDoesNotCount) {
  for (double back_m = 0.6; back_m <= 1.81; back_m += 0.1) {
    SCOPED_TRACE(back_m);
    expect_placed({{1.0, 1.0, 0.0},
                   {2.0, 1.0, -0.1},
                   {3.0, 0.95, 0.0},
                   {4.0, 1.0, 0.15},
                   {4.0, 1.0, 0.5},
                   {4.0, 1.0, 0.85},
                   {4.0, 1.0, 1.15},
                   {4.0 - back_m, 1.02, 3.13}},
                  {});
  }
}

constexpr Pose2 kOdometryError{0.1, -0.1, 0.1};

// The robot turns where the drive began, then drives on unmapped: at its new place the previous
// stop shows little, the first ones much.
TEST(PoseGraphSlamTest, AfterALongStepThatNobodyMappedThePlaceIsKnownByStopsBefore) {
  for (double last_rad = -2.0; last_rad >= -3.05; last_rad -= 0.15) {
    std::vector<Pose2> truth;
    for (double theta_rad = 0.0; theta_rad > last_rad; theta_rad -= 0.35) {
      truth.push_back({1.0, 1.0, theta_rad});
    }
    truth.push_back({1.0, 1.0, last_rad});
    truth.push_back({4.0, 1.0, 0.12});
    SCOPED_TRACE(last_rad);
    EXPECT_EQ(expect_placed(truth, kOdometryError).state, LocalizationState::kTracking);
  }
}

// The same with the stops that show the place further back than those that each stop is compared
// with: the robot was there, turned, drove back, and returns unmapped.
TEST(PoseGraphSlamTest, AfterALongStepThatNobodyMappedThePlaceIsKnownByAnEarlierVisit) {
  for (double last_rad = -0.3; last_rad <= 0.31; last_rad += 0.1) {
    std::vector<Pose2> truth = {{1.0, 1.0, 0.0}, {2.0, 1.0, -0.05}, {3.0, 0.93, 0.0}};
    for (double theta_rad = 0.15; theta_rad < 3.05; theta_rad += 0.36) {
      truth.push_back({4.0, 1.0, theta_rad});
    }
    truth.insert(truth.end(), {{3.0, 0.93, 3.13}, {2.0, 0.97, 3.04}, {1.0, 1.0, 3.14}});
    truth.push_back({4.0, 1.0, last_rad});
    SCOPED_TRACE(last_rad);
    EXPECT_EQ(expect_placed(truth, kOdometryError).state, LocalizationState::kTracking);
  }
}

TEST(PoseGraphSlamTest, ClosesTheLoopOfTheSimulatedFloor) {
  const DrivenMaps& driven = round_trip();
  ASSERT_GT(driven.maps.size(), 80U);
  const Outcome outcome = map_drive(driven.maps);
  std::vector<Pose2> odometry;
  for (const auto& map : driven.maps) odometry.push_back(map->T_odom_robot);
  const double before_m = position_error_m(odometry, driven.T_world_robot);
  const double after_m = position_error_m(poses_of(outcome.trajectory), driven.T_world_robot);
  EXPECT_GT(before_m, 1.0);
  EXPECT_LT(after_m, 0.25);
  EXPECT_LT(after_m, 0.1 * before_m);

  EXPECT_GE(outcome.closures.size(), 5U);
  EXPECT_GE(outcome.corrections, 1);
  EXPECT_EQ(outcome.counts.removed_loops, 0U);
  for (const topomap::LoopClosure& loop : outcome.closures) {
    const Pose2 truth = geometry::between(driven.T_world_robot[loop.earlier_id],
                                          driven.T_world_robot[loop.later_id]);
    EXPECT_LT(loop.earlier_id, loop.later_id);
    EXPECT_LT(test::distance_m(loop.T_earlier_later, truth), 0.5)
        << loop.earlier_id << " - " << loop.later_id;
  }
  std::uint64_t judged = 0;
  for (const std::uint64_t count : outcome.counts.reasons) judged += count;
  EXPECT_EQ(judged, outcome.counts.tasks);
  for (std::size_t i = 0; i < driven.maps.size(); ++i) {
    const topomap::StopPose& stop = outcome.trajectory.stops[i];
    EXPECT_EQ(stop.local_map_id, i);
    EXPECT_EQ(stop.stamp_ns, driven.maps[i]->stamp_ns);
    if (i > 0) {
      EXPECT_GT(stop.covariance.diagonal().minCoeff(), 0.0);
    }
  }
  EXPECT_EQ(outcome.trajectory.stops[0].T_map_robot, Pose2{});
}

// The scale of odometry was still unknown on the first steps.
TEST(PoseGraphSlamTest, InTheEndAllStepsHaveTheScaleThatWasLearnedOnTheDrive) {
  const test::Maps& maps = round_trip().maps;
  InProcessPool pool;
  PoseGraphSlam slam({}, pool);
  for (const auto& map : maps) slam.add(map);
  const auto scales = [&] {
    std::vector<double> ratios;
    for (const PoseGraphEdge& edge : slam.graph().edges()) {
      if (edge.kind != EdgeKind::kOdometry) continue;
      const Pose2 recorded =
          geometry::between(maps[edge.from]->T_odom_robot, maps[edge.to]->T_odom_robot);
      const double recorded_m = recorded.position_m().norm();
      if (recorded_m > 0.1) ratios.push_back(edge.T_from_to.position_m().norm() / recorded_m);
    }
    return ratios;
  };
  ASSERT_NEAR(scales().front(), 1.0, 1e-9);
  const double learned = scales().back();
  ASSERT_GT(std::fabs(learned - 1.0), 1e-4);
  slam.finish();
  for (const double scale : scales()) EXPECT_NEAR(scale, learned, 1e-9);
}

TEST(PoseGraphSlamTest, WithoutRevisitsNoLoopIsClosed) {
  LocalizerConfig config;
  config.revisit_matches = 0;
  const Outcome outcome = map_drive(round_trip().maps, config);
  EXPECT_TRUE(outcome.closures.empty());
  EXPECT_EQ(outcome.corrections, 0);
}

TEST(PoseGraphSlamTest, AStepWithoutALoopTouchesNothingOld) {
  InProcessPool pool;
  PoseGraphSlam slam({}, pool);
  topomap::Trajectory before;
  int untouched = 0;
  for (const auto& map : round_trip().maps) {
    const bool moved = slam.add(map);
    topomap::Trajectory after = slam.trajectory();
    for (std::size_t i = 0; !moved && i < before.stops.size(); ++i) {
      ASSERT_EQ(after.stops[i].T_map_robot, before.stops[i].T_map_robot) << i;
      ASSERT_EQ(after.stops[i].covariance, before.stops[i].covariance) << i;
    }
    untouched += moved ? 0 : 1;
    before = std::move(after);
  }
  EXPECT_GT(untouched, 60);
}

// Solves the job at once, in a thread of its own, or only when the solution is fetched.
class LateOptimizer : public GraphOptimizer {
 public:
  void start(GraphProblem problem) override {
    ++jobs;
    const auto when = jobs % 3 == 1 ? std::launch::deferred : std::launch::async;
    job_ = std::async(when, [problem = std::move(problem)] { return solve(problem); });
    if (jobs % 3 == 0) job_.wait();
  }
  GraphSolution fetch() override { return job_.get(); }
  int jobs = 0;

 private:
  std::future<GraphSolution> job_;
};

TEST(PoseGraphSlamTest, HowLongTheOptimizationTakesDoesNotMatter) {
  LateOptimizer late;
  InProcessPool pool;
  PoseGraphSlam slam({}, pool, &late);
  Outcome outcome;
  for (const auto& map : round_trip().maps) outcome.corrections += slam.add(map) ? 1 : 0;
  slam.finish();
  outcome.trajectory = slam.trajectory();
  outcome.closures = slam.loop_closures();
  outcome.counts = slam.counts();
  EXPECT_GT(late.jobs, 3);
  expect_same(outcome, map_drive(round_trip().maps));
}

TEST(PoseGraphSlamTest, EveryLoopIsExplained) {
  InProcessPool pool;
  PoseGraphSlam slam({}, pool);
  for (const auto& map : round_trip().maps) slam.add(map);
  slam.finish();
  std::set<std::pair<std::uint32_t, std::uint32_t>> standing;
  std::size_t refused = 0;
  for (const LoopDecision& decision : slam.loop_decisions()) {
    const std::pair loop{decision.earlier_id, decision.later_id};
    EXPECT_LT(decision.earlier_id, decision.later_id);
    EXPECT_LE(decision.later_id, decision.step);
    if (decision.outcome == LoopOutcome::kAccepted) {
      EXPECT_EQ(decision.reason, Reason::kNone);
      standing.insert(loop);
    } else if (decision.outcome == LoopOutcome::kOutvoted) {
      standing.erase(loop);
    } else {
      ++refused;
      EXPECT_EQ(decision.outcome == LoopOutcome::kGate, decision.reason != Reason::kNone);
    }
  }
  EXPECT_GT(refused, 0U);
  std::set<std::pair<std::uint32_t, std::uint32_t>> closed;
  for (const topomap::LoopClosure& loop : slam.loop_closures()) {
    closed.emplace(loop.earlier_id, loop.later_id);
  }
  EXPECT_EQ(standing, closed);
}

// Answers every batch backwards, each task on one of two alternating matchers.
class TwoWorkersBackwards : public MatchPool {
 public:
  void add_map(std::shared_ptr<const topomap::LocalMap> map) override {
    for (Matcher& worker : workers_) worker.add_map(*map);
  }
  std::vector<MatchResult> match(std::span<const MatchTask> tasks) override {
    std::vector<MatchResult> results(tasks.size());
    for (std::size_t i = tasks.size(); i-- > 0;) results[i] = workers_[turn_++ % 2].solve(tasks[i]);
    return results;
  }

 private:
  std::array<Matcher, 2> workers_;
  std::size_t turn_ = 0;
};

TEST(PoseGraphSlamTest, TheResultDependsNeitherOnTheRunNorOnWhoAnswersInWhichOrder) {
  const test::Maps& maps = round_trip().maps;
  const Outcome once = map_drive(maps);
  expect_same(once, map_drive(maps));
  TwoWorkersBackwards pool;
  expect_same(once, map_drive(maps, pool));

  LocalizerConfig other_seed;
  other_seed.seed = 2;
  EXPECT_NE(map_drive(maps, other_seed).trajectory.stops.back().T_map_robot,
            once.trajectory.stops.back().T_map_robot);
}

TEST(PoseGraphSlamTest, RefusesMapsOutOfOrderAndOfAnotherRobot) {
  const world::World room = test::world("room");
  const auto map = [&](std::uint32_t id, const char* robot) {
    topomap::LocalMap made = test::map_at(room, {1.0 + 0.5 * id, 1.0, 0.0}, id);
    made.robot_id = robot;
    return std::make_shared<const topomap::LocalMap>(std::move(made));
  };
  InProcessPool pool;
  PoseGraphSlam slam({}, pool);
  EXPECT_THROW(slam.add(map(1, "robot")), std::invalid_argument);
  slam.add(map(0, "robot"));
  EXPECT_THROW(slam.add(map(0, "robot")), std::invalid_argument);
  EXPECT_THROW(slam.add(map(2, "robot")), std::invalid_argument);
  EXPECT_THROW(slam.add(map(1, "stranger")), std::invalid_argument);
  EXPECT_EQ(slam.trajectory().stops.size(), 1U);
  EXPECT_NO_THROW(slam.add(map(1, "robot")));
  EXPECT_NEAR(slam.trajectory().stops[1].T_map_robot.x_m, 0.5, 0.05);
}

TEST(PoseGraphSlamTest, NothingOrOneStopIsNoError) {
  InProcessPool pool;
  PoseGraphSlam slam({}, pool);
  slam.finish();
  EXPECT_TRUE(slam.trajectory().stops.empty());
  slam.add(round_trip().maps[0]);
  slam.finish();
  EXPECT_EQ(slam.trajectory().stops.size(), 1U);
  EXPECT_TRUE(slam.loop_closures().empty());
}

TEST(PoseGraphSlamTest, TheVersionGrowsWithEveryStep) {
  InProcessPool pool;
  PoseGraphSlam slam({}, pool);
  std::uint64_t version = 0;
  for (std::size_t i = 0; i < 12; ++i) {
    slam.add(round_trip().maps[i]);
    EXPECT_GT(slam.trajectory().version, version);
    version = slam.trajectory().version;
  }
}

// The robot drives round the first half of the floor and back; then its scans come from a closed
// room of another building while its odometry follows the first corridor again.
TEST(PoseGraphSlamTest, ScansOfAnotherWorldCloseNoLoop) {
  const DrivenMaps floor = test::drive(
      test::world("floor"), {{1.3, 1.2}, {15.0, 1.15}, {16.0, 1.2}, {15.0, 1.15}, {1.3, 1.2}});
  const DrivenMaps room = test::drive(test::world("room"), {});
  test::Maps maps = floor.maps;
  const Pose2 T_odom_kidnapped = floor.maps.back()->T_odom_robot;
  for (const auto& map : room.maps) {
    topomap::LocalMap moved = *map;
    moved.id = static_cast<std::uint32_t>(maps.size());
    moved.T_odom_robot = T_odom_kidnapped * map->T_odom_robot;
    for (topomap::TrackedScan& scan : moved.track) {
      scan.T_odom_robot = T_odom_kidnapped * scan.T_odom_robot;
    }
    maps.push_back(std::make_shared<const topomap::LocalMap>(std::move(moved)));
  }
  const Outcome outcome = map_drive(maps);
  const auto first_of_room = static_cast<std::uint32_t>(floor.maps.size());
  for (const topomap::LoopClosure& loop : outcome.closures) {
    EXPECT_FALSE(loop.earlier_id < first_of_room && loop.later_id >= first_of_room)
        << loop.earlier_id << " - " << loop.later_id;
  }
  // The path there and back is still closed.
  EXPECT_FALSE(outcome.closures.empty());
}

}  // namespace
}  // namespace topogeo::localization
