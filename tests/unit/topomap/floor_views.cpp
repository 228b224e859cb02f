#include "floor_views.hpp"

#include <cmath>
#include <numbers>
#include <optional>

namespace topogeo::topomap::test {
namespace {

constexpr double kRange_m = 8.0;

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

// Distance along a unit ray to the wall.
std::optional<double> hit(const Eigen::Vector2d& origin, const Eigen::Vector2d& ray,
                          const Wall& wall) {
  const Eigen::Vector2d along = wall.to_m - wall.from_m;
  const double det = cross(ray, along);
  if (std::fabs(det) < 1e-12) return std::nullopt;
  const double t = cross(wall.from_m - origin, along) / det;
  const double s = cross(wall.from_m - origin, ray) / det;
  if (t < 0.0 || s < 0.0 || s > 1.0) return std::nullopt;
  return t;
}

double range(const Floor& floor, const Eigen::Vector2d& origin, const Eigen::Vector2d& ray) {
  double nearest = 1e9;
  for (const Wall& wall : floor.walls) {
    if (const auto t = hit(origin, ray, wall)) nearest = std::min(nearest, *t);
  }
  return nearest;
}

bool sees(const Floor& floor, const geometry::Pose2& T_map_robot, const Eigen::Vector2d& point) {
  const Eigen::Vector2d offset = point - T_map_robot.position_m();
  const double distance = offset.norm();
  if (distance > kRange_m || (inverse(T_map_robot) * point).x() < 0.0) return false;
  return distance < 1e-9 ||
         range(floor, T_map_robot.position_m(), offset / distance) > distance - 1e-9;
}

void add_branch(const Floor& floor, const geometry::Pose2& T_map_robot, const FloorBranch& branch,
                LocalMap& map) {
  const geometry::Pose2 T_robot_map = inverse(T_map_robot);
  const double length = (branch.to_m - branch.from_m).norm();
  const int steps = static_cast<int>(std::lround(length / 0.05));
  std::vector<BranchPoint> run;
  const auto finish = [&] {
    if (run.size() >= 2) {
      LocalBranch added;
      added.id = static_cast<std::uint32_t>(map.branches.size());
      added.points = run;
      for (const BranchPoint* end : {&run.front(), &run.back()}) {
        const auto id = static_cast<std::uint32_t>(map.nodes.size());
        (end == &run.front() ? added.node_a : added.node_b) = id;
        map.nodes.push_back(
            {id, NodeKind::kFictitious, end->position_m, end->clearance_m, {}, true});
      }
      map.branches.push_back(added);
    }
    run.clear();
  };
  for (int i = 0; i <= steps; ++i) {
    const Eigen::Vector2d p =
        branch.from_m + (branch.to_m - branch.from_m) * (static_cast<double>(i) / steps);
    if (sees(floor, T_map_robot, p)) {
      run.push_back({T_robot_map * p, branch.clearance_m});
    } else {
      finish();
    }
  }
  finish();
}

}  // namespace

Floor corridor(double length_m) {
  return {{{{0, -1}, {length_m, -1}}, {{0, 1}, {length_m, 1}}}, {{{0, 0}, {length_m, 0}, 1.0}}, {}};
}

Floor t_junction() {
  return {{{{0, -1}, {20, -1}},
           {{0, 1}, {9, 1}},
           {{11, 1}, {20, 1}},
           {{9, 1}, {9, 8}},
           {{11, 1}, {11, 8}}},
          {{{0, 0}, {10, 0}}, {{10, 0}, {20, 0}}, {{10, 0}, {10, 8}}},
          {{{10, 0}, 1.0, NodeKind::kReal}}};
}

Floor room_behind_door(bool open) {
  Floor floor = corridor(12);
  floor.walls[1] = {{0, 1}, {5.5, 1}};
  floor.walls.push_back({{6.5, 1}, {12, 1}});
  floor.walls.insert(floor.walls.end(), {{{4, 1.2}, {4, 5}}, {{4, 5}, {8, 5}}, {{8, 5}, {8, 1.2}}});
  floor.walls.push_back({{5.5, 1}, {5.5, 1.2}});
  floor.walls.push_back({{6.5, 1}, {6.5, 1.2}});
  if (!open) {
    floor.walls.push_back({{5.5, 1}, {6.5, 1}});
    return floor;
  }
  floor.branches = {{{0, 0}, {6, 0}, 1.0}, {{6, 0}, {12, 0}, 1.0}, {{6, 0}, {6, 3}, 0.5}};
  floor.nodes = {{{6, 0}, 1.0, NodeKind::kReal}, {{6, 1.1}, 0.5, NodeKind::kDoor}};
  return floor;
}

Floor loop_of_corridors() {
  Floor floor;
  const auto box = [&](double x0, double y0, double x1, double y1) {
    floor.walls.push_back({{x0, y0}, {x1, y0}});
    floor.walls.push_back({{x1, y0}, {x1, y1}});
    floor.walls.push_back({{x1, y1}, {x0, y1}});
    floor.walls.push_back({{x0, y1}, {x0, y0}});
  };
  box(0, 0, 24, 16);
  box(2, 2, 22, 14);
  floor.branches = {{{1, 1}, {23, 1}}, {{23, 1}, {23, 15}}, {{23, 15}, {1, 15}}, {{1, 15}, {1, 1}}};
  return floor;
}

LocalMap view(const Floor& floor, const geometry::Pose2& T_map_robot) {
  LocalMap map;
  for (int beam = 0; beam <= 360; ++beam) {
    const double angle = (beam * 0.5 - 90.0) * std::numbers::pi / 180.0;
    const double heading = T_map_robot.theta_rad + angle;
    const double r = range(floor, T_map_robot.position_m(), {std::cos(heading), std::sin(heading)});
    if (r > kRange_m) continue;
    map.points.push_back(
        {static_cast<float>(r * std::cos(angle)), static_cast<float>(r * std::sin(angle))});
  }
  for (const FloorBranch& b : floor.branches) add_branch(floor, T_map_robot, b, map);
  for (const FloorNode& n : floor.nodes) {
    if (!sees(floor, T_map_robot, n.position_m)) continue;
    map.nodes.push_back({static_cast<std::uint32_t>(map.nodes.size()),
                         n.kind,
                         inverse(T_map_robot) * n.position_m,
                         n.clearance_m,
                         {0, 1, 2},
                         true});
  }
  return map;
}

}  // namespace topogeo::topomap::test
