// The report of a run, report.json: input, settings, counts and times.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/support/config_schema.hpp"
#include "topogeo/support/cpu_time.hpp"
#include "topogeo/topomap/trajectory.hpp"

namespace topogeo::storage {

/// Counts by reason, in the order of the output.
using ReasonCounts = std::vector<std::pair<std::string, std::uint64_t>>;

/// A place that the robot may have returned to, and the decision about it.
struct LoopCandidate {
  std::uint32_t step = 0;  ///< local map id of the stop at which it was decided
  std::uint32_t earlier_id = 0;
  std::uint32_t later_id = 0;
  std::string outcome;  ///< "accepted" or the reason against it
  std::string reason;   ///< of the match: "accepted" or why it was rejected
  geometry::Pose2 T_earlier_later;
  double correction_m = 0.0;  ///< displacement of the later stop by the match
  double correction_rad = 0.0;
  double fitness = 0.0;            ///< [0, 1]
  std::string source;              ///< reason for the comparison: "prediction", "place" or "window"
  geometry::Pose2 T_predicted;     ///< predicted T_earlier_later before the match
  double predicted_sigma_m = 0.0;  ///< standard deviation of its position, over both directions
  double predicted_sigma_rad = 0.0;
  double probability = 0.0;  ///< of a correct match, [0, 1]; 0: no common view

  friend bool operator==(const LoopCandidate&, const LoopCandidate&) = default;
};

/// A pose of a stop in an earlier one, found by a search, with the parts of its fitness.
struct OverlapSolution {
  geometry::Pose2 T_earlier_stop;
  double fitness = 0.0;      ///< [0, 1], by the configured form
  double scan = 0.0;         ///< [0, 1], points on points
  double topological = 0.0;  ///< [0, 1], nodes and branches
  double prior = 0.0;        ///< (0, 1], by the prediction

  friend bool operator==(const OverlapSolution&, const OverlapSolution&) = default;
};

/// The search for a stop in an earlier one that it was matched with.
struct OverlapSearch {
  std::uint32_t earlier_id = 0;
  geometry::Pose2 T_predicted;
  std::vector<OverlapSolution> solutions;  ///< best first
  OverlapSolution refined;                 ///< fitness 0: none
  std::string verdict;
  std::string reason;

  friend bool operator==(const OverlapSearch&, const OverlapSearch&) = default;
};

struct Overlaps {
  std::uint32_t stop_id = 0;
  std::vector<std::uint32_t> overlap_set;  ///< earlier stops with a common view, ascending
  std::vector<OverlapSearch> searches;

  friend bool operator==(const Overlaps&, const Overlaps&) = default;
};

/// Consecutive steps of the path that no match measures.
struct OdometryStretchEntry {
  std::uint32_t first_stop = 0;
  std::uint32_t last_stop = 0;
  double x_m = 0.0;  ///< of its first stop, in the map
  double y_m = 0.0;
  double length_m = 0.0;
  double off_m = 0.0;  ///< two standard deviations of its end, seen from its start
  double off_rad = 0.0;
  bool held_by_loop = false;

  friend bool operator==(const OdometryStretchEntry&, const OdometryStretchEntry&) = default;
};

/// A part of the path on which map and odometry differ.
struct PathDisagreementEntry {
  std::string kind;  ///< "length", "turn", "jump", "wheels" or "carried"
  std::uint32_t first_stop = 0;
  std::uint32_t last_stop = 0;
  double odometry_m = 0.0;
  double corrected_m = 0.0;
  double turn_rad = 0.0;  ///< of the map less that of odometry; kinds "turn", "wheels"

  friend bool operator==(const PathDisagreementEntry&, const PathDisagreementEntry&) = default;
};

/// How far the map can be trusted.
struct QualityEntry {
  std::string grade;                 ///< "good", "fair", "poor" or "useless"; "": not assessed
  std::vector<std::string> reasons;  ///< against a better grade
  std::string advice;                ///< command or setting that may help; "": none
  bool unreliable = false;           ///< probably wrong over a long drive
  std::vector<OdometryStretchEntry> odometry_stretches;
  std::vector<PathDisagreementEntry> path_disagreements;

  friend bool operator==(const QualityEntry&, const QualityEntry&) = default;
};

/// Odometry that was made from the scans.
struct LaserOdometryEntry {
  std::uint64_t unplaced = 0;  ///< scans left out, because they match no others
  std::uint64_t breaks = 0;    ///< times that the track was lost
  double step_m = 0.0;         ///< usual distance between successive scans

  friend bool operator==(const LaserOdometryEntry&, const LaserOdometryEntry&) = default;
};

/// Mounting of the laser that was found from the scans.
struct FoundLaserEntry {
  bool searched = false;  ///< false: it was stated
  geometry::Pose2 T_robot_laser;
  bool heading_known = false;   ///< false: not shown, taken as 0
  bool position_known = false;  ///< false: not shown, taken as 0
  bool upside_down = false;
  double heading_spread_rad = 0.0;  ///< one standard deviation
  double position_spread_m = 0.0;   ///< one standard deviation
  double confidence = 0.0;          ///< [0, 1]
  std::uint64_t motions = 0;        ///< compared
  std::uint64_t fitting = 0;        ///< of those, not contradicting

  friend bool operator==(const FoundLaserEntry&, const FoundLaserEntry&) = default;
};

struct Report {
  std::string command;  ///< "map" or "run"
  std::string log;      ///< file name; only the last part of a path is written
  std::string robot_id;
  std::uint64_t seed = 0;
  std::uint32_t workers = 0;
  support::EffectiveConfig configuration;

  std::uint64_t scans = 0;
  ReasonCounts skipped_lines;
  std::optional<LaserOdometryEntry> laser_odometry;  ///< none: the odometry of the log
  std::uint64_t stops = 0;
  std::uint64_t nodes = 0;
  std::uint64_t branches = 0;
  std::uint64_t matches_tried = 0;
  std::uint64_t matches_accepted = 0;
  ReasonCounts matches_rejected;
  std::vector<topomap::LoopClosure> loop_closures;
  std::vector<LoopCandidate> loop_candidates;  ///< in the order of the decisions
  std::vector<Overlaps> overlaps;              ///< empty: not requested
  ReasonCounts localization;  ///< of a drive in a finished map: stops by state; empty: a mapping
  ReasonCounts continuation;  ///< of a map that was continued: its stops; empty: it was not
  double distance_m = 0.0;    ///< along the corrected trajectory
  QualityEntry quality;
  FoundLaserEntry laser;

  double wall_s = 0.0;
  double cpu_s = 0.0;  ///< of all processes
  std::vector<support::StageTime> stages;
};

/// JSON text, keys always in the same order, with the version of the software.
std::string report_json(const Report& report);

/// Reads `loop_candidates` of a report. Throws std::runtime_error naming the path and the missing
/// or damaged part.
std::vector<LoopCandidate> read_loop_candidates(const std::filesystem::path& path);

/// Writes the file whole or not at all. Throws std::runtime_error naming the path.
void write_report(const std::filesystem::path& path, const Report& report);

}  // namespace topogeo::storage
