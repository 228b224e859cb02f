// A decision about a place that the robot may have returned to, kept with the map as its evidence.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"

namespace topogeo::storage {

struct MapDocument;

struct LoopVerdict {
  /// The values of localization::LoopOutcome, in its order.
  enum class Outcome : std::uint8_t { kAccepted, kGate, kUnconfirmed, kNoClosing, kOutvoted };
  static constexpr std::size_t kOutcomes = 5;

  std::uint32_t step = 0;  ///< local map id of the stop at which it was decided
  std::uint32_t earlier_id = 0;
  std::uint32_t later_id = 0;
  Outcome outcome = Outcome::kGate;
  std::string explanation;  ///< "match not accepted: few inliers"
  std::string source;       ///< reason for the comparison: "prediction", "place" or "window"
  geometry::Pose2 T_earlier_later;  ///< as matched
  geometry::Pose2 T_predicted;      ///< the same before the match
  Eigen::Matrix3d predicted_covariance = Eigen::Matrix3d::Zero();
  double correction_m = 0.0;  ///< displacement of the later stop by the match
  double correction_rad = 0.0;
  double fitness = 0.0;      ///< [0, 1]
  double probability = 0.0;  ///< of a correct match, [0, 1]

  friend bool operator==(const LoopVerdict&, const LoopVerdict&) = default;
};

/// Adds the verdicts of the report beside a map file, for example out/report.json beside
/// out/map.pb, if they are of this map: its loops are those that the report accepts. Keeps the
/// verdicts that the map has itself. Never throws for a report: the map is good without it.
void add_verdicts_of_report(MapDocument& document, const std::filesystem::path& map_file);

}  // namespace topogeo::storage
