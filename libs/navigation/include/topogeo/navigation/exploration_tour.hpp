// Sends a robot from target to target of an explorer until none is left: gives goals and watches
// how a navigator pursues them. No clock, no I/O.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/navigation/explorer.hpp"
#include "topogeo/navigation/navigator_inputs.hpp"
#include "topogeo/planning/hybrid_map.hpp"
#include "topogeo/topomap/global_map.hpp"

namespace topogeo::navigation {

/// The map of the floor so far.
struct ExploredMap {
  std::uint64_t version = 0;  ///< counts the changes
  std::shared_ptr<const topomap::GlobalMap> graph;
  std::shared_ptr<const planning::HybridMap> map;
  std::vector<geometry::Pose2> T_map_stops;  ///< poses of its scans
};

struct TourGoal {
  std::uint64_t goal_id = 0;
  geometry::Pose2 T_map_goal;
};

class ExplorationTour {
 public:
  /// Goals are numbered from `first_goal_id`. Throws std::invalid_argument like `check`.
  explicit ExplorationTour(const TourConfig& config = {}, std::uint64_t first_goal_id = 1);
  ~ExplorationTour();

  /// Call whenever the map has changed.
  void set_map(ExploredMap map);

  /// Like set_map, for owners that receive graph and map separately: does nothing if both are
  /// unchanged, or without a map. `T_map_stops` returns the poses of the scans.
  void follow(std::shared_ptr<const topomap::GlobalMap> graph,
              std::shared_ptr<const planning::HybridMap> map,
              const std::function<std::vector<geometry::Pose2>()>& T_map_stops);

  /// Call several times a second. Returns a goal for the navigator when it changes. Does nothing
  /// while the navigator has no pose.
  std::optional<TourGoal> step(const NavigatorStatus& navigator, std::int64_t now_ns);

  /// No reachable target is left.
  [[nodiscard]] bool done() const { return done_; }
  /// The current target.
  [[nodiscard]] const std::optional<ExplorationTarget>& target() const { return target_; }
  /// One line for people.
  [[nodiscard]] std::string message() const;
  [[nodiscard]] std::size_t targets() const { return targets_; }  ///< visited so far
  [[nodiscard]] std::size_t given_up() const { return explorer_.given_up(); }

 private:
  void judge(const NavigatorStatus& navigator, std::int64_t now_ns);
  void arrived();
  std::optional<TourGoal> choose(const geometry::Pose2& T_map_robot, std::int64_t now_ns);
  TourGoal give(const geometry::Pose2& T_map_goal);

  TourConfig config_;
  Explorer explorer_;
  ExploredMap map_;
  std::shared_ptr<const topomap::GlobalMap> followed_graph_;
  std::unique_ptr<planning::HybridPlanner> planner_;
  std::uint64_t next_goal_id_;
  std::optional<ExplorationTarget> target_;
  std::optional<TourGoal> goal_;
  bool received_ = false;          // goal_, by the navigator
  std::optional<TourGoal> again_;  // next goal: the same target with another heading
  std::uint64_t judged_version_ = 0;
  std::uint64_t chosen_version_ = 0;
  int looks_ = 0;                        // at the target so far
  double nearest_m_ = 0.0;               // least distance to the goal so far
  std::int64_t nearest_ns_ = 0;          // time of the last progress
  std::optional<std::int64_t> idle_ns_;  // start of the time without a target
  std::size_t targets_ = 0;
  bool done_ = false;
};

}  // namespace topogeo::navigation
