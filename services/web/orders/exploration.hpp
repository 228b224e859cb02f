// Exploring by itself: the robot goes to all that it can get to and has not seen. No transport.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/navigation/exploration_tour.hpp"

namespace topogeo::web {

/// What is known of the floor; either may be null.
struct ExploredFloor {
  std::shared_ptr<const topomap::GlobalMap> graph;
  std::shared_ptr<const planning::HybridMap> map;
  std::function<std::vector<geometry::Pose2>()> T_map_stops;  ///< asked when the map has changed
};

struct ExplorationGoal {
  geometry::Pose2 T_map_goal;
  std::string text;  ///< for people
};

class Exploration {
 public:
  /// From the beginning, also of what was given up before. Throws std::invalid_argument as `check`
  /// of its configuration.
  void start(const navigation::TourConfig& config);
  void stop() { tour_.reset(); }
  [[nodiscard]] bool running() const { return tour_ != nullptr; }

  /// To be called every `period`: the next goal, when there is another one than before. `taken`:
  /// the navigator's status is of the goal given last. While it is paused no time passes.
  std::optional<ExplorationGoal> step(const ExploredFloor& floor,
                                      navigation::NavigatorStatus navigator, bool taken,
                                      std::chrono::nanoseconds period);

  /// Nothing that can be reached is left; false before start().
  [[nodiscard]] bool done() const { return tour_ && tour_->done(); }
  /// A line for people, while it is running.
  [[nodiscard]] std::string summary() const;

 private:
  std::unique_ptr<navigation::ExplorationTour> tour_;
  std::uint64_t goal_id_ = 0;  // as the tour numbers it
  std::chrono::nanoseconds time_{0};
};

}  // namespace topogeo::web
