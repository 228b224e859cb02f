#include "route_keeper.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "elapsed.hpp"
#include "path_distance.hpp"
#include "route_floor.hpp"

namespace topogeo::navigation {
namespace {

// The connected cells under a polyline.
std::vector<planning::Cell> cells_under(const planning::GridFrame& frame,
                                        const std::vector<Eigen::Vector2d>& points_m) {
  constexpr double kStepsPerCell = 4.0;  // skips no relevant corner of a cell
  std::vector<planning::Cell> cells;
  const auto add = [&](const Eigen::Vector2d& point_m) {
    const auto cell = frame.cell_of(point_m);
    if (cell && (cells.empty() || !(cells.back() == *cell))) cells.push_back(*cell);
  };
  if (points_m.size() == 1) add(points_m.front());
  for (std::size_t i = 0; i + 1 < points_m.size(); ++i) {
    const Eigen::Vector2d piece_m = points_m[i + 1] - points_m[i];
    const int steps = std::max(
        1, static_cast<int>(std::ceil(kStepsPerCell * piece_m.norm() / frame.resolution_m)));
    for (int k = 0; k <= steps; ++k) add(points_m[i] + static_cast<double>(k) / steps * piece_m);
  }
  return cells;
}

}  // namespace

bool RouteKeeper::set_map(std::shared_ptr<const planning::HybridMap> map, std::uint64_t version) {
  map_ = std::move(map);
  map_version_ = version;
  if (!map_ && !on_branches()) {
    forget();
    return true;
  }
  if (!has_route()) return true;
  const RoutePlan route = route_;
  return take(route);
}

void RouteKeeper::expect(std::int64_t now_ns) {
  cancel();
  refused_.clear();
  waits_ns_.reset();
  goal_ns_ = now_ns;
}

void RouteKeeper::cancel() {
  offered_.reset();
  forget();
}

void RouteKeeper::forget() {
  cells_.clear();
  floor_.reset();
  route_ = {};
}

void RouteKeeper::drop(std::int64_t now_ns) {
  forget();
  waits_ns_ = now_ns;
}

bool RouteKeeper::take(const RoutePlan& route) {
  std::shared_ptr<const planning::FreeSpace> floor;
  if (navigation::on_branches(route)) floor = floor_of(route, map_ ? &map_->space() : nullptr);
  const planning::GridFrame& frame = floor ? floor->frame() : map_->frame();
  std::vector<planning::Cell> cells = cells_under(frame, route.points_m);
  if (cells.empty()) return false;
  route_ = route;
  floor_ = std::move(floor);
  cells_ = std::move(cells);
  return true;
}

// Whether a route of another map has room in this one, except at its ends.
bool RouteKeeper::fits(const RoutePlan& route) const {
  constexpr double kEnds_m = 0.5;  // robot and goal may be nearer to a wall than routes
  const std::vector<planning::Cell> cells = cells_under(map_->frame(), route.points_m);
  return !cells.empty() && std::all_of(cells.begin(), cells.end(), [&](const planning::Cell& cell) {
    const Eigen::Vector2d middle_m = map_->frame().center_m(cell);
    return map_->space().passable(cell) || (middle_m - route.points_m.front()).norm() < kEnds_m ||
           (middle_m - route.points_m.back()).norm() < kEnds_m;
  });
}

bool RouteKeeper::usable(const RoutePlan& route, std::uint64_t least_blockages_version) const {
  if (route.map_version > map_version_) return false;
  if (route.blockages_version < least_blockages_version) return false;
  if (!map_) return route.found && navigation::on_branches(route);
  if (route.map_version == map_version_) return true;
  return route.found && (navigation::on_branches(route) || fits(route));
}

RouteAnswer RouteKeeper::take_offer(const Use& use) {
  constexpr double kSameGoal_m = 0.01;
  constexpr double kSamePath_m = 0.35;  // smoothing moves a path this far off its route
  if (!offered_ || !usable(*offered_, use.least_blockages_version)) {
    return RouteAnswer::kKept;
  }
  const RoutePlan route = *std::exchange(offered_, std::nullopt);
  if (!route.found || route.points_m.empty()) {
    refused_ = route.reason.empty() ? "the planner has no route" : route.reason;
    forget();
    return RouteAnswer::kRefused;
  }
  const bool same_goal = has_route() && (goal_m() - route.points_m.back()).norm() < kSameGoal_m &&
                         route_.heading_rad == route.heading_rad;
  const bool same_path =
      same_goal && !use.path.empty() &&
      std::all_of(route.points_m.begin(), route.points_m.end(),
                  [&](const auto& point_m) { return distance_m(use.path, point_m) < kSamePath_m; });
  if (!take(route)) {
    refused_ = "the planner's route is not on the map";
    return RouteAnswer::kKept;
  }
  refused_.clear();
  waits_ns_.reset();
  return same_path || (same_goal && use.settles) ? RouteAnswer::kKept : RouteAnswer::kTaken;
}

double RouteKeeper::wait_s(std::int64_t now_ns) {
  if (!waits_ns_) waits_ns_ = now_ns;
  return waited_s(now_ns);
}

double RouteKeeper::waited_s(std::int64_t now_ns) {
  // A restarted navigator has its goal before it knows the time.
  if (goal_ns_ == 0) goal_ns_ = now_ns;
  return elapsed_s(waits_ns_.value_or(goal_ns_), now_ns);
}

}  // namespace topogeo::navigation
