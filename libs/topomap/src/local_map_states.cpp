#include "local_map_states.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "topogeo/topomap/arc_length.hpp"

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

  /// True if, walking from the floor in direction `step`, the clearance rises to `rise_m` above
  /// that of the floor, at a point farther than the threshold of 5.4, before it returns to the
  /// floor. Unless `confirmed` is empty, the rise ends where that is 0.
  [[nodiscard]] bool rises(std::span<const BranchPoint> points, std::span<const char> confirmed,
                           std::ptrdiff_t step, double rise_m, double confirm_m) const {
    const std::size_t from = step > 0 ? last : first;
    const double low_m = points[lowest].clearance_m;
    auto i = static_cast<std::ptrdiff_t>(from) + step;
    for (; i >= 0 && i < static_cast<std::ptrdiff_t>(points.size()); i += step) {
      const BranchPoint& point = points[static_cast<std::size_t>(i)];
      if (point.clearance_m < low_m) return false;
      if (!confirmed.empty() && confirmed[static_cast<std::size_t>(i)] == 0) return false;
      if (point.clearance_m >= low_m + rise_m &&
          (point.position_m - points[lowest].position_m).norm() > confirm_m) {
        return true;
      }
    }
    return false;
  }
};

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

// Both are fixed: they follow from the geometry of corners.
/// Clearances this close count as equal, metres.
constexpr double kLevelM = 0.02;
/// Beyond the corner of one wall, the clearance of a corridor 2 m wide is 2 cm above its level
/// after 0.28 m; that of a wider one later.
constexpr double kLargestDelayM = 0.4;

}  // namespace

/// The place on a branch at an arc length between its first and last point.
BranchState BranchStateFinder::state_at(std::span<const BranchPoint> points, double arc_m,
                                        NodeKind kind) const {
  const auto found = std::upper_bound(arc_m_.begin() + 1, arc_m_.end() - 1, arc_m);
  const auto after = static_cast<std::size_t>(found - arc_m_.begin());
  const BranchPoint& a = points[after - 1];
  const BranchPoint& b = points[after];
  const double t = (arc_m - arc_m_[after - 1]) / (arc_m_[after] - arc_m_[after - 1]);
  return {t < 0.5 ? after - 1 : after,
          kind,
          {a.position_m + t * (b.position_m - a.position_m),
           a.clearance_m + t * (b.clearance_m - a.clearance_m)}};
}

/// The minimum of the parabola through the squared clearances around a lowest point, by least
/// squares: beside a door post the squared clearance is a parabola, and noise makes the lowest
/// point itself jump along a deep frame. Falls back to the lowest point with too few points or
/// without a minimum within reach.
BranchState BranchStateFinder::minimum(std::span<const BranchPoint> points, std::size_t lowest,
                                       double reach_m) const {
  std::size_t first = lowest;
  std::size_t last = lowest;
  while (first > 0 && arc_m_[lowest] - arc_m_[first - 1] <= reach_m) --first;
  while (last + 1 < points.size() && arc_m_[last + 1] - arc_m_[lowest] <= reach_m) ++last;
  BranchState state{lowest, NodeKind::kDoor, points[lowest]};
  if (last - first < 4 || first == lowest || last == lowest) return state;
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (std::size_t i = first; i <= last; ++i) {
    const double s = arc_m_[i] - arc_m_[lowest];
    const Eigen::Vector3d row{1.0, s, s * s};
    normal += row * row.transpose();
    right += row * points[i].clearance_m * points[i].clearance_m;
  }
  const Eigen::Vector3d parabola = normal.ldlt().solve(right);
  if (!(parabola.z() > 0.0)) return state;
  const double at_m = arc_m_[lowest] - 0.5 * parabola.y() / parabola.z();
  if (!(at_m > arc_m_[first] && at_m < arc_m_[last])) return state;
  return state_at(points, at_m, NodeKind::kDoor);
}

/// The clearance in a corridor: the median of its floor.
double BranchStateFinder::level_of(std::span<const BranchPoint> points, const Floor& floor) {
  clearances_m_.clear();
  for (std::size_t i = floor.first; i <= floor.last; ++i) {
    clearances_m_.push_back(points[i].clearance_m);
  }
  const auto middle = clearances_m_.begin() + static_cast<std::ptrdiff_t>(clearances_m_.size() / 2);
  std::nth_element(clearances_m_.begin(), middle, clearances_m_.end());
  return *middle;
}

/// Mouth of a corridor: where the clearance starts to rise from its level. Beyond the corners of a
/// mouth the squared clearance grows with the square of the distance from it, fully if both walls
/// end there and half as much if one does. So the root of its growth is a line over the distance:
/// fitted by least squares up to a rise of `rise_m` and extrapolated back to zero. With too few
/// points for a line, the last point on the level, up to 0.3 m beyond the mouth.
BranchState BranchStateFinder::mouth_of(std::span<const BranchPoint> points, const Floor& floor,
                                        std::ptrdiff_t step, double rise_m) {
  const double level_m = level_of(points, floor);
  std::size_t last = step > 0 ? floor.last : floor.first;
  while (points[last].clearance_m > level_m + kLevelM) last = step > 0 ? last - 1 : last + 1;

  // distance = a + b * root, both from the last point on the level outward.
  double count = 0.0, roots = 0.0, distances = 0.0, roots_sq = 0.0, products = 0.0;
  const auto end = step > 0 ? static_cast<std::ptrdiff_t>(points.size()) : -1;
  for (auto i = static_cast<std::ptrdiff_t>(last) + step; i != end; i += step) {
    const double clearance_m = points[static_cast<std::size_t>(i)].clearance_m;
    if (clearance_m > level_m + rise_m) break;
    if (clearance_m <= level_m) continue;
    const double distance = std::abs(arc_m_[static_cast<std::size_t>(i)] - arc_m_[last]);
    const double root = std::sqrt(clearance_m * clearance_m - level_m * level_m);
    count += 1.0;
    roots += root;
    distances += distance;
    roots_sq += root * root;
    products += root * distance;
  }
  BranchState state{last, NodeKind::kHallCorridor, points[last]};
  const double spread = count * roots_sq - roots * roots;
  if (count < 4.0 || !(spread > 0.0)) return state;
  const double distance_m = (distances * roots_sq - roots * products) / spread;
  // If it lay beyond the last level point, or far back, the walls would not end at a corner.
  const double back_m = std::clamp(-distance_m, 0.0, kLargestDelayM);
  const double inner_m = arc_m_[last] - static_cast<double>(step) * back_m;
  return state_at(points, std::clamp(inner_m, arc_m_[floor.first], arc_m_[floor.last]),
                  NodeKind::kHallCorridor);
}

std::span<const BranchState> BranchStateFinder::find_slope_changes(
    std::span<const BranchPoint> points, std::span<const char> confirmed,
    const LocalMapConfig& config) {
  states_.clear();
  const auto slope = [&](std::size_t from, std::size_t to) {
    const double rise_m = points[to].clearance_m - points[from].clearance_m;
    return rise_m > 0.0 ? 1 : (rise_m < 0.0 ? -1 : 0);
  };
  for (std::size_t j = 2; j + 1 < points.size(); ++j) {
    const int before = slope(j - 2, j - 1);
    const int now = slope(j - 1, j);
    if (now == before || confirmed[j] == 0) continue;  // 5.1
    bool goes_on = true;
    bool far_enough = false;
    for (std::size_t k = j + 1; k < points.size() && goes_on && !far_enough; ++k) {
      goes_on = slope(j - 1, k) == now;  // 5.3
      far_enough =
          (points[k].position_m - points[j].position_m).norm() > config.state_confirm_m;  // 5.4
    }
    if (!goes_on || !far_enough) continue;
    const double clearance_m = points[j].clearance_m;
    NodeKind kind = NodeKind::kHallCorridor;
    if (before < 0 && now > 0) {
      const bool door =
          clearance_m <= config.door_half_width_m && clearance_m >= config.door_min_half_width_m;
      kind = door ? NodeKind::kDoor : NodeKind::kNarrowing;
    }
    states_.push_back({j, kind, points[j]});  // 5.2
  }
  return states_;
}

std::span<const BranchState> BranchStateFinder::find(std::span<const BranchPoint> points,
                                                     std::span<const char> confirmed,
                                                     const LocalMapConfig& config) {
  states_.clear();
  if (points.size() < 3) return states_;
  arc_lengths_m(points, arc_m_);
  find_minima(points, config.state_rise_m);
  for (const std::size_t lowest : minima_) {
    const Floor floor = Floor::around(points, lowest, config.plateau_m);
    if (arc_m_[floor.last] - arc_m_[floor.first] >= config.corridor_length_m) {
      for (const std::ptrdiff_t step : {-1, 1}) {
        if (floor.rises(points, confirmed, step, config.hall_rise_m, config.state_confirm_m)) {
          states_.push_back(mouth_of(points, floor, step, config.hall_rise_m));
        }
      }
    } else if (floor.rises(points, {}, -1, config.state_rise_m, config.state_confirm_m) &&
               floor.rises(points, {}, 1, config.state_rise_m, config.state_confirm_m)) {
      const bool door = points[lowest].clearance_m <= config.door_half_width_m &&
                        points[lowest].clearance_m >= config.door_min_half_width_m;
      states_.push_back(minimum(points, lowest, config.state_reach_m));
      states_.back().kind = door ? NodeKind::kDoor : NodeKind::kNarrowing;
    }
  }
  std::erase_if(states_, [&](const BranchState& state) {
    return state.point == 0 || state.point + 1 >= points.size() || confirmed[state.point] == 0;
  });
  std::sort(states_.begin(), states_.end(),
            [](const BranchState& a, const BranchState& b) { return a.point < b.point; });
  const auto same = [](const BranchState& a, const BranchState& b) { return a.point == b.point; };
  states_.erase(std::unique(states_.begin(), states_.end(), same), states_.end());
  return states_;
}

}  // namespace topogeo::topomap
