#include "recent_scans.hpp"

#include <cmath>
#include <cstdint>
#include <unordered_set>
#include <utility>

#include "topogeo/geometry/portable_math.hpp"

namespace topogeo::localization {

using geometry::Pose2;

namespace {

/// Squares of 10 cm that hold a point: the side of a cell in which the reference looks up.
class FilledCells {
 public:
  /// Whether the cell of the point was empty.
  bool fill(const Eigen::Vector2d& point_m) {
    constexpr double kCellsPer_m = 10.0;
    const auto column = static_cast<std::int32_t>(std::floor(kCellsPer_m * point_m.x()));
    const auto row = static_cast<std::int32_t>(std::floor(kCellsPer_m * point_m.y()));
    const auto key = (std::uint64_t{static_cast<std::uint32_t>(column)} << 32U) |
                     std::uint64_t{static_cast<std::uint32_t>(row)};
    return cells_.insert(key).second;
  }

 private:
  std::unordered_set<std::uint64_t> cells_;
};

}  // namespace

void RecentScans::add(std::shared_ptr<const MatchFeatures> features, const Pose2& T_track_robot) {
  keys_.push_back({std::move(features), T_track_robot});
  if (keys_.size() > kKept) keys_.pop_front();
  MatchFeatures all = *keys_.back().features;
  FilledCells filled;
  for (const SurfacePoint& point : all.surface) filled.fill(point.position_m);
  for (std::size_t back = 2; back <= keys_.size(); ++back) {
    const Key& key = keys_[keys_.size() - back];
    const Pose2 T_newest_key = geometry::between(T_track_robot, key.T_track_robot);
    const geometry::SinCos heading = geometry::sincos(T_newest_key.theta_rad);
    for (const SurfacePoint& point : key.features->surface) {
      const SurfacePoint here = moved(point, T_newest_key, heading);
      if (filled.fill(here.position_m)) all.surface.push_back(here);
    }
  }
  remake_reference(std::make_shared<const MatchFeatures>(std::move(all)), reference_);
  coarse_.reset();
}

std::vector<Pose2> RecentScans::search(const MatchFeatures& features, const CoarseWindow& window) {
  constexpr double kLeast = 0.3;  // less is no match by far
  constexpr std::size_t kPlaces = 12;
  constexpr std::size_t kPoints = 100;
  const auto positions = [](const std::vector<SurfacePoint>& points, std::size_t step) {
    std::vector<Eigen::Vector2d> out;
    out.reserve(points.size() / step + 1);
    for (std::size_t i = 0; i < points.size(); i += step) out.push_back(points[i].position_m);
    return out;
  };
  if (!coarse_) coarse_.emplace(positions(reference_.features->surface, 1));
  const std::size_t step = features.coarse.size() / kPoints + 1;
  std::vector<Pose2> places;
  places.reserve(kPlaces);
  for (const CoarseMatch& match :
       search_coarsely(*coarse_, positions(features.coarse, step), window, kLeast, kPlaces)) {
    places.push_back(match.T_map_points);
  }
  return places;
}

}  // namespace topogeo::localization
