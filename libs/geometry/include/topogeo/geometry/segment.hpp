// The place on a line segment that is nearest to a point.
#pragma once

#include <algorithm>

#include <Eigen/Core>

namespace topogeo::geometry {

struct SegmentPlace {
  Eigen::Vector2d point_m;
  double share = 0.0;  ///< of the way from the first to the second end, in [0, 1]
};

/// Place on the segment from `a_m` to `b_m` that is nearest to `point_m`, all in one frame, metres;
/// `a_m` for a segment without length.
inline SegmentPlace nearest_on_segment(const Eigen::Vector2d& a_m, const Eigen::Vector2d& b_m,
                                       const Eigen::Vector2d& point_m) {
  const Eigen::Vector2d along_m = b_m - a_m;
  const double length2 = along_m.squaredNorm();
  const double share =
      length2 > 0.0 ? std::clamp((point_m - a_m).dot(along_m) / length2, 0.0, 1.0) : 0.0;
  return {a_m + share * along_m, share};
}

}  // namespace topogeo::geometry
