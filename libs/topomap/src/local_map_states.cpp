#include "local_map_states.hpp"

#include <algorithm>

namespace topogeo::topomap {

/// A stretch [first, last] of a branch around a minimum of the clearance.
struct BranchStateFinder::Floor {
  std::size_t lowest = 0;
  std::size_t first = 0;
  std::size_t last = 0;

  static Floor around(std::span<const BranchPoint> points, std::size_t lowest, double plateau_m) {
    const double limit_m = points[lowest].clearance_m + plateau_m;
    Floor floor{lowest, lowest, lowest};
    while (floor.first > 0 && points[floor.first - 1].clearance_m <= limit_m) --floor.first;
    while (floor.last + 1 < points.size() && points[floor.last + 1].clearance_m <= limit_m) {
      ++floor.last;
    }
    return floor;
  }

  /// True if walking from the floor in direction `step` the clearance rises to `rise_m` above that
  /// of the floor, at a point farther than the threshold of 5.4, before it comes down to the floor
  /// again.
  [[nodiscard]] bool rises(std::span<const BranchPoint> points, std::ptrdiff_t step, double rise_m,
                           double confirm_m) const {
    const std::size_t from = step > 0 ? last : first;
    const double low_m = points[lowest].clearance_m;
    auto i = static_cast<std::ptrdiff_t>(from) + step;
    for (; i >= 0 && i < static_cast<std::ptrdiff_t>(points.size()); i += step) {
      const BranchPoint& point = points[static_cast<std::size_t>(i)];
      if (point.clearance_m < low_m) return false;
      if (point.clearance_m >= low_m + rise_m &&
          (point.position_m - points[lowest].position_m).norm() > confirm_m) {
        return true;
      }
    }
    return false;
  }
};

void BranchStateFinder::measure_arc_lengths(std::span<const BranchPoint> points) {
  arc_m_.assign(points.size(), 0.0);
  for (std::size_t i = 1; i < points.size(); ++i) {
    arc_m_[i] = arc_m_[i - 1] + (points[i].position_m - points[i - 1].position_m).norm();
  }
}

/// Minima between which the clearance rises by at least state_rise_m and falls again (5.1 with the
/// confirmation of 5.3). The first and last can lie at the ends of the branch.
void BranchStateFinder::find_minima(std::span<const BranchPoint> points, double rise_m) {
  minima_.clear();
  std::size_t low = 0;
  std::size_t high = 0;
  bool falling = true;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const double clearance_m = points[i].clearance_m;
    if (falling) {
      if (clearance_m < points[low].clearance_m) low = i;
      if (clearance_m > points[low].clearance_m + rise_m) {
        minima_.push_back(low);
        falling = false;
        high = i;
      }
    } else {
      if (clearance_m > points[high].clearance_m) high = i;
      if (clearance_m < points[high].clearance_m - rise_m) {
        falling = true;
        low = i;
      }
    }
  }
  if (falling) minima_.push_back(low);
}

namespace {

/// Clearances this close are taken as equal, metres.
constexpr double kLevelM = 0.02;

}  // namespace

/// Point in the middle of the lowest part of a floor: readings make the very minimum jump along a
/// door frame of some depth.
std::size_t BranchStateFinder::middle_of(std::span<const BranchPoint> points,
                                         std::size_t lowest) const {
  const Floor level = Floor::around(points, lowest, kLevelM);
  const double middle_m = 0.5 * (arc_m_[level.first] + arc_m_[level.last]);
  std::size_t middle = level.first;
  while (middle < level.last && arc_m_[middle] < middle_m) ++middle;
  return middle;
}

/// Mouth of a corridor: the last point of its floor in direction `step` that is still on the level
/// of the floor. The clearance rises slowly at first behind the mouth, so the end of the floor is
/// late.
std::size_t BranchStateFinder::mouth_of(std::span<const BranchPoint> points, const Floor& floor,
                                        std::ptrdiff_t step) {
  clearances_m_.clear();
  for (std::size_t i = floor.first; i <= floor.last; ++i) {
    clearances_m_.push_back(points[i].clearance_m);
  }
  const auto middle = clearances_m_.begin() + static_cast<std::ptrdiff_t>(clearances_m_.size() / 2);
  std::nth_element(clearances_m_.begin(), middle, clearances_m_.end());
  std::size_t mouth = step > 0 ? floor.last : floor.first;
  while (points[mouth].clearance_m > *middle + kLevelM) mouth = step > 0 ? mouth - 1 : mouth + 1;
  return mouth;
}

std::span<const BranchState> BranchStateFinder::find(std::span<const BranchPoint> points,
                                                     const LocalMapConfig& config) {
  states_.clear();
  if (points.size() < 3) return states_;
  measure_arc_lengths(points);
  find_minima(points, config.state_rise_m);
  for (const std::size_t lowest : minima_) {
    const Floor floor = Floor::around(points, lowest, config.plateau_m);
    const auto rises = [&](std::ptrdiff_t step, double rise_m) {
      return floor.rises(points, step, rise_m, config.state_confirm_m);
    };
    if (arc_m_[floor.last] - arc_m_[floor.first] >= config.corridor_length_m) {
      for (const std::ptrdiff_t step : {-1, 1}) {
        if (rises(step, config.hall_rise_m)) {
          states_.push_back({mouth_of(points, floor, step), NodeKind::kHallCorridor});
        }
      }
    } else if (rises(-1, config.state_rise_m) && rises(1, config.state_rise_m)) {
      const bool door = points[lowest].clearance_m <= config.door_half_width_m;
      states_.push_back({middle_of(points, lowest), door ? NodeKind::kDoor : NodeKind::kNarrowing});
    }
  }
  std::erase_if(states_, [&](const BranchState& state) {
    return state.point == 0 || state.point + 1 >= points.size();
  });
  std::sort(states_.begin(), states_.end(),
            [](const BranchState& a, const BranchState& b) { return a.point < b.point; });
  const auto same = [](const BranchState& a, const BranchState& b) { return a.point == b.point; };
  states_.erase(std::unique(states_.begin(), states_.end(), same), states_.end());
  return states_;
}

}  // namespace topogeo::topomap
