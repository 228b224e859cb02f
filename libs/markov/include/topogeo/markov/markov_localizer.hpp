// Markov localization on a known grid: the cell of the robot within a window around the position
// that its route expects (MACONDO, III.1; docs/algorithms.md, "Markov localization").
//
// The caller reports each executed motion primitive with move(), and the readings of the sensors
// with perceive() whenever the expected position is a node of the graph or the end of the route.
// The heading is assumed to be right: the window contains only positions. No clock, no randomness;
// the same calls give the same bytes everywhere.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/markov/belief_grid.hpp"
#include "topogeo/markov/markov_config.hpp"
#include "topogeo/markov/obstacle_cells.hpp"
#include "topogeo/markov/range_sensor.hpp"
#include "topogeo/markov/sonar_model.hpp"
#include "topogeo/markov/transition.hpp"

namespace topogeo::markov {

enum class MoveKind { kAdvance, kTurnLeft, kTurnRight };

/// A motion primitive.
struct Move {
  MoveKind kind = MoveKind::kAdvance;
  /// Metres ahead (negative: backwards), or radians >= 0 in the direction of `kind`.
  double amount = 0.0;
};

struct MovementReport {
  /// False if no cell is possible any more: from every earlier cell the robot would now be in an
  /// obstacle, outside the map or outside the window.
  bool possible = false;
  /// Smallest sum of the probabilities after a step, before normalization; 1 without a step.
  double kept_share = 1.0;
  std::string reason{};  ///< one line; empty if possible
};

struct PerceptionReport {
  bool possible = false;    ///< as in MovementReport
  PerceptualMatch match{};  ///< evidence of the readings
  double weight = 0.0;      ///< of the perceptual model in the sum; 0: no reading counts
  std::string reason{};     ///< one line: why no cell is possible, or why the weight is 0
};

struct Estimate {
  /// The expected pose, moved by whole cells to the most probable one.
  geometry::Pose2 T_map_robot{};
  Cell cell{};    ///< in the map
  Cell offset{};  ///< from the expected cell; (0, 0): the robot is at its expected cell
  double probability = 0.0;
  double entropy = 0.0;   ///< of the window, nats; 0 (certain) .. log of the number of cells
  double spread_m = 0.0;  ///< root mean square distance from the mean position
};

/// The moves from the robot's position to its place on the route.
struct ReturnMoves {
  /// In the order of execution; empty if the robot is there already.
  std::vector<Move> moves;
  /// The straight line meets an obstacle cell or leaves the map: plan a route instead.
  bool blocked = false;
};

class MarkovLocalizer {
 public:
  /// Throws std::invalid_argument if the configuration or a sensor is out of range.
  MarkovLocalizer(const MarkovConfig& config, ObstacleCells map, std::vector<RangeSensor> sensors);

  /// Starts at the base station: probability one for its cell, then one perceptual update and
  /// weighting. `ranges_m` has one reading per sensor, metres, scan::Scan::kNoReturn for none. Not
  /// possible if the cell of the base station is an obstacle or outside the map; then every
  /// probability is zero. Throws std::invalid_argument for a pose that is not finite or beyond 1e6
  /// m, or invalid readings.
  PerceptionReport initialize(const geometry::Pose2& T_map_base_station,
                              std::span<const float> ranges_m);

  /// The robot has executed a primitive: the expected pose follows it, the window follows the
  /// expected cell, the probabilities spread once per step and are normalized. Throws
  /// std::invalid_argument for an amount that is not finite, beyond 1,000 m or 1,000 rad or a
  /// negative turn, std::runtime_error before initialize().
  MovementReport move(const Move& move);

  /// The perceptual update, combined with the state of the movement model by the reliability of the
  /// readings. If no cell was possible any more, readings that count make the whole window possible
  /// again. Throws std::invalid_argument for invalid readings, std::runtime_error before
  /// initialize().
  PerceptionReport perceive(std::span<const float> ranges_m);

  /// The most probable cell, the one nearest to the expected cell among equals; empty if no cell is
  /// possible or before initialize().
  [[nodiscard]] std::optional<Estimate> estimate() const;

  /// The moves from the estimated position to a pose of the route, by default the expected pose:
  /// turn, advance, turn. Empty without an estimate. Call accept_estimate() before the first of
  /// them, move() after each.
  [[nodiscard]] std::optional<ReturnMoves> relocalization_moves() const;
  [[nodiscard]] std::optional<ReturnMoves> relocalization_moves(
      const geometry::Pose2& T_map_route) const;

  /// Makes the estimated position the expected one. Probabilities stay at their cells of the map;
  /// those outside the new window are lost. Does nothing without an estimate.
  void accept_estimate();

  /// Replaces the map by another state of the same environment, as with a door that was found shut;
  /// it may be larger. New obstacle cells get probability zero. Throws std::invalid_argument if the
  /// size of its cells differs.
  MovementReport set_map(ObstacleCells map);

  [[nodiscard]] const geometry::Pose2& expected() const { return T_map_expected_; }
  [[nodiscard]] const BeliefGrid& belief() const { return belief_; }
  [[nodiscard]] const ObstacleCells& map() const { return map_; }

 private:
  void require_initialized(const char* call) const;
  void step(const geometry::Pose2& T_map_expected, std::span<const Tap> taps,
            MovementReport& report);
  void apply(const geometry::Pose2& T_start_end, const TransitionMatrix& matrix, double heading_rad,
             double steps, MovementReport& report);
  [[nodiscard]] std::string nowhere() const;

  MarkovConfig config_;
  ObstacleCells map_;
  SonarModel sonar_;
  BeliefGrid belief_;
  bool initialized_ = false;
  geometry::Pose2 T_map_expected_{};
  std::vector<RowBits> free_;  ///< of the window
};

}  // namespace topogeo::markov
