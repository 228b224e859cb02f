// The files that a run leaves behind, and the part of its report that follows from the map.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "topogeo/pipeline/stop_overlaps.hpp"
#include "topogeo/scan/carmen_log_reader.hpp"
#include "topogeo/slam/loop/loop_decision.hpp"
#include "topogeo/slam/slam.hpp"
#include "topogeo/storage/map_document.hpp"
#include "topogeo/storage/report.hpp"

namespace topogeo::results {

/// Writes trajectory.tum, odometry.tum, map.pb, map.svg and map.png into an existing directory,
/// each whole or not at all. Unlocated stops appear in odometry.tum and map.pb only. The first
/// three are byte-identical for the same log, seed and configuration. Throws std::runtime_error
/// naming the file.
void write_map_outputs(const std::filesystem::path& directory, const storage::MapDocument& document,
                       const std::string& title);

/// Lines of the drive that a picture may leave out.
struct PictureParts {
  bool odometry = true;
  bool loops = true;
};

/// The picture of a map as in these files, without unlocated stops.
std::string map_svg(const storage::MapDocument& document, const std::string& title,
                    const PictureParts& parts = {});
std::string map_png(const storage::MapDocument& document, const std::string& title,
                    const PictureParts& parts = {});

/// Fills robot, seed, scans, stops, nodes, branches, loop closures and distance of a report.
void add_map(storage::Report& report, const storage::MapDocument& document);

/// Fills the match counts of a report.
void add_matches(storage::Report& report, const localization::SlamCounts& counts);

/// Fills the loop candidates of a report.
void add_loop_candidates(storage::Report& report,
                         std::span<const localization::LoopDecision> decisions);

/// Fills the overlap sets and solutions of a report.
void add_overlaps(storage::Report& report, std::span<const pipeline::StopOverlaps> overlaps);

/// Fills the part about skipped lines of the log.
void add_log(storage::Report& report, const scan::CarmenLogStatistics& statistics);

}  // namespace topogeo::results
