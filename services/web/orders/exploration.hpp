// Autonomous exploration: the robot visits all reachable areas that it has not seen. No transport.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/navigation/exploration_tour.hpp"

namespace topogeo::web {

/// The known floor; either map may be null.
struct ExploredFloor {
  std::shared_ptr<const topomap::GlobalMap> graph;
  std::shared_ptr<const planning::HybridMap> map;
  std::function<std::vector<geometry::Pose2>()> T_map_stops;  ///< called when the map has changed
};

struct ExplorationGoal {
  geometry::Pose2 T_map_goal;
  std::string text;  ///< for people
};

class Exploration {
 public:
  /// Starts over, including targets given up before. Throws std::invalid_argument like `check` of
  /// the configuration.
  void start(const navigation::TourConfig& config);
  void stop() { tour_.reset(); }
  [[nodiscard]] bool running() const { return tour_ != nullptr; }

  /// Call it every `period`: returns the next goal when it differs from the previous one. `taken`:
  /// the navigator's status refers to the last goal. Paused time does not count.
  std::optional<ExplorationGoal> step(const ExploredFloor& floor,
                                      navigation::NavigatorStatus navigator, bool taken,
                                      std::chrono::nanoseconds period);

  /// Nothing reachable is left; false before start().
  [[nodiscard]] bool done() const { return tour_ && tour_->done(); }
  /// Targets visited so far, and those of them that were not reached.
  [[nodiscard]] std::size_t visited() const { return tour_ ? tour_->targets() : 0; }
  [[nodiscard]] std::size_t given_up() const { return tour_ ? tour_->given_up() : 0; }
  /// A line for people during the exploration.
  [[nodiscard]] std::string summary() const;

 private:
  std::unique_ptr<navigation::ExplorationTour> tour_;
  std::uint64_t goal_id_ = 0;  // number given by the tour
  std::chrono::nanoseconds time_{0};
};

}  // namespace topogeo::web
