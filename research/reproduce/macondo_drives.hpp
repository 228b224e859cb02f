// Drives of a simulated MACONDO: it executes the primitives of its route, and Markov localization
// with six sonars brings it back to the route (MACONDO, III.1 and III.3).
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/markov/range_sensor.hpp"
#include "topogeo/planning/hybrid_map.hpp"
#include "topogeo/support/random.hpp"
#include "topogeo/world/world.hpp"

namespace topogeo::reproduce {

/// A drawn floor with cells of 10 cm; the map frame is the world frame.
struct DrawnFloor {
  world::World world;
  std::shared_ptr<const planning::HybridMap> map;
};
DrawnFloor draw_floor(const world::World& world);

/// MACONDO's six sonars, as inputs of Markov localization.
std::vector<markov::RangeSensor> six_sonars();

/// Readings as MACONDO, III.1, reports them: exact up to 2.5 m; from there to 5 m, three of four
/// off by up to 30 cm; none beyond.
std::vector<float> published_readings(const world::World& scene, const geometry::Pose2& T_robot,
                                      support::Random& random);

struct MacondoDrive {
  std::vector<geometry::Pose2> truth;  ///< after each primitive
  std::vector<Eigen::Vector2d> route_m;
  geometry::Pose2 goal;
  bool localized = true;   ///< Markov localization never lost all cells
  bool hit = false;        ///< the middle of the robot came into an obstacle
  bool kept_off = false;   ///< the path back to the route was blocked once or more
  double error_x_m = 0.0;  ///< at the end, along the axes of the grid
  double error_y_m = 0.0;
  /// Within the cell of the goal or an adjacent one.
  [[nodiscard]] bool arrived() const;
};

/// When and how the robot uses its sonars.
enum class PerceptionRule : std::uint8_t {
  kPublished = 0,  ///< when the expected position is a node of the graph or the destination
  kOften = 1,      ///< each half metre, and five times at the destination
  kPoses = 2,      ///< each half metre, by the product's Markov localization over poses
  kNever = 3,      ///< the robot trusts its wheels
};

struct MacondoKind {
  PerceptionRule rule = PerceptionRule::kPublished;
  double wheel_errors = 1.0;  ///< share of the printed transition matrices' errors, [0, 1]
};

/// Drives between two places drawn with `seed`, at least 3 m apart.
MacondoDrive drive_macondo(const DrawnFloor& floor, std::uint64_t seed,
                           const MacondoKind& kind = {});

}  // namespace topogeo::reproduce
