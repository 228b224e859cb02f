#include "topogeo/navigation/exploration_tour.hpp"

#include <cmath>
#include <utility>

#include "topogeo/planning/hybrid_planner.hpp"

namespace topogeo::navigation {
namespace {

constexpr double kNanosecondsPerSecond = 1e9;
constexpr double kNearer_m = 0.1;   // progress
constexpr double kAside_rad = 0.5;  // turns enough for another stop
constexpr int kLooksAtTarget = 2;   // at a target that remains open

}  // namespace

ExplorationTour::ExplorationTour(const TourConfig& config, std::uint64_t first_goal_id)
    : config_(config), explorer_(config.explorer), next_goal_id_(first_goal_id) {
  check(config_);
}

ExplorationTour::~ExplorationTour() = default;

void ExplorationTour::set_map(ExploredMap map) {
  planner_.reset();
  map_ = std::move(map);
  explorer_.set_visited(map_.T_map_stops);
  planning::HybridPlannerConfig config;
  config.goal_snap_m = 0.2;  // a cell may have become forbidden in the new map
  if (map_.map) planner_ = std::make_unique<planning::HybridPlanner>(*map_.map, config);
}

void ExplorationTour::follow(std::shared_ptr<const topomap::GlobalMap> graph,
                             std::shared_ptr<const planning::HybridMap> map,
                             const std::function<std::vector<geometry::Pose2>()>& T_map_stops) {
  if (!map || (map == map_.map && graph == followed_graph_)) return;
  followed_graph_ = graph;
  if (!graph) graph = std::make_shared<const topomap::GlobalMap>();
  set_map({map_.version + 1, std::move(graph), std::move(map), T_map_stops()});
}

std::optional<TourGoal> ExplorationTour::step(const NavigatorStatus& navigator,
                                              std::int64_t now_ns) {
  if (done_ || !planner_ || !navigator.T_map_robot) return std::nullopt;
  if (target_) judge(navigator, now_ns);
  if (again_) return std::exchange(again_, std::nullopt);
  if (target_) return std::nullopt;
  return choose(*navigator.T_map_robot, now_ns);
}

void ExplorationTour::judge(const NavigatorStatus& navigator, std::int64_t now_ns) {
  const bool changed = std::exchange(judged_version_, map_.version) != map_.version;
  if (changed && !explorer_.open(*target_, *map_.map)) {
    target_.reset();
    return;
  }
  const bool waited =
      static_cast<double>(now_ns - nearest_ns_) > kNanosecondsPerSecond * config_.patience_s;
  if (navigator.goal_id != goal_->goal_id) {
    // A navigator that starts just now does not get the goal.
    if (!received_ && waited) {
      explorer_.put_off(*target_);
      target_.reset();
    }
    return;
  }
  received_ = true;
  switch (navigator.state) {
    case NavigatorState::kArrived:
      // The map may not contain its last scan yet.
      if (changed ||
          static_cast<double>(now_ns - nearest_ns_) > kNanosecondsPerSecond * config_.settle_s) {
        arrived();
        nearest_ns_ = now_ns;
      }
      return;
    case NavigatorState::kStopped:
      if (navigator.reason == HaltReason::kNoRoute) {
        explorer_.put_off(*target_);
        target_.reset();
        return;
      }
      break;
    default:
      break;
  }
  const Eigen::Vector2d rest_m =
      goal_->T_map_goal.position_m() - navigator.T_map_robot->position_m();
  const double distance_m = navigator.rest_m > 0.0 ? navigator.rest_m : rest_m.norm();
  if (distance_m < nearest_m_ - kNearer_m || navigator.state == NavigatorState::kRelocalizing) {
    nearest_m_ = distance_m;
    nearest_ns_ = now_ns;
  } else if (waited) {
    explorer_.give_up(*target_);
    target_.reset();
  }
}

// The robot is there, but the target is still open: looks again, turned a little, so that a new
// stop is made.
void ExplorationTour::arrived() {
  if (++looks_ >= kLooksAtTarget) {
    explorer_.give_up(*target_);
    target_.reset();
    return;
  }
  geometry::Pose2 T_map_goal = target_->T_map_view;
  T_map_goal.theta_rad = geometry::wrap_angle(T_map_goal.theta_rad + kAside_rad);
  again_ = give(T_map_goal);
}

std::optional<TourGoal> ExplorationTour::choose(const geometry::Pose2& T_map_robot,
                                                std::int64_t now_ns) {
  const bool waited = idle_ns_ && static_cast<double>(now_ns - *idle_ns_) >=
                                      kNanosecondsPerSecond * config_.settle_s;
  if (std::exchange(chosen_version_, map_.version) != map_.version || !idle_ns_) {
    target_ = explorer_.next(*map_.graph, *map_.map, *planner_, T_map_robot);
    if (!target_ && explorer_.resume()) {
      target_ = explorer_.next(*map_.graph, *map_.map, *planner_, T_map_robot);
    }
  }
  if (!target_) {
    if (!idle_ns_) idle_ns_ = now_ns;
    done_ = waited;
    return std::nullopt;
  }
  idle_ns_.reset();
  ++targets_;
  looks_ = 0;
  nearest_m_ = target_->distance_m;
  nearest_ns_ = now_ns;
  judged_version_ = map_.version;
  return give(target_->T_map_view);
}

TourGoal ExplorationTour::give(const geometry::Pose2& T_map_goal) {
  goal_ = TourGoal{next_goal_id_++, T_map_goal};
  received_ = false;
  return *goal_;
}

std::string ExplorationTour::message() const {
  if (done_) return "no reachable target is left";
  if (!planner_) return "waits for a map";
  if (!target_) return "looks for a target";
  return "to a " + std::string(describe(target_->kind)) + ", " +
         std::to_string(static_cast<long>(std::lround(target_->distance_m))) +
         " m away when chosen";
}

}  // namespace topogeo::navigation
