#include "topogeo/navigation/explorer.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "topogeo/geometry/portable_math.hpp"

#include "grid_view.hpp"
#include "settings_check.hpp"

namespace topogeo::navigation {
namespace {

constexpr double kWide = 0.8;  // of the clearance in the widest place of a room
constexpr double kWideEnough_m = 0.8;
constexpr double kSamePlace_m = 0.5;  // a target that was given up comes back within this

/// Which zones the robot can get to, by index.
std::vector<bool> reachable_zones(const planning::HybridMap& map, const Eigen::Vector2d& robot_m) {
  std::vector<bool> zones(map.zones().zones.size(), false);
  const auto cell = nearest_passable(map.space(), robot_m, 0.5);
  const planning::ZoneId own = cell ? map.zone_of(*cell) : planning::kNoZone;
  if (own == planning::kNoZone) return zones;
  zones[own] = true;
  std::vector<planning::GraphAccess> entries;
  for (const std::uint32_t node : map.nodes_of(own)) entries.push_back({node, 0.0});
  if (entries.empty()) return zones;
  const std::vector<bool> nodes = map.graph().reached(entries);
  for (const planning::BorderNode& node : map.nodes()) {
    if (!nodes[node.id]) continue;
    for (const planning::ZoneId zone : node.zones) zones[zone] = true;
  }
  return zones;
}

/// The zone around the robot if it has one entrance only, otherwise kNoZone.
planning::ZoneId dead_end(const planning::HybridMap& map, const Eigen::Vector2d& robot_m) {
  const auto cell = nearest_passable(map.space(), robot_m, 0.5);
  const planning::ZoneId zone = cell ? map.zone_of(*cell) : planning::kNoZone;
  if (zone == planning::kNoZone || map.nodes_of(zone).size() != 1) return planning::kNoZone;
  return zone;
}

}  // namespace

void check(const ExplorerConfig& config) {
  check_range("exploration", "explorer.unknown_near_m", config.unknown_near_m, 0.1, 5.0);
  check_range("exploration", "explorer.passage_side_m", config.passage_side_m, 0.3, 5.0);
  check_range("exploration", "explorer.gap_side_m", config.gap_side_m, 0.3, 10.0);
  check_range("exploration", "explorer.least_gap_m", config.least_gap_m, 0.1, 10.0);
  check_range("exploration", "explorer.approach_m", config.approach_m, 0.1, 10.0);
  check_range("exploration", "explorer.view_m", config.view_m, config.approach_m, 10.0);
  check_range("exploration", "explorer.sure_m", config.sure_m, 0.0, 2.0);
  check_range("exploration", "explorer.gap_worth", config.gap_worth, 1.0, 1000.0);
  check_range("exploration", "explorer.stay_m", config.stay_m, 0.0, 100.0);
  check_range("exploration", "explorer.least_zone_m2", config.least_zone_m2, 0.0, 100.0);
}

std::string_view describe(TargetKind kind) {
  switch (kind) {
    case TargetKind::kBranchEnd:
      return "branch end";
    case TargetKind::kPassage:
      return "passage";
    case TargetKind::kGap:
      return "gap";
    case TargetKind::kRoom:
      return "room";
  }
  return "unknown";
}

Explorer::Explorer(const ExplorerConfig& config) : config_(config) {
  check(config_);
}

void Explorer::set_visited(std::vector<geometry::Pose2> T_map_stops) {
  visited_ = std::move(T_map_stops);
}

std::optional<ExplorationTarget> Explorer::next(const topomap::GlobalMap& graph,
                                                const planning::HybridMap& map,
                                                const planning::HybridPlanner& planner,
                                                const geometry::Pose2& T_map_robot) const {
  const Eigen::Vector2d robot_m = T_map_robot.position_m();
  const std::vector<bool> zones = reachable_zones(map, robot_m);
  const planning::ZoneId room = dead_end(map, robot_m);
  struct Option {
    ExplorationTarget target;  // its costs as if nothing were in the way
    double worth_m;
    double elsewhere_m;
  };
  std::vector<Option> options;
  for (const Candidate& candidate : candidates(graph, map)) {
    const auto T_map_view = view_of(candidate, map, zones, robot_m);
    if (!T_map_view) continue;
    const double straight_m = (T_map_view->position_m() - robot_m).norm();
    const planning::ZoneId zone = map.zone_of(*map.frame().cell_of(T_map_view->position_m()));
    const double elsewhere_m = room != planning::kNoZone && zone != room ? config_.stay_m : 0.0;
    options.push_back(
        {{candidate.kind, candidate.position_m, *T_map_view, straight_m, straight_m + elsewhere_m},
         candidate.worth_m,
         elsewhere_m});
  }
  std::stable_sort(options.begin(), options.end(), [](const Option& a, const Option& b) {
    return a.target.cost_m < b.target.cost_m;
  });
  std::optional<ExplorationTarget> best;
  for (const Option& option : options) {
    if (best && option.target.cost_m >= best->cost_m) break;  // no way is shorter than straight
    const planning::HybridRoute route =
        planner.plan(robot_m, option.target.T_map_view.position_m());
    if (!route.found() || route.length_m > option.worth_m) continue;
    const double cost_m = route.length_m + option.elsewhere_m;
    if (best && cost_m >= best->cost_m) continue;
    best = option.target;
    best->way_m = route.length_m;
    best->cost_m = cost_m;
  }
  return best;
}

bool Explorer::open(const ExplorationTarget& target, const topomap::GlobalMap& graph,
                    const planning::HybridMap& map) const {
  const std::vector<Candidate> found = candidates(graph, map);
  return std::any_of(found.begin(), found.end(), [&](const Candidate& candidate) {
    return candidate.kind == target.kind &&
           (candidate.position_m - target.position_m).norm() <= config_.gap_side_m;
  });
}

void Explorer::give_up(const ExplorationTarget& target) {
  given_up_.push_back({target.kind, target.position_m});
}

bool Explorer::dropped(TargetKind kind, const Eigen::Vector2d& position_m) const {
  return std::any_of(given_up_.begin(), given_up_.end(), [&](const Candidate& given_up) {
    return given_up.kind == kind && (given_up.position_m - position_m).norm() <= kSamePlace_m;
  });
}

// Where the robot is sent: near to the target, in its sight and, of such places, the one nearest to
// the robot; a room is entered where it is wide.
std::optional<geometry::Pose2> Explorer::view_of(const Candidate& candidate,
                                                 const planning::HybridMap& map,
                                                 const std::vector<bool>& zones,
                                                 const Eigen::Vector2d& robot_m) const {
  const planning::FreeSpace& space = map.space();
  const planning::GridFrame& frame = map.frame();
  const auto room = frame.cell_of(candidate.position_m);
  const double wide_m =
      candidate.kind == TargetKind::kRoom && room ? kWide * space.clearance_m(*room) : 0.0;
  const auto good = [&](const planning::Cell& cell) {
    if (!space.passable(cell) || !zones[map.zone_of(cell)]) return false;
    if (candidate.kind == TargetKind::kRoom) {
      return map.zone_of(cell) == map.zone_of(*room) &&
             space.clearance_m(cell) >= std::min(wide_m, kWideEnough_m);
    }
    const Eigen::Vector2d at_m = frame.center_m(cell);
    return !any_unknown(space.grid(), at_m, config_.sure_m) &&
           nothing_between(space.grid(), at_m, candidate.position_m);
  };
  auto cell = best_cell(frame, candidate.position_m, config_.approach_m, good,
                        [&](const Eigen::Vector2d& at_m) { return (at_m - robot_m).norm(); });
  if (!cell) cell = nearest_cell(frame, candidate.position_m, config_.view_m, good);
  if (!cell) return std::nullopt;
  const Eigen::Vector2d view_m = frame.center_m(*cell);
  Eigen::Vector2d ahead_m = candidate.position_m - view_m;
  if (ahead_m.norm() < frame.resolution_m) {
    ahead_m = toward_unknown(space.grid(), candidate.position_m, config_.unknown_near_m);
  }
  return geometry::Pose2{view_m.x(), view_m.y(), geometry::atan2(ahead_m.y(), ahead_m.x())};
}

}  // namespace topogeo::navigation
