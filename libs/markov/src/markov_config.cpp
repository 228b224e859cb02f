#include "topogeo/markov/markov_config.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>

#include "topogeo/markov/belief_grid.hpp"
#include "topogeo/markov/transition.hpp"
#include "topogeo/support/config_schema.hpp"

namespace topogeo::markov {
namespace {

void require_odd(std::string_view key, int value) {
  if (value % 2 == 0) support::refuse_value(key, value, "an odd number");
}

constexpr std::string_view kBandsKey = "markov.reliability_bands";

void check_bands(const SonarModelConfig& config) {
  double from_m = 0.0;
  for (const ReliabilityBand& band : config.bands) {
    support::require_between(kBandsKey, band.up_to_m, from_m, config.max_range_m, "m");
    support::require_between(kBandsKey, band.reliability, 0.0, 1.0, "");
    from_m = band.up_to_m;
  }
}

support::NumberRows rows_of_bands(const std::vector<ReliabilityBand>& bands) {
  support::NumberRows rows;
  for (const ReliabilityBand& band : bands) rows.push_back({band.up_to_m, band.reliability});
  return rows;
}

std::optional<std::vector<ReliabilityBand>> bands_of(const support::NumberRows& rows) {
  if (rows.empty()) return std::nullopt;
  std::vector<ReliabilityBand> bands;
  for (const std::vector<double>& row : rows) {
    if (row.size() != 2) return std::nullopt;
    bands.push_back({row[0], row[1]});
  }
  return bands;
}

/// If the number of values of a matrix in memory does not fit its cells, the rows are refused.
support::NumberRows rows_of_matrix(const TransitionMatrix& matrix) {
  support::NumberRows rows;
  const auto columns = static_cast<std::size_t>(std::max(1, matrix.columns));
  for (std::size_t i = 0; i < matrix.values.size(); ++i) {
    if (i % columns == 0) rows.emplace_back();
    rows.back().push_back(matrix.values[i]);
  }
  return rows;
}

std::optional<TransitionMatrix> matrix_of(const support::NumberRows& rows) {
  if (rows.empty()) return std::nullopt;
  TransitionMatrix matrix;
  matrix.rows = static_cast<int>(rows.size());
  matrix.columns = static_cast<int>(rows.front().size());
  for (const std::vector<double>& row : rows) {
    if (row.size() != rows.front().size()) return std::nullopt;
    matrix.values.insert(matrix.values.end(), row.begin(), row.end());
  }
  return matrix;
}

void describe_transition(TransitionModel& model, support::ConfigSchema& schema) {
  const auto add_matrix = [&](const char* key, TransitionMatrix* matrix, const char* why) {
    schema.add_rows(key, matrix, rows_of_matrix, matrix_of,
                    "rows of as many probabilities, odd numbers of rows and columns, 21 at the "
                    "most, sum from 0.1 to 1.01",
                    why);
  };
  add_matrix("markov.advance_matrix", &model.advance,
             "grid positions: probabilities of the cells around the expected end of an advance; "
             "rows lie across the motion, the upper one to the left, columns along it "
             "(arrow_sense); MACONDO, fig. 6");
  add_matrix("markov.left_matrix", &model.left,
             "the same for a turn to the left, which MACONDO does not print; axes of the robot "
             "before the turn");
  add_matrix("markov.right_matrix", &model.right, "the same for a turn to the right");
  schema.add("markov.arrow_sense", &model.sense,
             {{"right", ArrowSense::kRight}, {"left", ArrowSense::kLeft}},
             "direction of the arrow beside MACONDO's matrix of an advance, which the print does "
             "not show; right: the right column is ahead of the robot, which tends to go too far; "
             "left: the right column is behind it");
  schema.add("markov.advance_step_m", &model.advance_step_m, 0.0, 100.0, "m",
             "length of the step that the matrix of an advance describes, from 0.01 on; 0: a whole "
             "primitive");
  schema.add(
      "markov.turn_step_rad", &model.turn_step_rad, 0.0, 6.3, "rad",
      "angle of the step that the matrix of a turn describes, from 0.01 on; 0: a whole primitive");
}

}  // namespace

void describe(SonarModelConfig& config, support::ConfigSchema& schema) {
  schema.add("markov.max_range_m", &config.max_range_m, 0.5, 20.0, "m",
             "expected and measured readings beyond it count as this range");
  schema.add("markov.rays_per_cone", &config.rays_per_cone, 1, 31, "rays",
             "rays across the cone of a sonar; odd, so that one is the axis");
  schema.add("markov.scale_m", &config.scale_m, 0.001, 10.0, "m",
             "mean difference of the readings that makes a place e times less likely");
  schema.add("markov.difference_cap_m", &config.difference_cap_m, 0.01, 20.0, "m",
             "larger differences count as this, so that one reading of a person does not decide");
  schema.add("markov.formula", &config.formula,
             {{"exponential", PerceptualFormula::kExponential},
              {"inverse", PerceptualFormula::kInverse},
              {"linear", PerceptualFormula::kLinear}},
             "probability for the mean difference d and s = scale_m: exp(-d / s), 1 / (1 + d / s) "
             "or 1 - d / s; MACONDO states only that it falls");
  schema.add_rows("markov.reliability_bands", &config.bands, rows_of_bands, bands_of,
                  "pairs of a distance in m and a reliability of 0 to 1, distances ascending up "
                  "to max_range_m",
                  "grid positions: reliability of readings up to the expected distance of each "
                  "pair; 0 beyond the last; as MACONDO measured its sonars");
  schema.add("markov.weigh_by_reliability", &config.weigh_by_reliability,
             "weights each difference by the reliability of its reading; MACONDO: all alike");
  schema.fix({"markov.rays_per_cone", "markov.difference_cap_m"});
}

void describe(MarkovConfig& config, support::ConfigSchema& schema) {
  schema.add("markov.window_cells", &config.window_cells, BeliefGrid::kSmallest,
             BeliefGrid::kLargest, "cells",
             "side of the window of probabilities, an odd number; MACONDO: 21");
  schema.add("markov.perceptual_weight", &config.perceptual_weight, 0.0, 1.0, "",
             "weight of fully reliable readings against the movement; MACONDO: 0.6");
  describe_transition(config.transition, schema);
  describe(config.sonar, schema);
}

void describe(PoseGridConfig& config, support::ConfigSchema& schema) {
  schema.add("markov.pose_window_m", &config.window_m, 0.5, 5.0, "m",
             "grid poses: side of the window of positions");
  schema.add("markov.pose_cell_m", &config.cell_m, 0.02, 0.5, "m",
             "grid poses: side of a cell of that window");
  schema.add("markov.heading_window_rad", &config.heading_window_rad, 0.1, 6.2, "rad",
             "width of the window of headings, both sides together");
  schema.add("markov.heading_step_rad", &config.heading_step_rad, 0.01, 0.2, "rad",
             "difference between two headings of that window");
  schema.add("markov.station_sigma_m", &config.station_sigma_m, 0.005, 0.5, "m",
             "standard deviation of the robot's position on its base station");
  schema.add("markov.station_sigma_rad", &config.station_sigma_rad, 0.005, 0.5, "rad",
             "standard deviation of the robot's heading on its base station");
  schema.add("markov.path_sigma_m", &config.path_sigma_m, 0.001, 0.5, "m",
             "standard deviation of odometry along and across the path, per root of a metre");
  schema.add("markov.path_sigma_rad", &config.path_sigma_rad, 0.001, 0.5, "rad",
             "standard deviation of the heading of odometry, per root of a metre");
  schema.add("markov.turn_sigma_rad", &config.turn_sigma_rad, 0.001, 0.5, "rad",
             "standard deviation of the heading of odometry, per root of a radian turned");
  schema.add("markov.turn_sigma_m", &config.turn_sigma_m, 0.0, 0.5, "m",
             "standard deviation of the position of odometry, per root of a radian turned");
  schema.add("markov.perceive_every_m", &config.perceive_every_m, 0.02, 2.0, "m",
             "distance between two perceptual updates; sonars are read while the robot drives");
  schema.add("markov.perceive_every_rad", &config.perceive_every_rad, 0.02, 2.0, "rad",
             "turn between two perceptual updates");
  schema.add("markov.hit_sigma_m", &config.hit_sigma_m, 0.01, 1.0, "m",
             "standard deviation of a reading of the expected obstacle, cells of the map included");
  schema.add("markov.far_from_m", &config.far_from_m, 0.5, 20.0, "m",
             "readings beyond this distance are worse; MACONDO: 2.5");
  schema.add("markov.far_off_share", &config.far_off_share, 0.0, 1.0, "",
             "share of those readings that are off; the others are exact; MACONDO: three of four");
  schema.add("markov.far_off_m", &config.far_off_m, 0.01, 2.0, "m",
             "largest error of those readings; MACONDO: 0.3");
  schema.add("markov.hit_share", &config.hit_share, 0.05, 0.95, "",
             "share of readings of the expected obstacle");
  schema.add("markov.short_share", &config.short_share, 0.0, 0.5, "",
             "share of readings of a nearer obstacle that is not on the map");
  schema.add("markov.evidence", &config.evidence, 0.05, 1.0, "",
             "weight of one update, because readings taken close together have correlated errors");
  schema.add("markov.least_agreement", &config.least_agreement, 0.0, 0.9, "",
             "smallest share of near readings that agree with the map; below it the pose is lost");
  schema.fix({"markov.pose_window_m", "markov.pose_cell_m", "markov.heading_window_rad",
              "markov.heading_step_rad", "markov.far_off_share", "markov.far_off_m",
              "markov.hit_share", "markov.short_share"});
}

void check(const PoseGridConfig& config) {
  support::check_ranges(config);
  constexpr int kMostCells = 101;
  constexpr int kMostHeadings = 181;
  if (config.window_m / config.cell_m > kMostCells) {
    support::refuse_value("markov.pose_window_m", config.window_m, "at most 101 of pose_cell_m");
  }
  if (config.heading_window_rad / config.heading_step_rad > kMostHeadings) {
    support::refuse_value("markov.heading_window_rad", config.heading_window_rad,
                          "at most 181 of heading_step_rad");
  }
  if (config.hit_share + config.short_share > 0.98) {
    support::refuse_value("markov.short_share", config.short_share,
                          "at most 0.98 together with hit_share");
  }
}

void check(const SonarModelConfig& config) {
  support::check_ranges(config);
  require_odd("markov.rays_per_cone", config.rays_per_cone);
  check_bands(config);
}

void check(const MarkovConfig& config) {
  support::check_ranges(config);
  require_odd("markov.window_cells", config.window_cells);
  check(config.transition);
  check(config.sonar);
}

}  // namespace topogeo::markov
