// How far a map can be trusted, judged without a reference: by its measurements and by odometry.
#pragma once

#include <cstdint>
#include <string>

#include "topogeo/storage/map_document.hpp"
#include "topogeo/storage/report.hpp"

namespace topogeo::results {

/// Facts that are in neither map nor report.
struct QualityInputs {
  std::string log;           ///< as the user wrote it, for the suggested command
  bool laser_known = false;  ///< whether log or configuration state the mounting of the laser
  std::uint32_t recent_matches = 3;  ///< localizer.recent_matches: most for each stop
};

/// Fills the quality of a report, whose counts and skipped lines must be filled. The thresholds and
/// the logs they were chosen on: docs/decisions/map_quality.md. A map without edges, as of the
/// modes of the Thesis, is not assessed.
void add_quality(storage::Report& report, const storage::MapDocument& document,
                 const QualityInputs& inputs);

/// Lines for people: the grade with its reasons and the advice, the steps that rest on odometry
/// alone, and where map and odometry differ. Empty if the map was not assessed.
std::string quality_text(const storage::Report& report);

/// Whether the map shows nothing but odometry over a long drive.
bool is_useless(const storage::Report& report);

}  // namespace topogeo::results
