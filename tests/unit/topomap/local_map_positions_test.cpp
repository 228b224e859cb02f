// Positions of door nodes between the cells: better than 2 cm on a grid of 5 cm.
#include <algorithm>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "figure_maps.hpp"

namespace topogeo::topomap {
namespace {

using geometry::Pose2;

struct DoorScene {
  std::string text;  ///< in the format of world files
  Eigen::Vector2d laser_m;
  Eigen::Vector2d door_m;
};

TEST(SubcellPositions, DoorNodesAreBetterThanTwoCentimetres) {
  const DoorScene scenes[] = {// A corridor with a door on the left, a wall of the room behind it.
                              {R"(name: door on the left
walls: [{from: [-9, 1.12], to: [0.43, 1.12]}, {from: [1.35, 1.12], to: [9, 1.12]},
        {from: [-9, -0.91], to: [9, -0.91]}, {from: [1.1, 2.31], to: [9, 2.31]}]
boxes: [{from: [-9, -9], to: [9, 9]}])",
                               {0.0, 0.1},
                               {0.89, 1.12}},
                              // A room with a door ahead, a wall behind it.
                              {R"(name: door ahead
walls: [{from: [-9, 2], to: [2, 2]}, {from: [2, 2], to: [2, 0.45]}, {from: [-9, -2], to: [2, -2]},
        {from: [2, -2], to: [2, -0.45]}, {from: [4, -3], to: [4, 3]}]
boxes: [{from: [-9, -9], to: [9, 9]}])",
                               {0.7, 0.1},
                               {2.0, 0.0}}};
  voronoi::VoronoiConfig config = figure_scenes::source_config();
  config.join_hidden_zones = false;
  for (const DoorScene& scene : scenes) {
    const world::World world = world::parse_world(scene.text, "scene");
    SCOPED_TRACE(world.name);
    std::mt19937 random(17);
    const auto uniform = [&](double half) {
      return half * (static_cast<double>(random()) / 2147483648.0 - 1.0);
    };
    int count = 0;
    double sum_m = 0.0;
    double largest_m = 0.0;
    for (int place = 0; place < 60; ++place) {
      const Pose2 T_world_laser{scene.laser_m.x() + uniform(0.3), scene.laser_m.y() + uniform(0.3),
                                uniform(0.5)};
      const auto made = figure_scenes::make_map(figure_scenes::scan_of(world, T_world_laser),
                                                config, figure_scenes::source_map_config());
      for (const LocalNode& node : made.map.nodes) {
        if (node.kind != NodeKind::kDoor) continue;
        const double error_m = (T_world_laser * node.position_m - scene.door_m).norm();
        ++count;
        sum_m += error_m;
        largest_m = std::max(largest_m, error_m);
      }
    }
    EXPECT_GE(count, 45);
    EXPECT_LT(largest_m, 0.02) << "mean " << sum_m / count;
  }
}

}  // namespace
}  // namespace topogeo::topomap
