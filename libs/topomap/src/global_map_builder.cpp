#include "topogeo/topomap/global_map_builder.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

#include "branch_names.hpp"
#include "driven_path.hpp"
#include "map_extraction.hpp"
#include "node_fusion.hpp"
#include "pair_fusion.hpp"
#include "ridge_refinement.hpp"
#include "seen_region.hpp"
#include "virtual_links.hpp"
#include "vote_grid.hpp"

namespace topogeo::topomap {
namespace {

// Limits of plausible input, far beyond any building and any laser: more is a fault of the sender.
constexpr double kLargestMap_m = 5000.0;
constexpr double kLargestView_m = 500.0;

bool within(const Eigen::Vector2d& point_m, double limit_m) {
  // Written so that a NaN is outside.
  return std::fabs(point_m.x()) <= limit_m && std::fabs(point_m.y()) <= limit_m;
}

void check_coordinate(const LocalMap& map, const char* what, const Eigen::Vector2d& point_m,
                      double clearance_m) {
  if (within(point_m, kLargestView_m) && std::fabs(clearance_m) <= kLargestView_m) return;
  throw std::invalid_argument("global map: local map " + std::to_string(map.id) + " has a " + what +
                              " that is not finite or more than 500 m from the robot");
}

void check_input(const LocalMap& map, const geometry::Pose2& T_map_robot) {
  if (!within(T_map_robot.position_m(), kLargestMap_m) ||
      !(std::fabs(T_map_robot.theta_rad) <= 1e5)) {
    throw std::invalid_argument("global map: pose of local map " + std::to_string(map.id) +
                                " is not finite or more than 5 km from the origin");
  }
  for (const ScanPoint& p : map.points) check_coordinate(map, "scan point", {p.x_m, p.y_m}, 0.0);
  for (const TrackedScan& scan : map.track) {
    check_coordinate(map, "tracked scan", scan.T_stop_robot.position_m(), 0.0);
  }
  for (const LocalNode& n : map.nodes) check_coordinate(map, "node", n.position_m, n.clearance_m);
  for (const LocalBranch& b : map.branches) {
    for (const BranchPoint& p : b.points) {
      check_coordinate(map, "branch point", p.position_m, p.clearance_m);
    }
  }
}

}  // namespace

struct GlobalMapBuilder::State {
  explicit State(const GlobalMapConfig& used)
      : config(used), grid(used), nodes(used), pairs(used) {}

  GlobalMapConfig config;
  VoteGrid grid;
  NodeFusion nodes;
  BranchNames names;
  PairFusion pairs;  // replaces the three above with FusionRule::kPairs
  DrivenPath path;
};

GlobalMapBuilder::GlobalMapBuilder(const GlobalMapConfig& config) {
  check(config);
  state_ = std::make_unique<State>(config);
}

GlobalMapBuilder::GlobalMapBuilder(GlobalMapBuilder&&) noexcept = default;
GlobalMapBuilder& GlobalMapBuilder::operator=(GlobalMapBuilder&&) noexcept = default;
GlobalMapBuilder::~GlobalMapBuilder() = default;

void GlobalMapBuilder::integrate(const LocalMap& map, const geometry::Pose2& T_map_robot) {
  StopPose stop;
  stop.stamp_ns = map.stamp_ns;
  stop.T_map_robot = T_map_robot;
  integrate(map, stop);
}

void GlobalMapBuilder::integrate(const LocalMap& map, const StopPose& stop) {
  const geometry::Pose2& T_map_robot = stop.T_map_robot;
  check_input(map, T_map_robot);
  const Sighting sighting{stop.views, stop.last_seen_ns()};
  if (state_->config.fusion == FusionRule::kPairs) {
    state_->pairs.add(map, T_map_robot, sighting);
    state_->path.add(map, T_map_robot);
    return;
  }
  const SeenRegion view(map, state_->config.gap_m);
  state_->grid.add(map, T_map_robot, view, sighting);
  state_->nodes.add(map, T_map_robot, view, sighting);
  state_->names.add(map, T_map_robot);
  state_->path.add(map, T_map_robot);
}

void GlobalMapBuilder::rebuild(std::span<const LocalMap> maps, std::span<const StopPose> poses) {
  if (maps.size() != poses.size()) {
    throw std::invalid_argument("global map: " + std::to_string(maps.size()) + " local maps but " +
                                std::to_string(poses.size()) + " poses");
  }
  for (std::size_t i = 0; i < maps.size(); ++i) check_input(maps[i], poses[i].T_map_robot);
  state_ = std::make_unique<State>(state_->config);
  for (std::size_t i = 0; i < maps.size(); ++i) integrate(maps[i], poses[i]);
}

GlobalMap GlobalMapBuilder::snapshot(std::uint64_t version) const {
  if (state_->config.fusion == FusionRule::kPairs) {
    GlobalMap map = state_->pairs.map();
    add_virtual_links(state_->path, state_->config, map);
    map.version = version;
    return map;
  }
  const RidgeGraph ridge = refine_ridge(trace_ridge(state_->grid, state_->config), state_->config);
  GlobalMap map = extract_map(ridge, state_->nodes, state_->names, state_->config);
  add_virtual_links(state_->path, state_->config, map);
  map.version = version;
  return map;
}

}  // namespace topogeo::topomap
