// The walls implied by the branches of a local map (own; docs/algorithms.md, "Refinement and
// gate"): a match by nodes and branches alone uses them in place of the scan.
//
// A branch with its clearance is the middle between two objects, and the circles of clearance along
// it touch both. The walls are the inverse of the medial axis transform (Harry Blum: A
// transformation for extracting new descriptors of shape, 1967). Walls beside no branch are
// missing: dead ends, and everything behind the end of a branch.
#pragma once

#include <vector>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/matching/match_config.hpp"
#include "topogeo/matching/match_features.hpp"
#include "topogeo/topomap/local_map.hpp"

namespace topogeo::localization {

/// Places on walls in the robot frame, by bearing from the laser.
struct BranchWalls {
  std::vector<topomap::ScanPoint> points;
  geometry::Pose2 T_robot_laser;
};

/// Points where the circles of clearance of the branches touch; no scan point is read. Branches
/// that are not confirmed count, virtual ones do not: an object not seen yet can move an
/// unconfirmed branch, but the two objects on its sides were seen.
BranchWalls walls_of_branches(const topomap::LocalMap& map);

/// The nodes and branches of `features` with the walls in place of the scan.
MatchFeatures with_walls(const MatchFeatures& features, const BranchWalls& walls);

/// The points of a map for matches by this evidence: of the scan, or walls_of_branches().
std::vector<topomap::ScanPoint> points_for(const topomap::LocalMap& map, MatchEvidence evidence);

}  // namespace topogeo::localization
