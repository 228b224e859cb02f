#include "blockade.hpp"

#include <algorithm>

#include "scan_occupancy.hpp"

namespace topogeo::navigation {
namespace {

constexpr int kSeenFree = 5;        // successive scans: one may see past an edge
constexpr std::size_t kMost = 500;  // cells in a message

}  // namespace

bool Blockade::add(std::span<const Eigen::Vector2d> points_m, const planning::GridFrame& frame,
                   std::int64_t now_ns) {
  bool any = false;
  for (const Eigen::Vector2d& point_m : points_m) {
    const auto cell = frame.cell_of(point_m);
    if (!cell) continue;
    const Eigen::Vector2d middle_m = frame.center_m(*cell);
    const auto known = std::find_if(cells_.begin(), cells_.end(), [&](const Filled& filled) {
      return (filled.point_m - middle_m).norm() < 0.5 * frame.resolution_m;
    });
    if (known != cells_.end()) {
      *known = {middle_m, now_ns};
    } else if (cells_.size() < kMost) {
      cells_.push_back({middle_m, now_ns});
      any = true;
    }
  }
  if (any) publish();
  return any;
}

void Blockade::see(const ScanPoints& scan, const geometry::Pose2& T_map_robot) {
  if (cells_.empty()) return;
  constexpr double kHalf_m = 0.05;     // of a cell
  constexpr double kFarthest_m = 5.0;  // beyond it beams are further apart than a cell is wide
  const ScanOccupancy occupancy(scan);
  const geometry::Pose2 T_robot_map = inverse(T_map_robot);
  for (Filled& filled : cells_) {
    const Eigen::Vector2d seen_m = T_robot_map * filled.point_m;
    if (seen_m.norm() > kFarthest_m) continue;
    switch (occupancy.at(seen_m, kHalf_m)) {
      case Occupancy::kFree:
        ++filled.free;
        break;
      case Occupancy::kOccupied:
        filled.free = 0;
        filled.last_ns = scan.stamp_ns;
        break;
      case Occupancy::kUnseen:
        break;
    }
  }
}

void Blockade::expire(std::int64_t now_ns) {
  const auto over = [&](const Filled& filled) {
    return filled.free >= kSeenFree || now_ns - filled.last_ns > kept_ns_;
  };
  if (std::erase_if(cells_, over) > 0) publish();
}

void Blockade::clear() {
  if (cells_.empty()) return;
  cells_.clear();
  publish();
}

void Blockade::publish() {
  ++report_.version;
  report_.points_m.clear();
  for (const Filled& filled : cells_) report_.points_m.push_back(filled.point_m);
}

}  // namespace topogeo::navigation
