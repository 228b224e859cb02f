// Doors, narrowings and hall-corridor passages along one branch (Thesis, 5.2.2.1).
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "topogeo/topomap/local_map_builder.hpp"

namespace topogeo::topomap {

struct BranchState {
  std::size_t point = 0;  ///< index along the branch, never its first or last
  NodeKind kind = NodeKind::kDoor;
  BranchPoint at;  ///< the place on the branch, at most half a step from the point
};

/// A reusable work space.
class BranchStateFinder {
 public:
  /// The states of a branch in the order of its points, valid until the next call. A minimum of the
  /// clearance, confirmed on both sides (5.3, 5.4), is a door or a narrowing. A long level stretch
  /// from which the clearance rises is a corridor, and the end of the stretch the passage to the
  /// hall. A maximum is no state. `confirmed` has one value per point; states, and the rise from a
  /// corridor to a hall, need values other than 0, because the clearance also rises where the view
  /// of a wall ends.
  std::span<const BranchState> find(std::span<const BranchPoint> points,
                                    std::span<const char> confirmed, const LocalMapConfig& config);

  /// The states of a branch as printed in the thesis (5.1-5.4), valid until the next call: each
  /// point at which the sign of the slope changes, if all points up to the first one farther than
  /// state_confirm_m continue in the new direction. A change from falling to rising is a door or
  /// narrowing, any other a passage between hall and corridor.
  std::span<const BranchState> find_slope_changes(std::span<const BranchPoint> points,
                                                  std::span<const char> confirmed,
                                                  const LocalMapConfig& config);

 private:
  struct Floor;

  void find_minima(std::span<const BranchPoint> points, double rise_m);
  [[nodiscard]] BranchState state_at(std::span<const BranchPoint> points, double arc_m,
                                     NodeKind kind) const;
  BranchState minimum(std::span<const BranchPoint> points, std::size_t lowest,
                      double reach_m) const;
  double level_of(std::span<const BranchPoint> points, const Floor& floor);
  BranchState mouth_of(std::span<const BranchPoint> points, const Floor& floor, std::ptrdiff_t step,
                       double rise_m);

  std::vector<double> arc_m_;         ///< along the branch, per point
  std::vector<std::size_t> minima_;   ///< indices of points
  std::vector<double> clearances_m_;  ///< of one floor
  std::vector<BranchState> states_;
};

}  // namespace topogeo::topomap
