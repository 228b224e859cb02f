// Compares the loops of a map with a reference trajectory: stops that return to a place, and the
// revisits that became loops.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/pipeline/reliability.hpp"
#include "topogeo/storage/report.hpp"
#include "topogeo/topomap/local_map.hpp"
#include "topogeo/topomap/trajectory.hpp"

namespace topogeo::pipeline {

/// A stop within 2 m and 57 degrees (1 rad) of a stop 30 or more stops older.
struct Revisit {
  std::uint32_t stop = 0;  ///< local map id
  bool tried = false;      ///< compared with at least one of these older stops
  bool accepted = false;   ///< the map has a loop to at least one of these
  /// At the reference poses, half of the stop's points are in view of one of these and within 0.2 m
  /// of its points or outline: the two scans alone can be matched.
  bool in_view = false;
};

/// A loop of the map that is more than 0.6 m or 0.2 rad off the reference.
struct LoopOffReference {
  storage::LoopCandidate loop;
  double off_m = 0.0;
  double off_rad = 0.0;
  /// Agreement of the two scans, overlap * (inliers - 2 violations) of localization::PoseEvidence:
  /// at the match and at the relative pose of the reference.
  double in_common = 0.0;
  double in_common_by_reference = 0.0;

  /// The scans fit no better than at the reference. Otherwise the reference itself is in doubt.
  [[nodiscard]] bool wrong() const { return in_common <= in_common_by_reference; }
};

/// Decisions of one source with one outcome, by their distance from the reference.
struct LoopOutcomeCounts {
  std::string source;     ///< LoopCandidate::source
  std::string outcome;    ///< "accepted", "match not accepted: few inliers", ...
  std::size_t right = 0;  ///< within 0.25 m and 0.09 rad
  std::size_t near = 0;   ///< within 0.6 m and 0.2 rad
  std::size_t wrong = 0;  ///< further off

  friend bool operator==(const LoopOutcomeCounts&, const LoopOutcomeCounts&) = default;
};

struct LoopRecall {
  std::size_t stops = 0;  ///< stops with a reference pose; others do not count
  std::vector<Revisit> revisits;
  std::vector<LoopOffReference> off_reference;  ///< in order of acceptance
  std::vector<LoopOutcomeCounts> outcomes;      ///< by source, then outcome
  /// For the probabilities of all decisions on matches, which are right within 0.5 m and 10
  /// degrees.
  Reliability reliability;

  [[nodiscard]] std::size_t tried() const;             ///< of the revisits
  [[nodiscard]] std::size_t accepted() const;          ///< of the revisits
  [[nodiscard]] std::size_t in_view() const;           ///< of the revisits
  [[nodiscard]] std::size_t accepted_in_view() const;  ///< of those in view
  [[nodiscard]] std::size_t wrong() const;             ///< of the loops
  /// Right decisions that did not become loops, by outcome.
  [[nodiscard]] std::map<std::string, std::size_t> rejected() const;
};

/// `maps[i]` is the local map of id i, `candidates` are the decisions in their order; a loop that
/// was outvoted later does not count. The reference pose of a stop is the one nearest in time, at
/// most `max_apart_ns` away. Throws std::invalid_argument if a candidate names an unknown stop, or
/// no stop has a reference pose.
LoopRecall loop_recall(std::span<const topomap::LocalMap> maps,
                       std::span<const topomap::StampedPose> T_reference_robot,
                       std::span<const storage::LoopCandidate> candidates,
                       std::int64_t max_apart_ns = 50'000'000);

}  // namespace topogeo::pipeline
