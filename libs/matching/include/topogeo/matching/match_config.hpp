// Settings of a match of two local maps, of the noise of odometry, and of the tracking of scans
// between stops.
#pragma once

#include <cstdint>

namespace topogeo::support {
class ConfigSchema;
}

namespace topogeo::localization {

/// How an individual is scored (docs/algorithms.md, "Fitness").
enum class FitnessForm : std::uint8_t {
  kPrinted = 0,      ///< the equations as printed in the thesis, for comparison
  kTopological = 1,  ///< equivalent nodes and branches, clearance, orientation, coverage
  kCombined =
      2,  ///< topological and scan points against a distance field, times the odometry prior
  kTopologicalWeighted = 3,  ///< nodes and branches by repeatability, times the odometry prior
};

/// Evidence that refines the solutions of a search and decides whether the match is accepted.
enum class MatchEvidence : std::uint8_t {
  kScan = 0,      ///< least squares of scan points, and the gate
  kBranches = 1,  ///< the same with walls implied by branches; no scan point counts
  kFitness = 2,   ///< only the fitness, as in the thesis: any above 0 is accepted
};

/// Parameters of the genetic algorithm (docs/algorithms.md, "Genetic search").
struct GeneticParameters {
  std::uint32_t individuals = 50;
  std::uint32_t generations = 30;
  double crossover_rate = 1.0;
  double mutation_rate = 0.05;
  std::uint32_t elite = 2;
  std::uint32_t branch_hypotheses = 10;
  double resolution_m = 0.15;
  double resolution_rad = 0.034906585;         ///< 2 degrees
  double finer_resolution_m = 0.0;             ///< of a second search around each solution; 0: none
  double finer_resolution_rad = 0.0087266463;  ///< 0.5 degrees
  friend bool operator==(const GeneticParameters&, const GeneticParameters&) = default;
};

/// Conditions for accepting the result of a match (match_gate.hpp).
struct GateConfig {
  double smallest_overlap = 0.20;
  double smallest_inliers = 0.50;
  double largest_doubt = 2.2;  ///< see doubt()
  double doubt_per_search_m = 0.25;
  double largest_mahalanobis2 = 25.0;  ///< 3 degrees of freedom
  double largest_ambiguity = 0.95;     ///< see rivalry()
  friend bool operator==(const GateConfig&, const GateConfig&) = default;
};

// Declare the genetic search in the section `match`, and the section `gate`.
void describe(GeneticParameters& parameters, support::ConfigSchema& schema);
void describe(GateConfig& config, support::ConfigSchema& schema);

/// Variances that grow with the distance travelled, as in the Thesis, 6.2, eq. 6.8
/// (docs/algorithms.md, "Odometry model and search space"), so that they do not depend on the
/// division of a path into steps. In the frame of the step the thesis's diag(|dx|, |dy|, |dtheta|)
/// K_error is translation_m2_per_m = K_error(1,1), heading_rad2_per_rad = K_error(3,3) and zero for
/// the rest, because its robot never moves sideways. The other fields are not in the thesis:
/// - heading_rad2_per_m: wheels slip and differ on a straight path too. Without it every corridor
///   makes the covariance optimistic, which was the costliest mistake of all trials.
/// - lateral_m2_per_m: carpets push the robot sideways, which its wheels do not measure.
/// - translation_m2_per_rad: a turn moves a robot that does not turn exactly about the reference
///   point of its odometry; also an unknown offset of the laser.
/// The defaults are several times the random errors of poor wheels, because errors of real wheels
/// are systematic: 3 % of the distance, the same in every step, adds up as no random error does.
/// `topogeo calibrate-odometry` estimates the values of a robot from a log
/// (odometry_calibration.hpp).
struct OdometryNoise {
  double translation_m2_per_m = 0.02;
  double translation_m2_per_rad = 0.016;
  double lateral_m2_per_m = 0.004;
  double heading_rad2_per_m = 0.16;
  double heading_rad2_per_rad = 0.2;
};

// Range of each; translation_m2_per_rad may also be 0. No wheel has less noise than the smallest
// value, which would make covariances singular.
inline constexpr double kSmallestOdometryNoise = 1e-6;
inline constexpr double kLargestOdometryNoise = 1.0;

/// Declares the section `odometry`.
void describe(OdometryNoise& noise, support::ConfigSchema& schema);

struct ScanTrackerConfig {
  OdometryNoise odometry;  ///< the localizer's
  double smallest_overlap = 0.3;
  double smallest_inliers = 0.6;
  double largest_mahalanobis2 = 16.0;
};

/// Declares the section `tracker`, without the odometry.
void describe(ScanTrackerConfig& config, support::ConfigSchema& schema);

}  // namespace topogeo::localization
