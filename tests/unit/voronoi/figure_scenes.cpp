#include "figure_scenes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include <gtest/gtest.h>

namespace topogeo::figure_scenes {
namespace {

/// Readings are stored as float: points farther from a surface than this are not on it.
constexpr double kOnSurface_m = 1e-4;

double distance_m(const world::Segment& segment, const Eigen::Vector2d& point_m) {
  const Eigen::Vector2d along = segment.b_m - segment.a_m;
  const double t = std::clamp((point_m - segment.a_m).dot(along) / along.squaredNorm(), 0.0, 1.0);
  return (segment.a_m + t * along - point_m).norm();
}

/// Letters of the surfaces that contain a point: two in a corner.
std::string surfaces_at(const world::World& world, const Eigen::Vector2d& point_m) {
  std::string letters;
  for (std::size_t i = 0; i < world.segments.size(); ++i) {
    if (distance_m(world.segments[i], point_m) < kOnSurface_m) {
      letters += static_cast<char>('A' + i);
    }
  }
  for (std::size_t i = 0; i < world.circles.size(); ++i) {
    const double off_m = (point_m - world.circles[i].center_m).norm() - world.circles[i].radius_m;
    if (std::abs(off_m) < kOnSurface_m) letters += static_cast<char>('a' + i);
  }
  return letters;
}

std::string name_of_group(const voronoi::GeneratorGroups& groups, const voronoi::PointRun& run,
                          const world::World& world, const geometry::Pose2& T_world_laser) {
  std::string name;
  for (std::uint32_t i = run.begin; i < run.end; ++i) {
    const std::string at = surfaces_at(world, T_world_laser * groups.points[i].position_m);
    if (at.size() == 1) name += at;
  }
  std::ranges::sort(name);
  name.erase(std::unique(name.begin(), name.end()), name.end());
  return name.empty() ? "*" : name;
}

}  // namespace

Scene load_scene(const std::string& number) {
  Scene scene;
  scene.world =
      world::load_world(std::string(TOPOGEO_SHARE) + "/figures/figure_" + number + ".world.yaml");
  for (const Eigen::Vector2d& at : scene.world.tour_m) {
    scene.T_world_laser.push_back({at.x(), at.y(), 0.0});
  }
  return scene;
}

const std::vector<std::string>& scene_numbers() {
  static const std::vector<std::string> kNumbers{"4_07a", "4_07b", "4_08", "4_10", "4_11",
                                                 "4_12",  "4_15",  "4_16", "4_20", "5_01",
                                                 "5_02",  "5_04",  "5_05", "5_07"};
  return kNumbers;
}

Scene mirrored(const Scene& scene) {
  Scene result = scene;
  for (world::Segment& segment : result.world.segments) {
    segment.a_m.y() = -segment.a_m.y();
    segment.b_m.y() = -segment.b_m.y();
  }
  for (world::Circle& circle : result.world.circles) {
    circle.center_m.y() = -circle.center_m.y();
  }
  for (geometry::Pose2& pose : result.T_world_laser) pose.y_m = -pose.y_m;
  return result;
}

simulation::BeamPattern full_turn() {
  return {
      .angle_min_rad = -std::numbers::pi, .angle_step_rad = std::numbers::pi / 360.0, .count = 720};
}

scan::Scan scan_of(const world::World& world, const geometry::Pose2& T_world_laser,
                   const simulation::BeamPattern& beams) {
  scan::Scan scan;
  scan.angle_min_rad = beams.angle_min_rad;
  scan.angle_step_rad = beams.angle_step_rad;
  for (const double range_m : simulation::raycast(world, T_world_laser, beams)) {
    scan.ranges_m.push_back(std::isfinite(range_m) ? static_cast<float>(range_m)
                                                   : scan::Scan::kNoReturn);
  }
  return scan;
}

std::vector<std::string> NamedNodes::node_names() const {
  std::vector<std::string> names;
  for (const NamedNode& node : nodes) names.push_back(node.name);
  std::ranges::sort(names);
  return names;
}

std::optional<NamedNode> NamedNodes::node(std::string_view name) const {
  std::optional<NamedNode> found;
  for (const NamedNode& node : nodes) {
    if (node.name != name) continue;
    if (found) return std::nullopt;
    found = node;
  }
  return found;
}

void expect_node(const NamedNodes& seen, const std::string& name, const Eigen::Vector2d& position_m,
                 double tolerance_m) {
  const std::optional<NamedNode> node = seen.node(name);
  ASSERT_TRUE(node.has_value()) << "not exactly one node " << name;
  EXPECT_LT((node->position_m - position_m).norm(), tolerance_m)
      << name << " at " << node->position_m.transpose() << ", not at " << position_m.transpose();
}

std::string sorted_joined(std::vector<std::string> names) {
  std::ranges::sort(names);
  std::string text;
  for (const std::string& name : names) {
    if (!text.empty()) text += '|';
    text += name;
  }
  return text;
}

std::vector<std::string> group_names(const voronoi::LocalVoronoiDiagram& diagram,
                                     const world::World& world,
                                     const geometry::Pose2& T_world_laser) {
  std::vector<std::string> names;
  for (const voronoi::PointRun& run : diagram.groups.groups) {
    names.push_back(name_of_group(diagram.groups, run, world, T_world_laser));
  }
  return names;
}

Seen describe(const voronoi::LocalVoronoiDiagram& diagram, const world::World& world,
              const geometry::Pose2& T_world_laser) {
  Seen seen;
  seen.is_virtual = diagram.is_virtual;
  seen.groups = group_names(diagram, world, T_world_laser);
  for (const voronoi::DiagramNode& node : diagram.nodes) {
    seen.nodes.push_back(
        {joined_names(diagram.groups_of(node), seen.groups), node.position_m, node.clearance_m});
  }
  const auto end_name = [&](std::uint32_t node) {
    return node == voronoi::DiagramBranch::kLoose ? std::string("open") : seen.nodes[node].name;
  };
  for (const voronoi::DiagramBranch& branch : diagram.branches) {
    std::array ends{end_name(branch.node_a), end_name(branch.node_b)};
    // A node goes before an open end, and nodes are sorted by name.
    if (ends[0] == "open" || (ends[1] != "open" && ends[1] < ends[0])) std::swap(ends[0], ends[1]);
    seen.branches.push_back(joined_names(branch.base_groups, seen.groups) + ": " + ends[0] + " - " +
                            ends[1]);
  }
  std::ranges::sort(seen.branches);
  return seen;
}

Seen see(const Scene& scene, const voronoi::VoronoiConfig& config,
         const simulation::BeamPattern& beams, std::size_t at) {
  const geometry::Pose2& T_world_laser = scene.T_world_laser.at(at);
  voronoi::LocalVoronoi voronoi(config);
  return describe(voronoi.compute(scan_of(scene.world, T_world_laser, beams)), scene.world,
                  T_world_laser);
}

}  // namespace topogeo::figure_scenes
