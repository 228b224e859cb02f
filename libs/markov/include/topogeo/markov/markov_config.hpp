// Settings of Markov localization and its sensor model.
#pragma once

#include <numbers>
#include <vector>

namespace topogeo::support {
class ConfigSchema;
}

namespace topogeo::markov {

struct TransitionMatrix {
  int rows = 0;                ///< odd
  int columns = 0;             ///< odd
  std::vector<double> values;  ///< rows x columns, the upper row first
};

/// MACONDO, III.1, fig. 6, an advance. It sums to 0.9961, because its figures are rounded. The sum
/// is not corrected here; the localizer normalizes the state after each update.
TransitionMatrix macondo_advance();

/// A quarter turn on the spot: 0.9 to stay, 0.02 for each neighbour, 0.005 for each diagonal one.
/// MACONDO has no figures for its turns.
TransitionMatrix quarter_turn();

/// Direction of the arrow of MACONDO, III.1, fig. 6, which the print does not show.
enum class ArrowSense {
  kRight,  ///< the right column is ahead of the robot: it tends to go too far
  kLeft,   ///< the right column is behind it: it tends to slip
};

struct TransitionModel {
  TransitionMatrix advance = macondo_advance();
  TransitionMatrix left = quarter_turn();
  TransitionMatrix right = quarter_turn();
  ArrowSense sense = ArrowSense::kRight;
  /// Length and angle of the step that a matrix describes; 0: the matrix is applied once per
  /// primitive, however long.
  double advance_step_m = 0.10;
  double turn_step_rad = 0.5 * std::numbers::pi;
};

/// Probability from the mean absolute difference d of the compared readings, scale s (not
/// normalized). MACONDO only states that it falls with a growing difference.
enum class PerceptualFormula {
  kExponential,  ///< exp(-d / s)
  kInverse,      ///< 1 / (1 + d / s)
  kLinear,       ///< max(0, 1 - d / s)
};

/// Reliability of a reading up to this expected distance, and beyond that of the previous band.
struct ReliabilityBand {
  double up_to_m = 0.0;
  double reliability = 0.0;
};

struct SonarModelConfig {
  double max_range_m = 5.0;  ///< not below the last band
  int rays_per_cone = 5;     ///< of a cone with an opening angle, edges included
  /// Ascending; beyond the last the reliability is 0.
  std::vector<ReliabilityBand> bands = {{2.5, 1.0}, {5.0, 0.25}};
  PerceptualFormula formula = PerceptualFormula::kExponential;
  double scale_m = 0.05;
  double difference_cap_m = 0.5;
  /// Weights each difference by the reliability of its reading. In MACONDO, reliability only
  /// affects the weight of the whole vector.
  bool weigh_by_reliability = false;
};

struct MarkovConfig {
  int window_cells = 21;
  TransitionModel transition{};
  SonarModelConfig sonar{};
  double perceptual_weight = 0.6;
};

/// Markov localization over positions and headings (pose_localizer.hpp), after Fox, Burgard and
/// Thrun; MACONDO's window of positions is a simple form of it.
struct PoseGridConfig {
  double window_m = 2.1;  ///< side of the window of positions
  double cell_m = 0.05;
  double heading_window_rad = 1.5;
  double heading_step_rad = 0.035;
  /// Uncertainty of the robot on its base station, one sigma.
  double station_sigma_m = 0.05;
  double station_sigma_rad = 0.05;
  // Odometry, one sigma per root of a metre or a radian.
  double path_sigma_m = 0.05;        ///< along and across the path, per root of a metre
  double path_sigma_rad = 0.03;      ///< per root of a metre
  double turn_sigma_rad = 0.12;      ///< per root of a radian turned
  double turn_sigma_m = 0.03;        ///< per root of a radian turned
  double perceive_every_m = 0.10;    ///< driven between two perceptual updates
  double perceive_every_rad = 0.10;  ///< turned between two of them
  // Model of one reading, given the expected distance.
  double hit_sigma_m = 0.06;
  // Beyond far_from_m three of four readings are off by up to 0.3 m, one is exact (MACONDO, III.1).
  double far_from_m = 2.5;
  double far_off_share = 0.75;
  double far_off_m = 0.30;
  double hit_share = 0.75;    ///< share of readings of the expected obstacle
  double short_share = 0.10;  ///< share of readings of a nearer obstacle that is not on the map
  double evidence = 0.4;      ///< exponent: errors of successive readings are correlated
  /// The pose is lost if the smoothed share of near readings that agree with the map falls below
  /// this.
  double least_agreement = 0.25;
};

// Declare the part of the section `markov` that does not depend on the map; MarkovConfig includes
// its sonar model.
void describe(SonarModelConfig& config, support::ConfigSchema& schema);
void describe(MarkovConfig& config, support::ConfigSchema& schema);
void describe(PoseGridConfig& config, support::ConfigSchema& schema);

// Throw std::invalid_argument naming key or field, value and range.
void check(const SonarModelConfig& config);
void check(const MarkovConfig& config);
void check(const PoseGridConfig& config);

}  // namespace topogeo::markov
