// A robot starts at an unknown place on an unknown floor and explores it: mapping, choosing
// targets, planning and driving in a closed loop, scored with the truth.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "topogeo/navigation/exploration_tour.hpp"
#include "topogeo/navigation/navigator.hpp"
#include "topogeo/pipeline/config.hpp"
#include "topogeo/planning/hybrid_map.hpp"

#include "navigation_floors.hpp"

namespace topogeo::bench {

struct ExplorationConfig {
  pipeline::Config system;
  navigation::NavigatorConfig navigator;
  navigation::TourConfig tour;
  Wheels wheels = Wheels::kMild;
  double slip_per_m = 0.2;
  double longest_s = 3600.0;  ///< of simulated time
};

struct ExplorationResult {
  bool done = false;      ///< as the explorer reports
  double seen = 0.0;      ///< share of the floor that the robot's body can get to, [0, 1]
  std::size_t rooms = 0;  ///< reachable wide parts of 2 m^2 or more
  std::size_t entered = 0;
  std::uint64_t collisions = 0;
  double path_m = 0.0;
  double scripted_m = 0.0;  ///< length of a tour past everything on the known floor
  double time_s = 0.0;
  std::size_t targets = 0;
  std::size_t given_up = 0;
  std::size_t stops = 0;
  double pose_error_m = 0.0;  ///< root mean square over the stops, relative to the start
  std::string end;            ///< last messages of the tour and the navigator
};

/// Additional data of a run, for pictures and logs; all in the map frame.
struct ExplorationRecord {
  std::shared_ptr<const planning::HybridMap> map;
  std::vector<Eigen::Vector2d> path_m;  ///< true
  std::vector<std::string> log;         ///< a line for each target
};

/// Explores a floor of kNavigationFloors from a start that the seed draws. The same arguments give
/// the same result.
ExplorationResult explore(std::string_view floor, const ExplorationConfig& config,
                          std::uint64_t seed, ExplorationRecord* record = nullptr);

}  // namespace topogeo::bench
