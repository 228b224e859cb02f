#include "topogeo/navigation/explorer.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "topogeo/geometry/portable_math.hpp"

#include "grid_view.hpp"
#include "rooms.hpp"
#include "short_tour.hpp"

namespace topogeo::navigation {
namespace {

constexpr double kWide = 0.8;          // of the clearance at the widest place of a room
constexpr double kWideEnough_m = 0.8;  // more room does not improve the view
constexpr double kSamePlace_m = 0.5;   // distance within which a given-up target counts as the same

bool is_look(TargetKind kind) {
  return kind != TargetKind::kRoom && kind != TargetKind::kBlocked;
}

// A place without result as one kind has none as another kind, except that a room can still be
// entered.
bool same_place(const std::vector<ExplorationTarget>& targets, TargetKind kind,
                const Eigen::Vector2d& position_m) {
  return std::any_of(targets.begin(), targets.end(), [&](const ExplorationTarget& target) {
    return is_look(target.kind) == is_look(kind) && (is_look(kind) || target.kind == kind) &&
           (target.position_m - position_m).norm() <= kSamePlace_m;
  });
}

}  // namespace

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
    case TargetKind::kBlocked:
      return "blocked entrance";
  }
  return "unknown";
}

Explorer::Explorer(const ExplorerConfig& config) : config_(config) {
  check(config_);
}

void Explorer::set_visited(std::vector<geometry::Pose2> T_map_stops) {
  visited_ = std::move(T_map_stops);
}

struct Explorer::Option {
  ExplorationTarget target;
  double worth_m;
};

struct Explorer::Scene {
  const planning::HybridMap& map;
  const Rooms& rooms;
  const planning::HybridPlanner& planner;
  std::vector<bool> reachable;  // zones
  Eigen::Vector2d robot_m;
};

// The nearest reachable targets that are worth their distance, in ascending order, as many as the
// tour takes.
std::vector<Explorer::Option> Explorer::options(const std::vector<Candidate>& candidates,
                                                const Scene& scene) const {
  std::vector<Option> seen;
  for (const Candidate& candidate : candidates) {
    const auto T_map_view = view_of(candidate, scene);
    if (!T_map_view) continue;
    const double straight_m = (T_map_view->position_m() - scene.robot_m).norm();
    seen.push_back(
        {{candidate.kind, candidate.position_m, *T_map_view, straight_m}, candidate.worth_m});
  }
  const auto nearer = [](const Option& a, const Option& b) {
    return a.target.distance_m < b.target.distance_m;
  };
  std::stable_sort(seen.begin(), seen.end(), nearer);
  std::vector<Option> found;
  for (Option& option : seen) {
    // A path is at least as long as the straight line.
    if (found.size() >= config_.tour && option.target.distance_m >= found.back().target.distance_m)
      break;
    const bool together = std::any_of(found.begin(), found.end(), [&](const Option& other) {
      return geometry::between(other.target.T_map_view, option.target.T_map_view)
                 .position_m()
                 .norm() < config_.together_m;
    });
    if (together) continue;
    const planning::HybridRoute route =
        scene.planner.plan(scene.robot_m, option.target.T_map_view.position_m());
    if (!route.found() || route.length_m > option.worth_m) continue;
    option.target.distance_m = route.length_m;
    found.insert(std::upper_bound(found.begin(), found.end(), option, nearer), option);
    if (found.size() > config_.tour) found.pop_back();
  }
  return found;
}

std::optional<ExplorationTarget> Explorer::next(const topomap::GlobalMap& graph,
                                                const planning::HybridMap& map,
                                                const planning::HybridPlanner& planner,
                                                const geometry::Pose2& T_map_robot) const {
  const Eigen::Vector2d robot_m = T_map_robot.position_m();
  const Rooms rooms(map);
  const Scene scene{map, rooms, planner, reachable_zones(map, robot_m), robot_m};
  std::vector<Option> found = options(candidates(graph, map, rooms), scene);
  if (found.empty()) found = options(blocked_zones(map, scene.reachable), scene);
  if (found.empty()) return std::nullopt;
  if (found.size() == 1) return found.front().target;
  DistanceTable distances_m(found.size());
  for (std::size_t a = 0; a < found.size(); ++a) {
    const ExplorationTarget& from = found[a].target;
    distances_m.from_start(a) = from.distance_m;
    for (std::size_t b = a + 1; b < found.size(); ++b) {
      const ExplorationTarget& to = found[b].target;
      const planning::HybridRoute route =
          planner.plan(from.T_map_view.position_m(), to.T_map_view.position_m());
      distances_m.between(a, b) = route.found() ? route.length_m : from.distance_m + to.distance_m;
    }
  }
  return found[short_tour(distances_m).front()].target;
}

void Explorer::give_up(const ExplorationTarget& target) {
  given_up_.push_back(target);
}

void Explorer::put_off(const ExplorationTarget& target) {
  if (same_place(resumed_, target.kind, target.position_m)) return give_up(target);
  put_off_.push_back(target);
}

bool Explorer::resume() {
  if (put_off_.empty()) return false;
  resumed_.insert(resumed_.end(), put_off_.begin(), put_off_.end());
  put_off_.clear();
  return true;
}

bool Explorer::dropped(TargetKind kind, const Eigen::Vector2d& position_m) const {
  return same_place(given_up_, kind, position_m) || same_place(put_off_, kind, position_m);
}

// The viewpoint: near the target, in its sight, and the nearest such place to the robot; a room is
// entered where it is wide, and a blocked entrance is viewed from the nearest place.
std::optional<geometry::Pose2> Explorer::view_of(const Candidate& candidate,
                                                 const Scene& scene) const {
  const planning::FreeSpace& space = scene.map.space();
  const planning::GridFrame& frame = scene.map.frame();
  const auto room = frame.cell_of(candidate.position_m);
  const double wide_m =
      candidate.kind == TargetKind::kRoom && room ? kWide * space.clearance_m(*room) : 0.0;
  const auto good = [&](const planning::Cell& cell) {
    if (!space.passable(cell) || !scene.reachable[scene.map.zone_of(cell)]) return false;
    if (candidate.kind == TargetKind::kRoom) {
      return scene.rooms.at(cell) == scene.rooms.at(*room) &&
             space.clearance_m(cell) >= std::min(wide_m, kWideEnough_m);
    }
    if (candidate.kind == TargetKind::kBlocked) return true;
    const Eigen::Vector2d at_m = frame.center_m(cell);
    return !any_unknown(space.grid(), at_m, config_.sure_m) &&
           nothing_between(space.grid(), at_m, candidate.position_m);
  };
  std::optional<planning::Cell> cell;
  if (candidate.kind != TargetKind::kBlocked) {
    cell = best_cell(frame, candidate.position_m, config_.approach_m, good,
                     [&](const Eigen::Vector2d& at_m) { return (at_m - scene.robot_m).norm(); });
  }
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
