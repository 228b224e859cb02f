#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include <Eigen/Core>

#include "topogeo/geometry/portable_math.hpp"
#include "topogeo/matching/match_features.hpp"

namespace topogeo::localization {
namespace {

using topomap::BranchPoint;
using topomap::ScanPoint;

// Fixed: matches depend on them, and tasks do not carry them.
constexpr double kSlopeReach_m = 0.20;  // to each side; a step of clearance is 1 to 2 cm
constexpr double kSteepest = 0.97;      // the circles nearly touch at one place ahead
constexpr double kInside_m = 0.04;      // depth in a free circle that is noise

struct Touch {
  Eigen::Vector2d position_m;
  double bearing_rad;  // from the laser
};

// Along a branch the distance to the nearest object changes by the cosine of the angle between the
// branch and the direction away from that object. Both objects lie at that angle, one on each side.
void add_touches(const std::vector<BranchPoint>& points, const geometry::Pose2& T_laser_robot,
                 std::vector<Touch>& out) {
  const auto apart_m = [&](std::size_t a, std::size_t b) {
    return std::sqrt((points[a].position_m - points[b].position_m).squaredNorm());
  };
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::size_t before = i;
    std::size_t after = i;
    while (before > 0 && apart_m(before, i) < kSlopeReach_m) --before;
    while (after + 1 < points.size() && apart_m(after, i) < kSlopeReach_m) ++after;
    const double length_m = apart_m(before, after);
    if (length_m < kSlopeReach_m) continue;
    const Eigen::Vector2d along = (points[after].position_m - points[before].position_m) / length_m;
    const double slope = (points[after].clearance_m - points[before].clearance_m) / length_m;
    if (std::fabs(slope) > kSteepest) continue;
    const double across = std::sqrt(1.0 - slope * slope);
    for (const double side : {across, -across}) {
      const Eigen::Vector2d to_wall(-slope * along.x() - side * along.y(),
                                    -slope * along.y() + side * along.x());
      const Eigen::Vector2d wall = points[i].position_m + points[i].clearance_m * to_wall;
      const Eigen::Vector2d seen = T_laser_robot * wall;
      out.push_back({wall, geometry::atan2(seen.y(), seen.x())});
    }
  }
}

// Whether a touch lies in the free space of another circle: if the clearance is uneven, its change
// does not show the direction.
bool inside_a_circle(const Touch& touch, const std::vector<BranchPoint>& circles) {
  return std::any_of(circles.begin(), circles.end(), [&](const BranchPoint& circle) {
    const double free_m = circle.clearance_m - kInside_m;
    return free_m > 0.0 && (circle.position_m - touch.position_m).squaredNorm() < free_m * free_m;
  });
}

}  // namespace

BranchWalls walls_of_branches(const topomap::LocalMap& map) {
  std::vector<Touch> touches;
  std::vector<BranchPoint> circles;
  const geometry::Pose2 T_laser_robot = geometry::inverse(map.T_robot_laser);
  for (const topomap::LocalBranch& branch : map.branches) {
    if (branch.is_virtual) continue;
    add_touches(branch.points, T_laser_robot, touches);
    circles.insert(circles.end(), branch.points.begin(), branch.points.end());
  }
  std::erase_if(touches, [&](const Touch& touch) { return inside_a_circle(touch, circles); });
  std::stable_sort(touches.begin(), touches.end(),
                   [](const Touch& a, const Touch& b) { return a.bearing_rad < b.bearing_rad; });
  BranchWalls walls{{}, map.T_robot_laser};
  walls.points.reserve(touches.size());
  for (const Touch& touch : touches) {
    walls.points.push_back(
        {static_cast<float>(touch.position_m.x()), static_cast<float>(touch.position_m.y())});
  }
  return walls;
}

MatchFeatures with_walls(const MatchFeatures& features, const BranchWalls& walls) {
  MatchFeatures changed = extract_scan_features(walls.points, walls.T_robot_laser);
  changed.edges.clear();  // small steps are lost in the noise of these points
  changed.nodes = features.nodes;
  changed.branches = features.branches;
  changed.curves = features.curves;
  return changed;
}

std::vector<ScanPoint> points_for(const topomap::LocalMap& map, MatchEvidence evidence) {
  return evidence == MatchEvidence::kScan ? map.points : walls_of_branches(map).points;
}

}  // namespace topogeo::localization
