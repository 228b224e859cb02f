// Whether the probabilities of loop decisions are right: a reliability table, with coefficients
// fitted to all logs but the one in question.
#pragma once

#include <array>
#include <cstddef>
#include <iosfwd>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/slam/loop/loop_decision.hpp"

namespace topogeo::bench {

/// A decision on a match, compared with the truth.
struct JudgedDecision {
  localization::LoopDecision decision;
  bool right = false;  ///< within 0.5 m and 10 degrees
};

/// Judges all decisions on matches between stops with a true pose.
std::vector<JudgedDecision> judged_decisions(
    std::span<const localization::LoopDecision> decisions,
    const std::vector<std::optional<geometry::Pose2>>& T_world_stop);

struct JudgedLog {
  std::string name;
  bool recorded = true;  ///< not a synthetic floor
  std::vector<JudgedDecision> decisions;
};

/// Maximum-likelihood coefficients of loop_probability(), with a ridge that keeps those finite that
/// no wrong decision bounds. Each log has the same weight, however many decisions it has.
localization::LoopTerms fitted_coefficients(std::span<const JudgedLog> logs,
                                            std::optional<std::size_t> left_out);

/// Prints the coefficients, and tables of probability against share right: all decisions with the
/// coefficients of the library, and each log with those fitted to the others. Logs whose names are
/// equal up to a slash are left out together.
void print_reliability(std::ostream& out, std::span<const JudgedLog> logs);

/// A line for each decision: log, right, outcome, evidence.
void write_decisions(std::ostream& out, std::span<const JudgedLog> logs);

}  // namespace topogeo::bench
