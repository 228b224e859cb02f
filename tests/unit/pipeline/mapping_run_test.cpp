#include "topogeo/pipeline/mapping_run.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "topogeo/pipeline/localization_run.hpp"
#include "topogeo/pipeline/path_disagreement.hpp"
#include "topogeo/pipeline/trajectory_error.hpp"
#include "topogeo/results/outputs.hpp"
#include "topogeo/simulation/simulate_log.hpp"
#include "topogeo/storage/map_file.hpp"
#include "topogeo/topomap/trajectory.hpp"
#include "topogeo/world/world.hpp"

namespace topogeo::pipeline {
namespace {

using topomap::StampedPose;

simulation::SimulatedLog simulated(const std::string& world) {
  return simulation::simulate_log(
      world::load_world(std::filesystem::path(TOPOGEO_SHARE) / "worlds" / (world + ".world.yaml")),
      {});
}

storage::MapDocument mapped(const simulation::SimulatedLog& log) {
  MappingRun run(load_config({}).config, "robot1");
  for (const scan::Scan& scan : log.scans) run.add(scan);
  return run.finish();
}

struct Errors {
  TrajectoryError odometry;
  TrajectoryError corrected;
};

Errors errors_of(const simulation::SimulatedLog& log, const storage::MapDocument& document) {
  std::vector<StampedPose> truth;
  for (std::size_t i = 0; i < log.scans.size(); ++i) {
    truth.push_back({log.scans[i].sequence, log.scans[i].stamp_ns, log.T_world_robot[i]});
  }
  return {trajectory_error(topomap::expand_odometry(document.local_maps), truth),
          trajectory_error(topomap::expand_trajectory(document.trajectory, document.local_maps),
                           truth)};
}

TEST(MappingRunTest, CorrectsTheRoundThroughARoom) {
  const simulation::SimulatedLog log = simulated("room");
  const storage::MapDocument document = mapped(log);
  const Errors errors = errors_of(log, document);
  EXPECT_LT(errors.corrected.rms_m, 0.05);
  EXPECT_LT(errors.corrected.rms_m, 0.5 * errors.odometry.rms_m);
  EXPECT_FALSE(document.global_map.branches.empty());
}

// --- odometry that the scans contradict

/// The log with `more` added to the odometry of each of these steps between scans.
simulation::SimulatedLog with_steps(simulation::SimulatedLog log, std::size_t first,
                                    std::size_t steps, const geometry::Pose2& more) {
  const std::vector<scan::Scan> recorded = log.scans;
  for (std::size_t i = first; i < log.scans.size(); ++i) {
    geometry::Pose2 step = between(recorded[i - 1].T_odom_robot, recorded[i].T_odom_robot);
    if (i < first + steps) step = step * more;
    log.scans[i].T_odom_robot = log.scans[i - 1].T_odom_robot * step;
  }
  return log;
}

bool has_disagreement(const storage::MapDocument& document, PathDisagreement::Kind kind) {
  return std::ranges::any_of(compare_with_odometry(document).disagreements,
                             [&](const PathDisagreement& d) { return d.kind == kind; });
}

TEST(MappingRunTest, WheelsThatSpinDoNotBendTheMap) {
  const simulation::SimulatedLog sound = simulated("room");
  const simulation::SimulatedLog log =
      with_steps(sound, sound.scans.size() / 2, 5, {0.4, 0.0, 0.0});
  const storage::MapDocument document = mapped(log);
  const Errors errors = errors_of(log, document);
  EXPECT_LT(errors.corrected.rms_m, 0.05);
  EXPECT_TRUE(has_disagreement(document, PathDisagreement::Kind::kWheels));
  EXPECT_FALSE(has_disagreement(mapped(sound), PathDisagreement::Kind::kWheels));
}

TEST(MappingRunTest, TheMapKeepsTheMeasurementsThatHoldItsPoses) {
  const storage::MapDocument document = mapped(simulated("room"));
  using Kind = storage::MapEdge::Kind;
  const auto is_there = [&](Kind kind, std::uint32_t earlier, std::uint32_t later) {
    return std::ranges::any_of(document.edges, [&](const storage::MapEdge& edge) {
      return edge.kind == kind && edge.earlier_id == earlier && edge.later_id == later;
    });
  };
  for (std::uint32_t i = 1; i < document.local_maps.size(); ++i) {
    EXPECT_TRUE(is_there(Kind::kOdometry, i - 1, i)) << i;
  }
  EXPECT_FALSE(document.loop_closures.empty());
  for (const topomap::LoopClosure& loop : document.loop_closures) {
    EXPECT_TRUE(is_there(Kind::kLoop, loop.earlier_id, loop.later_id));
  }
  // Least squares recovers the poses, starting from those of odometry alone.
  localization::PoseGraph graph;
  const std::vector<topomap::StopPose>& stops = document.trajectory.stops;
  for (const topomap::LocalMap& map : document.local_maps) {
    graph.add_pose(geometry::between(document.local_maps[0].T_odom_robot, map.T_odom_robot));
  }
  for (const auto& edge : pose_graph_edges(document.edges)) {
    EXPECT_GT(edge.covariance.determinant(), 0.0);
    graph.add_edge(edge);
  }
  EXPECT_TRUE(graph.optimize().usable);
  for (std::size_t i = 0; i < stops.size(); ++i) {
    const geometry::Pose2 apart = geometry::between(graph.poses()[i], stops[i].T_map_robot);
    EXPECT_LT(apart.position_m().norm(), 0.005) << i;
    EXPECT_LT(std::abs(apart.theta_rad), 0.003) << i;
  }
  // A continued map has them, too: the earlier ones and new ones.
  const auto stored = stored_map(document);
  EXPECT_EQ(map_edges(stored->edges), document.edges);
}

TEST(MappingRunTest, ClosesTheLoopOfTheFloor) {
  const simulation::SimulatedLog log = simulated("floor");
  const storage::MapDocument document = mapped(log);
  const Errors errors = errors_of(log, document);
  EXPECT_GT(errors.odometry.rms_m, 1.0) << "the world is no test of the correction any more";
  EXPECT_LT(errors.corrected.rms_m, 0.15);
  EXPECT_LT(errors.corrected.largest_m, 0.5);
  EXPECT_GE(document.loop_closures.size(), 5U);
}

TEST(MappingRunTest, OdometryThatRestartsLeavesTheMapWhole) {
  simulation::SimulatedLog log = simulated("room");
  const std::size_t stops = mapped(log).local_maps.size();
  const std::size_t middle = log.scans.size() / 2;
  const geometry::Pose2 T_odom_restart = log.scans[middle].T_odom_robot;
  for (std::size_t i = middle; i < log.scans.size(); ++i) {
    scan::Scan& scan = log.scans[i];
    scan.T_odom_robot = geometry::between(T_odom_restart, scan.T_odom_robot);
    ++scan.odometry_epoch;
  }
  const storage::MapDocument document = mapped(log);
  EXPECT_NEAR(static_cast<double>(document.local_maps.size()), static_cast<double>(stops), 2.0);
  EXPECT_EQ(document.local_maps.back().stop.session, document.local_maps.front().stop.session);
  EXPECT_LT(errors_of(log, document).corrected.rms_m, 0.05);
  // The odometry in the map is that of the robot.
  EXPECT_EQ(document.local_maps.back().T_odom_robot, log.scans.back().T_odom_robot);
  EXPECT_EQ(document.local_maps.back().odometry_epoch, log.scans.back().odometry_epoch);
}

TEST(MappingRunTest, TrajectoryHasOnePosePerScanInOrder) {
  const simulation::SimulatedLog log = simulated("room");
  const storage::MapDocument document = mapped(log);
  const auto poses = topomap::expand_trajectory(document.trajectory, document.local_maps);
  ASSERT_EQ(poses.size(), log.scans.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_EQ(poses[i].sequence, log.scans[i].sequence);
    EXPECT_EQ(poses[i].stamp_ns, log.scans[i].stamp_ns);
  }
}

TEST(MappingRunTest, GivesTheSameBytesTwice) {
  const simulation::SimulatedLog log = simulated("room");
  EXPECT_EQ(storage::map_file_bytes(mapped(log)), storage::map_file_bytes(mapped(log)));
}

TEST(MappingRunTest, AnotherSeedGivesAnotherMapFile) {
  const simulation::SimulatedLog log = simulated("room");
  Config config = load_config({}).config;
  config.localizer.seed = 2;
  MappingRun run(config, "robot1");
  for (const scan::Scan& scan : log.scans) run.add(scan);
  EXPECT_EQ(run.finish().seed, 2U);
}

TEST(MappingRunTest, StagesAreThoseOfTheServices) {
  MappingRun run(load_config({}).config, "robot1");
  for (const scan::Scan& scan : simulated("room").scans) run.add(scan);
  (void)run.finish();
  std::vector<std::string> names;
  for (const support::StageTime& stage : run.stages()) names.push_back(stage.stage);
  EXPECT_EQ(names, (std::vector<std::string>{"local_mapper", "localizer", "map_store"}));
  EXPECT_GT(run.match_counts().tasks, 0U);
}

}  // namespace
}  // namespace topogeo::pipeline
