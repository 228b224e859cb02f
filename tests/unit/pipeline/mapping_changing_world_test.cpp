// Maps of floors that change while the robot drives: people walk about, doors open and close.
#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "topogeo/pipeline/mapping_run.hpp"
#include "topogeo/pipeline/trajectory_error.hpp"
#include "topogeo/simulation/simulate_log.hpp"
#include "topogeo/topomap/trajectory.hpp"
#include "topogeo/world/world.hpp"

namespace topogeo::pipeline {
namespace {

using geometry::Pose2;

/// A loop closure with a larger error confuses two places. Along a corridor with few features,
/// right ones err by some decimetres, which their covariance covers.
constexpr double kFalseLoop_m = 0.6;

struct Mapped {
  simulation::SimulatedLog log;
  storage::MapDocument document;
  TrajectoryError error;
  double worst_loop_m = 0.0;  ///< largest error of a loop closure
};

Mapped map_world(const world::World& world, std::size_t wanderers) {
  simulation::SimulationOptions options;
  options.wanderers = wanderers;
  Mapped mapped;
  mapped.log = simulation::simulate_log(world, options);
  MappingRun run(load_config({}).config, "robot1");
  std::vector<topomap::StampedPose> truth;
  for (std::size_t i = 0; i < mapped.log.scans.size(); ++i) {
    const scan::Scan& scan = mapped.log.scans[i];
    run.add(scan);
    truth.push_back({scan.sequence, scan.stamp_ns, mapped.log.T_world_robot[i]});
  }
  mapped.document = run.finish();
  mapped.error = trajectory_error(
      topomap::expand_trajectory(mapped.document.trajectory, mapped.document.local_maps), truth);
  const auto true_pose = [&](std::uint32_t id) {
    return mapped.log.T_world_robot.at(mapped.document.local_maps.at(id).sequence);
  };
  for (const topomap::LoopClosure& loop : mapped.document.loop_closures) {
    const Pose2 T_true = geometry::between(true_pose(loop.earlier_id), true_pose(loop.later_id));
    mapped.worst_loop_m = std::max(
        mapped.worst_loop_m, (loop.T_earlier_later.position_m() - T_true.position_m()).norm());
  }
  return mapped;
}

/// Total length of the real branches in the map, metres.
double branch_length_m(const topomap::GlobalMap& map) {
  double length_m = 0.0;
  for (const topomap::MapBranch& branch : map.branches) {
    for (std::size_t i = 1; !branch.is_virtual && i < branch.points.size(); ++i) {
      length_m += (branch.points[i].position_m - branch.points[i - 1].position_m).norm();
    }
  }
  return length_m;
}

/// Real nodes, in the frame of the world, within `reach_m` of a point.
std::size_t nodes_near(const Mapped& mapped, const Eigen::Vector2d& point_m, double reach_m) {
  const Pose2 T_world_map = mapped.log.T_world_robot.front();
  std::size_t count = 0;
  for (const topomap::MapNode& node : mapped.document.global_map.nodes) {
    if (((T_world_map * node.position_m) - point_m).norm() < reach_m) ++count;
  }
  return count;
}

world::World floor_world() {
  return world::load_world(std::filesystem::path(TOPOGEO_SHARE) / "worlds/floor.world.yaml");
}

TEST(ChangingWorldTest, PeopleWhoWalkAboutNeitherBendTheMapNorEnterIt) {
  const world::World world = floor_world();
  const Mapped empty = map_world(world, 0);
  const Mapped busy = map_world(world, 5);
  EXPECT_LT(busy.error.rms_m, 1.5 * empty.error.rms_m + 0.02);
  EXPECT_GE(busy.document.loop_closures.size(), 5U);
  EXPECT_LT(busy.worst_loop_m, kFalseLoop_m);
  // A person who remained in the map would split a corridor into two ways round them.
  const double length_m = branch_length_m(empty.document.global_map);
  EXPECT_NEAR(branch_length_m(busy.document.global_map), length_m, 0.1 * length_m);
}

// A corridor driven back and forth twice (18 m each way), with a room behind a door in its northern
// wall at x = 10.
std::string corridor(const std::string& door) {
  return "name: corridor with a door\n"
         "walls:\n"
         "  - {from: [0, 0], to: [20, 0]}\n"
         "  - {from: [0, 2.2], to: [20, 2.2], doors: [" +
         door +
         "]}\n"
         "  - {from: [0, 0], to: [0, 2.2]}\n"
         "  - {from: [20, 0], to: [20, 2.2]}\n"
         "  - {from: [7, 2.2], to: [7, 6]}\n"
         "  - {from: [13, 2.2], to: [13, 6]}\n"
         "  - {from: [7, 6], to: [13, 6]}\n"
         "boxes:\n"
         "  - {from: [4, 0], to: [4.8, 0.3]}\n"
         "  - {from: [15, 1.9], to: [16.2, 2.2]}\n"
         "  - {from: [8, 5], to: [9, 6]}\n"
         "tour: [[1, 1.1], [19, 1.1], [1, 1.1], [19, 1.1], [1, 1.1]]\n";
}

TEST(ChangingWorldTest, ADoorThatOpensLaterEntersTheMapAndDoesNotBendIt) {
  const auto mapped = [](const std::string& door) {
    return map_world(world::parse_world(corridor(door), "test"), 0);
  };
  const Mapped shut = mapped("{at: 10, width: 1.0, open: []}");
  // Shut on the first of the four passes: a branch needs 40 % of the votes of the newest views, and
  // half of the passes is too close to that to be distinguished from noise.
  const Mapped opened = mapped("{at: 10, width: 1.0, open: [[18, 200]]}");
  const Mapped open = mapped("{at: 10, width: 1.0}");
  for (const Mapped* m : {&shut, &opened, &open}) {
    EXPECT_LT(m->worst_loop_m, kFalseLoop_m);
  }
  EXPECT_LT(opened.error.rms_m, 1.5 * open.error.rms_m + 0.02);
  // Junction of the corridor and the path through the door.
  const Eigen::Vector2d junction_m(10.0, 1.1);
  EXPECT_EQ(nodes_near(shut, junction_m, 0.5), 0U);
  EXPECT_GT(nodes_near(open, junction_m, 0.5), 0U);
  EXPECT_GT(nodes_near(opened, junction_m, 0.5), 0U);
}

}  // namespace
}  // namespace topogeo::pipeline
