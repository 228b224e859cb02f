// Takes a robot from target to target of an explorer until nothing is left: gives goals and watches
// what a navigator makes of them. No clock, no I/O.
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
  std::vector<geometry::Pose2> T_map_stops;  ///< where its scans were made
};

struct TourGoal {
  std::uint64_t goal_id = 0;
  geometry::Pose2 T_map_goal;
};

class ExplorationTour {
 public:
  /// Goals are numbered from `first_goal_id`. Throws std::invalid_argument as `check`.
  explicit ExplorationTour(const TourConfig& config = {}, std::uint64_t first_goal_id = 1);
  ~ExplorationTour();

  /// To be called whenever it has changed.
  void set_map(ExploredMap map);

  /// The same for who holds graph and map as they come: nothing happens while both are those of the
  /// call before, or without a map. `T_map_stops` is asked for where scans were made.
  void follow(std::shared_ptr<const topomap::GlobalMap> graph,
              std::shared_ptr<const planning::HybridMap> map,
              const std::function<std::vector<geometry::Pose2>()>& T_map_stops);

  /// To be called several times a second. A goal for the navigator, when there is another one than
  /// before. Nothing happens while the navigator does not know where it is.
  std::optional<TourGoal> step(const NavigatorStatus& navigator, std::int64_t now_ns);

  /// Nothing that can be reached is left.
  [[nodiscard]] bool done() const { return done_; }
  /// Where it goes now.
  [[nodiscard]] const std::optional<ExplorationTarget>& target() const { return target_; }
  /// One line for people.
  [[nodiscard]] std::string message() const;
  [[nodiscard]] std::size_t targets() const { return targets_; }  ///< gone to so far
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
  std::optional<TourGoal> again_;  // to be given next: the same target from another heading
  std::uint64_t judged_version_ = 0;
  std::uint64_t chosen_version_ = 0;
  int looks_ = 0;                        // at the target so far
  double nearest_m_ = 0.0;               // that it came to the goal
  std::int64_t nearest_ns_ = 0;          // and when
  std::optional<std::int64_t> idle_ns_;  // since when there is no target
  std::size_t targets_ = 0;
  bool done_ = false;
};

}  // namespace topogeo::navigation
