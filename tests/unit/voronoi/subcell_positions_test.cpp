// Positions of branch points and nodes between the cells: better than 2 cm on a grid of 5 cm when
// successive readings on a wall are less than 5 cm apart.
//
// A found point is compared with the locus of the true walls, to first order: with distances d_a
// and d_b to two walls, and unit vectors u_a, u_b away from them, the locus is |d_a - d_b| / |u_a -
// u_b| away. For straight walls, wall and corner, and corners this is the axis, the bisector, the
// parabola and so on, without a formula for each.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <random>
#include <span>
#include <sstream>
#include <string>
#include <vector>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "figure_scenes.hpp"

namespace topogeo::voronoi {
namespace {

using geometry::Pose2;

constexpr double kDense_m = 0.05;

struct PositionScene {
  std::string name;
  std::string text;  ///< in the format of world files
  Eigen::Vector2d laser_m;
  bool has_nodes;
};

const std::vector<PositionScene>& position_scenes() {
  static const std::vector<PositionScene> kScenes{
      // -------------------- y = 1.13
      //     R>
      // -------------------- y = -0.92
      {"corridor",
       R"(walls: [{from: [-9, 1.13], to: [9, 1.13]}, {from: [-9, -0.92], to: [9, -0.92]}])",
       {0.0, 0.1},
       false},
      //          _____-----
      // ----
      //     R>
      // -----_____
      //           -----_____
      {"walls at an angle",
       R"(walls: [{from: [-3, 0.6], to: [4, 1.9]}, {from: [-3, -0.5], to: [4, -2.3]}])",
       {-0.3, 0.1},
       false},
      //            |
      //  R>        +----- y = 0.31, corner at x = 1.03
      // ----------------- y = -1.12
      {"wall and corner of a box",
       R"(walls: [{from: [-9, -1.12], to: [9, -1.12]}, {from: [1.03, 0.31], to: [3, 0.31]},
                  {from: [1.03, 0.31], to: [1.03, 3]}])",
       {-0.1, -0.2},
       false},
      // ---------+   |
      //     R>       | x = 2.58
      // ---------+   |    corners at x = 0.97
      {"T junction",
       R"(walls: [{from: [-9, 1.08], to: [0.97, 1.08]}, {from: [-9, -0.93], to: [0.97, -0.93]},
                  {from: [2.58, -9], to: [2.58, 9]}])",
       {0.0, 0.1},
       true},
      //          --------
      // ----    --------- y = 1.12, door from x = 0.43 to 1.35
      //     R>
      // ----------------- y = -0.91
      {"door",
       R"(walls: [{from: [-9, 1.12], to: [0.43, 1.12]}, {from: [1.35, 1.12], to: [9, 1.12]},
                  {from: [-9, -0.91], to: [9, -0.91]}, {from: [1.1, 2.31], to: [9, 2.31]}])",
       {0.0, 0.1},
       true}};
  return kScenes;
}

/// The nearest point of a group's true walls.
struct Foot {
  Eigen::Vector2d at_m = Eigen::Vector2d::Zero();
  double distance_m = std::numeric_limits<double>::infinity();
};

Foot foot_on(const world::World& world, const std::string& walls, const Eigen::Vector2d& p_m) {
  Foot best;
  for (const char wall : walls) {
    const world::Segment& s = world.segments[static_cast<std::size_t>(wall - 'A')];
    const Eigen::Vector2d along = s.b_m - s.a_m;
    const double t = std::clamp((p_m - s.a_m).dot(along) / along.squaredNorm(), 0.0, 1.0);
    const Eigen::Vector2d at_m = s.a_m + t * along;
    if ((p_m - at_m).norm() < best.distance_m) best = {at_m, (p_m - at_m).norm()};
  }
  return best;
}

/// One diagram with the data for its evaluation, in the world frame.
struct Judge {
  world::World world;
  Pose2 T_world_laser;
  LocalVoronoiDiagram diagram;
  std::vector<std::string> names;

  /// The foot on a group, if the readings around it are less than 5 cm apart.
  [[nodiscard]] std::optional<Foot> dense_foot(std::uint16_t group,
                                               const Eigen::Vector2d& p_m) const {
    const Foot foot = foot_on(world, names[group], p_m);
    const PointRun& run = diagram.groups.groups[group];
    const auto reading_m = [&](std::uint32_t i) -> Eigen::Vector2d {
      return T_world_laser * diagram.groups.points[i].position_m;
    };
    std::uint32_t nearest = run.begin;
    for (std::uint32_t i = run.begin; i < run.end; ++i) {
      if ((reading_m(i) - foot.at_m).norm() < (reading_m(nearest) - foot.at_m).norm()) nearest = i;
    }
    if ((reading_m(nearest) - foot.at_m).norm() > kDense_m) return std::nullopt;
    const std::uint32_t neighbour = nearest + 1 < run.end ? nearest + 1 : nearest - 1;
    if ((reading_m(neighbour) - reading_m(nearest)).norm() > kDense_m) return std::nullopt;
    return foot;
  }

  /// Distance of a branch point from the true locus; empty when readings are farther apart.
  [[nodiscard]] std::optional<double> error_m(const DiagramBranch& branch,
                                              const DiagramPoint& point) const {
    const Eigen::Vector2d p_m = T_world_laser * point.position_m;
    const auto a = dense_foot(branch.base_groups[0], p_m);
    const auto b = dense_foot(branch.base_groups[1], p_m);
    if (!a || !b) return std::nullopt;
    const Eigen::Vector2d gradient =
        (p_m - a->at_m) / a->distance_m - (p_m - b->at_m) / b->distance_m;
    return std::abs(a->distance_m - b->distance_m) / gradient.norm();
  }

  /// Distance of a node of three groups from its true position, by Newton's method.
  [[nodiscard]] std::optional<double> error_m(const DiagramNode& node) const {
    const std::span<const std::uint16_t> groups = diagram.groups_of(node);
    if (groups.size() != 3) return std::nullopt;
    const Eigen::Vector2d start_m = T_world_laser * node.position_m;
    Eigen::Vector2d p_m = start_m;
    for (int step = 0; step < 20; ++step) {
      std::array<Foot, 3> feet;
      for (std::size_t i = 0; i < 3; ++i) {
        const auto foot = dense_foot(groups[i], p_m);
        if (!foot) return std::nullopt;
        feet[i] = *foot;
      }
      const auto away = [&](std::size_t i) -> Eigen::Vector2d {
        return (p_m - feet[i].at_m) / feet[i].distance_m;
      };
      Eigen::Matrix2d slope;
      slope.row(0) = (away(0) - away(1)).transpose();
      slope.row(1) = (away(0) - away(2)).transpose();
      const Eigen::Vector2d off(feet[0].distance_m - feet[1].distance_m,
                                feet[0].distance_m - feet[2].distance_m);
      p_m -= slope.inverse() * off;
    }
    return (p_m - start_m).norm();
  }
};

Judge judge_at(const PositionScene& scene, const Pose2& T_world_laser) {
  Judge judge;
  judge.world = world::parse_world(
      scene.text + "\nboxes: [{from: [-9, -9], to: [9, 9]}]\nname: " + scene.name, scene.name);
  judge.T_world_laser = T_world_laser;
  VoronoiConfig config = figure_scenes::source_config();
  config.join_hidden_zones = false;  // it joins the walls of the junction
  LocalVoronoi voronoi(config);
  judge.diagram = voronoi.compute(figure_scenes::scan_of(judge.world, T_world_laser));
  judge.names = figure_scenes::group_names(judge.diagram, judge.world, T_world_laser);
  return judge;
}

struct Errors {
  int count = 0;
  double sum_m = 0.0;
  double largest_m = 0.0;
  std::string where;

  void add(double error_m, const Pose2& T_world_laser, const Eigen::Vector2d& at_m) {
    ++count;
    sum_m += error_m;
    if (error_m <= largest_m) return;
    largest_m = error_m;
    const Eigen::Vector2d world_m = T_world_laser * at_m;
    std::ostringstream text;
    text << world_m.transpose() << " seen from " << T_world_laser.position_m().transpose()
         << " looking along " << T_world_laser.theta_rad;
    where = text.str();
  }
};

TEST(SubcellPositions, BranchPointsAndNodesAreBetterThanTwoCentimetres) {
  for (const PositionScene& scene : position_scenes()) {
    SCOPED_TRACE(scene.name);
    Errors points;
    Errors nodes;
    std::mt19937 random(17);
    const auto uniform = [&](double half) {
      return half * (static_cast<double>(random()) / 2147483648.0 - 1.0);
    };
    for (int place = 0; place < 60; ++place) {
      const Pose2 T_world_laser{scene.laser_m.x() + uniform(0.3), scene.laser_m.y() + uniform(0.3),
                                uniform(0.5)};
      const Judge judge = judge_at(scene, T_world_laser);
      for (const DiagramBranch& branch : judge.diagram.branches) {
        for (const DiagramPoint& point : judge.diagram.points_of(branch)) {
          const auto error_m = judge.error_m(branch, point);
          if (error_m) points.add(*error_m, T_world_laser, point.position_m);
        }
      }
      for (const DiagramNode& node : judge.diagram.nodes) {
        const auto error_m = judge.error_m(node);
        if (error_m) nodes.add(*error_m, T_world_laser, node.position_m);
      }
    }
    EXPECT_GT(points.count, 1500);
    EXPECT_EQ(nodes.count > 50, scene.has_nodes);
    for (const Errors& errors : {points, nodes}) {
      EXPECT_LT(errors.largest_m, 0.02) << "at " << errors.where;
      EXPECT_LT(errors.sum_m, 0.005 * errors.count + 1e-9) << "mean over 5 mm";
    }
  }
}

}  // namespace
}  // namespace topogeo::voronoi
