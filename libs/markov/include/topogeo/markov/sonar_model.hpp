// The perceptual model: the expected readings of the sensors at every cell of the window, compared
// with the actual readings (MACONDO, III.1).
//
// A virtual reading counts the cells from the sensor to the nearest obstacle: the distance from the
// sensor to the near side of the first obstacle cell on a ray; the shortest of several rays across
// the cone. In every cell of the window the robot has the same position within the cell as
// expected, so a ray crosses the same pattern of cells from everywhere, and one or two words test a
// row of the window. A test compares this with rays cast one by one; the benchmark markov/21 shows
// the cost.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/markov/markov_config.hpp"
#include "topogeo/markov/obstacle_cells.hpp"
#include "topogeo/markov/range_sensor.hpp"

namespace topogeo::markov {

/// Throws std::invalid_argument naming the sensor: none or more than 1,000, a mount not finite or
/// more than 5 m from the robot, half_cone_rad not in [0, pi/2].
void check(std::span<const RangeSensor> sensors);

/// Reliability of a reading by its expected distance, metres (infinity: nothing in range).
double reliability_of(const SonarModelConfig& config, double expected_m);

/// The evidence of the readings about the window.
struct PerceptualMatch {
  int compared = 0;          ///< number of readings
  double reliability = 0.0;  ///< mean over all sensors; a sensor without a reading has 0
  /// Smallest mean absolute difference over the free cells, metres; infinity without a comparison.
  double best_difference_m = 0.0;
  /// True if the probabilities are evidence: a reading was compared and some free cell is possible.
  bool informative = false;
};

/// A reusable work space.
class SonarModel {
 public:
  /// Throws std::invalid_argument like both check().
  SonarModel(std::vector<RangeSensor> sensors, const SonarModelConfig& config);

  [[nodiscard]] std::size_t sensors() const { return sensors_.size(); }

  /// Computes the virtual readings of the window of `size` cells (odd, 5..101) around the cell of
  /// `T_map_robot`, for its free cells and for the middle one.
  void look_around(const ObstacleCells& map, const geometry::Pose2& T_map_robot, int size);

  /// Virtual reading at an offset from the middle of the last window of look_around(), metres;
  /// infinity if there is nothing within max_range_m or the cell is not free. Space outside the map
  /// is empty. `offset` must be within the window.
  [[nodiscard]] double virtual_m(std::size_t sensor, Cell offset) const;

  /// Compares the readings (one per sensor, metres, scan::Scan::kNoReturn for none) with the
  /// virtual ones and writes the probability of every cell of the window, with sum one; all zero
  /// without evidence. Reliability is that of the middle of the window. Throws
  /// std::invalid_argument naming the sensor: another number of readings, one that is negative or
  /// not finite.
  PerceptualMatch compare(std::span<const float> ranges_m, std::span<double> probabilities);

 private:
  /// A cell crossed by a ray: offset from the robot's cell, and the distance at which the ray
  /// enters it.
  struct Crossing {
    int x;
    int y;
    double distance_m;
  };

  void take_surroundings(const ObstacleCells& map, Cell centre, double reach_m);
  void follow_ray(const Eigen::Vector2d& start_cells, double bearing_rad);
  void cast(std::span<double> readings);
  [[nodiscard]] std::uint64_t surroundings_bits(int x, int y) const;
  double add_differences(std::span<const float> ranges_m, PerceptualMatch& match);
  [[nodiscard]] double probability_of(double difference_m) const;

  SonarModelConfig config_;
  std::vector<RangeSensor> sensors_;
  int size_ = 0;
  double cell_m_ = 0.0;
  std::vector<RowBits> free_;
  std::vector<RowBits> asked_;  ///< the free cells and the middle one
  /// Obstacles of the window and around it within the range of the sensors, rows of words.
  int margin_ = 0;
  int words_a_row_ = 0;
  std::vector<std::uint64_t> surroundings_;
  std::vector<Crossing> crossings_;
  std::vector<RowBits> open_;        ///< cells whose ray has not hit an obstacle yet
  std::vector<double> virtual_m_;    ///< sensor after sensor, row after row
  std::vector<double> differences_;  ///< per cell, over the compared readings
};

}  // namespace topogeo::markov
