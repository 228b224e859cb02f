#include "branch_access.hpp"

#include <algorithm>

#include "topogeo/geometry/segment.hpp"

#include "cell_line.hpp"

namespace topogeo::planning {
namespace {

using topomap::MapBranch;

// A segment is as narrow as its narrower end, because its ends are only centimetres apart.
bool wide(const MapBranch& branch, std::size_t segment, double min_clearance_m) {
  return branch.is_virtual || std::min(branch.points[segment].clearance_m,
                                       branch.points[segment + 1].clearance_m) >= min_clearance_m;
}

BranchPlace nearest_on(const topomap::GlobalMap& map, std::size_t branch, std::size_t segment,
                       const Eigen::Vector2d& point_m) {
  const topomap::BranchPoint& a = map.branches[branch].points[segment];
  const topomap::BranchPoint& b = map.branches[branch].points[segment + 1];
  const geometry::SegmentPlace nearest =
      geometry::nearest_on_segment(a.position_m, b.position_m, point_m);
  BranchPlace place;
  place.branch = branch;
  place.segment = segment;
  place.along = nearest.share;
  place.at.position_m = nearest.point_m;
  place.at.clearance_m = a.clearance_m + place.along * (b.clearance_m - a.clearance_m);
  place.distance_m = (point_m - place.at.position_m).norm();
  return place;
}

}  // namespace

std::optional<BranchPlace> nearest_place(const topomap::GlobalMap& map,
                                         const Eigen::Vector2d& point_m, double min_clearance_m) {
  std::optional<BranchPlace> best;
  for (std::size_t b = 0; b < map.branches.size(); ++b) {
    for (std::size_t i = 0; i + 1 < map.branches[b].points.size(); ++i) {
      if (!wide(map.branches[b], i, min_clearance_m)) continue;
      const BranchPlace place = nearest_on(map, b, i, point_m);
      if (!best || place.distance_m < best->distance_m) best = place;
    }
  }
  return best;
}

bool AccessFinder::open(const MapBranch& branch, std::size_t segment) const {
  if (!wide(branch, segment, config_.min_clearance_m)) return false;
  if (rules_.empty()) return true;
  return !rules_.shut(branch.points[segment].position_m) &&
         !rules_.shut(branch.points[segment + 1].position_m);
}

std::vector<BranchAccess> AccessFinder::of(const Eigen::Vector2d& point_m, End end) const {
  std::vector<BranchAccess> accesses;
  for (std::size_t b = 0; b < map_.branches.size(); ++b) {
    const MapBranch& branch = map_.branches[b];
    std::optional<BranchAccess> best;
    const auto end_stretch = [&] {
      if (best) accesses.push_back(*best);
      best.reset();
    };
    for (std::size_t i = 0; i + 1 < branch.points.size(); ++i) {
      if (!open(branch, i)) {
        end_stretch();
        continue;
      }
      const BranchPlace place = nearest_on(map_, b, i, point_m);
      if (place.distance_m > config_.max_snap_m) continue;
      if (best && kLastResort * place.distance_m >= best->cost) continue;
      const auto candidate = access(place, point_m, end);
      if (candidate && (!best || candidate->cost < best->cost)) best = candidate;
    }
    end_stretch();
  }
  return accesses;
}

std::optional<BranchAccess> AccessFinder::access(const BranchPlace& place,
                                                 const Eigen::Vector2d& point_m, End end) const {
  constexpr double kHere_m = 0.5;     // a robot may stand this near to forbidden floor
  constexpr double kUnproved = 10.0;  // cost of a metre that may not be free
  BranchAccess access{place, kLastResort * place.distance_m, false};
  // When the grid is overruled, the goal needs room for the body, up to the accuracy of fused
  // positions; without a grid the robot's guard decides how near it gets.
  constexpr double kExact_m = 0.1;
  const bool outvotes = end == End::kGoal && space_ != nullptr;
  const double body_m = outvotes ? std::max(0.0, config_.min_clearance_m - kExact_m) : 0.0;
  const bool in_circle = place.distance_m + body_m <= place.at.clearance_m;
  const auto near_start = [&](const Eigen::Vector2d& at_m) {
    return end == End::kStart && (at_m - point_m).norm() < kHere_m;
  };
  // Half a cell: misses at most the corner of one.
  const double step_m = space_ == nullptr ? 0.05 : 0.5 * space_->frame().resolution_m;
  const int steps = static_cast<int>(place.distance_m / step_m) + 1;
  int unproved = 0;
  for (int k = 0; k <= steps; ++k) {
    const double share = static_cast<double>(k) / steps;
    const Eigen::Vector2d at_m = point_m + share * (place.at.position_m - point_m);
    if (rules_.filled(at_m) || (rules_.shut(at_m) && !near_start(at_m))) return std::nullopt;
    if (space_ == nullptr) continue;
    const auto cell = space_->frame().cell_of(at_m);
    const bool occupied = cell && space_->grid().at(*cell) == CellState::kOccupied;
    if (occupied && (!in_circle || (k == 0 && end == End::kGoal))) return std::nullopt;
    if (!cell || (!space_->passable(*cell) && !near_start(at_m))) ++unproved;
  }
  access.proved = in_circle || (space_ != nullptr && unproved == 0);
  if (access.proved) return access;
  const double share = space_ == nullptr ? 1.0 : static_cast<double>(unproved) / (steps + 1);
  access.cost *= 1.0 + (kUnproved - 1.0) * share;
  return access;
}

}  // namespace topogeo::planning
