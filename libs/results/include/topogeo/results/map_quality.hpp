// How far a map can be trusted, judged without a reference: by its measurements and by odometry.
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>

#include "topogeo/storage/map_document.hpp"
#include "topogeo/storage/report.hpp"

namespace topogeo::results {

/// A change of settings that may make a better map of the same log.
enum class Remedy : std::uint8_t {
  kMoreStops,      ///< half the distance between stops
  kOdometryNoise,  ///< the noise of the odometry as measured in the log
  kLaserOdometry,  ///< odometry from the scans in place of the log's
};

/// Facts that are in neither map nor report.
struct QualityInputs {
  std::string log;           ///< as the user wrote it, for the suggested command
  bool laser_known = false;  ///< whether log or configuration state the mounting of the laser
  std::uint32_t recent_matches = 3;          ///< localizer.recent_matches: most for each stop
  std::uint64_t unmapped_stops = 0;          ///< of a robot that was not found again in its map
  std::set<Remedy> tried{};                  ///< these were tried already
  std::uint64_t scans_without_odometry = 0;  ///< left out, because the log has none at their time
  bool range_scale_known = false;            ///< whether the configuration states scan.range_scale
};

/// Fills the quality of a report, whose counts and skipped lines must be filled. The thresholds and
/// the logs they were chosen on: docs/decisions/map_quality.md. A map without edges, as of the
/// modes of the Thesis, is not assessed.
void add_quality(storage::Report& report, const storage::MapDocument& document,
                 const QualityInputs& inputs);

/// The remedy that the advice names for a poor map, or for a fair one whose wheels slip; empty if
/// there is none.
std::optional<Remedy> advised_remedy(const storage::Report& report);

/// Whether a map is better than another of the same log: by a tenth more scans in the map, else by
/// its grade, else by half the length of path or less that rests on odometry alone, else, with
/// odometry of the same source, by a quarter more accepted matches of those tried.
bool is_better(const storage::Report& report, const storage::Report& other);

/// Lines for people: the grade with its reasons and the advice, the steps that rest on odometry
/// alone, and where map and odometry differ. Empty if the map was not assessed.
std::string quality_text(const storage::Report& report);

/// Whether the map of a long drive is probably wrong: it shows nothing but odometry, is poor for
/// another reason than scans that were left out, or has another scale than odometry.
bool is_unreliable(const storage::Report& report);

}  // namespace topogeo::results
