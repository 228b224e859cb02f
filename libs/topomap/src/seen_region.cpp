#include "seen_region.hpp"

#include <algorithm>
#include <numbers>

#include "topogeo/geometry/portable_math.hpp"

namespace topogeo::topomap {
namespace {

constexpr std::size_t kGroup = 8;
/// Tolerance of squared lengths: rounding in the distance to a box must not exclude it.
constexpr double kRounding = 1.0 + 1e-9;

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

}  // namespace

SeenRegion::SeenRegion(const LocalMap& map, double gap_m)
    : origin_m_(map.T_robot_laser.position_m()) {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  double angle = 0.0;
  for (const ScanPoint& p : map.points) {
    const Eigen::Vector2d point(p.x_m, p.y_m);
    const Eigen::Vector2d ray = point - origin_m_;
    const double direct = geometry::atan2(ray.y(), ray.x());
    // Unwrapped, so that a field of view across the back of the robot stays ascending.
    if (points_m_.empty()) {
      angle = direct;
    } else {
      angle += std::max(0.0, geometry::wrap_angle(direct - angle));
    }
    points_m_.push_back(point);
    angles_rad_.push_back(angle);
  }
  if (points_m_.size() < 2) return;
  const double span = angles_rad_.back() - angles_rad_.front();
  if (span > 0.95 * kTurn && span < kTurn) {
    points_m_.push_back(points_m_.front());
    angles_rad_.push_back(angles_rad_.front() + kTurn);
  } else {
    add_opening(origin_m_, points_m_.front());
    add_opening(origin_m_, points_m_.back());
  }
  for (std::size_t i = 1; i < points_m_.size(); ++i) {
    if ((points_m_[i] - points_m_[i - 1]).squaredNorm() > gap_m * gap_m) {
      add_opening(points_m_[i - 1], points_m_[i]);
    }
  }
  group_openings();
}

void SeenRegion::add_opening(const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m) {
  const Eigen::Vector2d along = to_m - from_m;
  openings_.push_back({from_m, along, std::max(along.squaredNorm(), 1e-12)});
}

void SeenRegion::group_openings() {
  for (std::size_t begin = 0; begin < openings_.size(); begin += kGroup) {
    Openings& group = groups_.emplace_back();
    group.begin = begin;
    group.end = std::min(begin + kGroup, openings_.size());
    for (std::size_t i = begin; i < group.end; ++i) {
      group.box_m.extend(openings_[i].from_m);
      group.box_m.extend(openings_[i].from_m + openings_[i].along_m);
    }
  }
}

bool SeenRegion::seen(const Eigen::Vector2d& point_m) const {
  if (points_m_.size() < 2) return false;
  const Eigen::Vector2d ray = point_m - origin_m_;
  double angle = geometry::atan2(ray.y(), ray.x());
  while (angle < angles_rad_.front()) angle += 2.0 * std::numbers::pi;
  const auto above = std::upper_bound(angles_rad_.begin(), angles_rad_.end(), angle);
  if (above == angles_rad_.end() || above == angles_rad_.begin()) return false;
  const auto i = static_cast<std::size_t>(above - angles_rad_.begin());
  return cross(points_m_[i] - points_m_[i - 1], point_m - points_m_[i - 1]) > 0.0;
}

bool SeenRegion::certain(const Eigen::Vector2d& point_m, double radius_m) const {
  const double radius2 = radius_m * radius_m;
  for (const Openings& group : groups_) {
    if (group.box_m.squaredExteriorDistance(point_m) > radius2 * kRounding) continue;
    for (std::size_t i = group.begin; i < group.end; ++i) {
      const Segment& s = openings_[i];
      const Eigen::Vector2d offset = point_m - s.from_m;
      const double t = std::clamp(offset.dot(s.along_m) / s.length2_m2, 0.0, 1.0);
      if ((offset - t * s.along_m).squaredNorm() < radius2) return false;
    }
  }
  return seen(point_m);
}

}  // namespace topogeo::topomap
