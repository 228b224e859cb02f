// Input and output of localizing in a stored map, beyond those of mapping.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/pipeline/config.hpp"
#include "topogeo/relocalization/map_tracker.hpp"
#include "topogeo/session/mapping_session.hpp"
#include "topogeo/storage/map_document.hpp"
#include "topogeo/storage/report.hpp"

namespace topogeo::pipeline {

/// "x,y,degrees" in the map frame. Throws std::invalid_argument naming the fault.
geometry::Pose2 parse_pose(const std::string& text);

/// The local maps and poses of a map file. Throws std::runtime_error naming the file if it cannot
/// be read or has no stop with scan points.
std::shared_ptr<const localization::StoredMap> load_stored_map(const std::filesystem::path& file);

/// The map of a document, in the form for localizing in it and continuing it.
std::shared_ptr<const localization::StoredMap> stored_map(const storage::MapDocument& document);

/// Convert the measurements of a pose graph to those of a map file, and back.
std::vector<storage::MapEdge> map_edges(std::span<const localization::PoseGraphEdge> edges);
std::vector<localization::PoseGraphEdge> pose_graph_edges(std::span<const storage::MapEdge> edges);

/// A map file that this robot should continue. Throws std::runtime_error naming the file if it
/// cannot be read, has no stop with scan points, has stops without a place, belongs to another
/// robot, or was made with another mounting of the laser.
std::shared_ptr<const storage::MapDocument> load_map_to_continue(const std::filesystem::path& file,
                                                                 const Config& config,
                                                                 const std::string& robot_id);

/// Counts of the stops of a stored map and of a drive that continues it, for reports:
/// "stored_stops", "added_stops" and "unmapped_stops".
storage::ReasonCounts continuation_counts(const localization::MappingSession& session);

/// Explains to the user why stops of a drive are not in the map; empty if all are.
std::string continuation_message(const localization::MappingSession& session);

/// The text of localization.csv: a line for each stop with pose, state, confidence and standard
/// deviations; the same bytes for the same stops.
std::string localization_csv(std::span<const localization::LocalizedStop> stops);
/// Parts of localization_csv(), for callers that do not have all stops at once.
std::string localization_csv_header();
std::string localization_csv_rows(std::span<const localization::LocalizedStop> stops);

/// Stops by state, and searches, for reports.
storage::ReasonCounts localization_counts(const localization::MapTracker& tracker);

}  // namespace topogeo::pipeline
