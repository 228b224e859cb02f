#include "topogeo/pipeline/path_disagreement.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <numbers>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/topomap/odometry_contradiction.hpp"

namespace topogeo::pipeline {
namespace {

using geometry::Pose2;
using Disagreement = PathDisagreement::Kind;

constexpr double kPart_m = 3.0;
constexpr double kLargestLengthRatio = 1.22;
constexpr double kLargestTurn_rad = 50.0 * std::numbers::pi / 180.0;
constexpr double kLargestJump_m = 0.6;

double length_m(const Pose2& T) {
  return std::sqrt(T.position_m().squaredNorm());
}

bool comparable(const topomap::LocalMap& before, const topomap::LocalMap& after) {
  return before.stop.session == after.stop.session && topomap::has_odometry_between(before, after);
}

/// A part of the path of at least kPart_m by odometry.
struct Part {
  std::uint32_t first = 0;
  std::uint32_t last = 0;
  double odometry_m = 0.0;  // from stop to stop
  double corrected_m = 0.0;
  double turn_rad = 0.0;
  double apart_m = 0.0;  // between both ends, seen from the common start

  [[nodiscard]] double ratio() const { return corrected_m / odometry_m; }
};

class Path {
 public:
  explicit Path(const storage::MapDocument& document)
      : maps_(document.local_maps), stops_(document.trajectory.stops) {}

  [[nodiscard]] std::size_t size() const { return std::min(maps_.size(), stops_.size()); }
  [[nodiscard]] bool step_to(std::size_t stop) const {
    return stops_[stop - 1].located && stops_[stop].located &&
           comparable(maps_[stop - 1], maps_[stop]);
  }
  [[nodiscard]] Pose2 by_odometry(std::size_t from, std::size_t to) const {
    return geometry::between(maps_[from].T_odom_robot, maps_[to].T_odom_robot);
  }
  [[nodiscard]] Pose2 corrected(std::size_t from, std::size_t to) const {
    return geometry::between(stops_[from].T_map_robot, stops_[to].T_map_robot);
  }

  /// The shortest part from a stop; none if the drive ends before.
  [[nodiscard]] std::optional<Part> part_from(std::uint32_t first) const {
    Part part;
    part.first = first;
    std::uint32_t last = first;
    while (part.odometry_m < kPart_m) {
      if (++last >= size() || !step_to(last)) return std::nullopt;
      part.odometry_m += length_m(by_odometry(last - 1, last));
      part.corrected_m += length_m(corrected(last - 1, last));
    }
    part.last = last;
    const Eigen::Vector3d difference =
        geometry::difference(corrected(first, last), by_odometry(first, last));
    part.apart_m = difference.head<2>().norm();
    part.turn_rad = difference.z();
    return part;
  }

  [[nodiscard]] const topomap::LocalMap& map(std::size_t stop) const { return maps_[stop]; }

 private:
  std::span<const topomap::LocalMap> maps_;
  std::span<const topomap::StopPose> stops_;
};

double excess(Disagreement kind, const PathDisagreement& part) {
  if (kind == Disagreement::kTurn) return std::abs(part.turn_rad);
  return std::abs(std::log(part.corrected_m / part.odometry_m));
}

/// Joins parts that overlap; the worst one gives the numbers.
void add(std::vector<PathDisagreement>& found, Disagreement kind, const Part& part) {
  const PathDisagreement next{
      kind, part.first, part.last, part.odometry_m, part.corrected_m, part.turn_rad};
  const auto last = std::ranges::find(found.rbegin(), found.rend(), kind, &PathDisagreement::kind);
  if (last == found.rend() || last->last_id < part.first) {
    found.push_back(next);
    return;
  }
  const std::uint32_t first_id = last->first_id;
  if (excess(kind, next) > excess(kind, *last)) *last = next;
  last->first_id = first_id;
  last->last_id = part.last;
}

/// The steps between stops whose scans contradict the odometry; successive steps are joined.
std::vector<PathDisagreement> contradicted_steps(std::span<const topomap::LocalMap> maps) {
  std::vector<PathDisagreement> found;
  for (std::uint32_t stop = 1; stop < maps.size(); ++stop) {
    const topomap::LocalMap& before = maps[stop - 1];
    const topomap::LocalMap& map = maps[stop];
    if (map.starts_drive || before.stop.session != map.stop.session ||
        before.odometry_epoch != map.odometry_epoch) {
      continue;
    }
    const auto step = topomap::odometry_contradiction(before.T_odom_robot, map);
    if (!step) continue;
    if (found.empty() || found.back().last_id + 1 != stop) {
      found.push_back({Disagreement::kWheels, stop - 1, stop - 1, 0.0, 0.0, 0.0});
    }
    PathDisagreement& part = found.back();
    part.last_id = stop;
    part.odometry_m += step->odometry_m;
    part.corrected_m += step->scans_m;
    part.turn_rad = geometry::wrap_angle(part.turn_rad + step->turn_rad);
  }
  return found;
}

/// The stops after which a robot continues in another place although its odometry has hardly moved.
std::vector<PathDisagreement> carried_stops(std::span<const topomap::LocalMap> maps) {
  constexpr double kHardly_m = 2.0;
  std::vector<PathDisagreement> found;
  for (std::uint32_t stop = 1; stop < maps.size(); ++stop) {
    const topomap::LocalMap& before = maps[stop - 1];
    const topomap::LocalMap& map = maps[stop];
    if (!map.starts_drive || map.stop.number != 0 || before.robot_id != map.robot_id ||
        before.odometry_epoch != map.odometry_epoch || map.odometry_epoch == 0) {
      continue;
    }
    const double odometry_m = length_m(geometry::between(before.T_odom_robot, map.T_odom_robot));
    if (odometry_m > kHardly_m) continue;
    found.push_back({Disagreement::kCarried, stop - 1, stop, odometry_m, 0.0, 0.0});
  }
  return found;
}

/// The scans before a stop, as the trajectory places them: moved with the previous stop.
std::optional<PathDisagreement> jump_before(const Path& path, std::uint32_t stop) {
  const topomap::LocalMap& map = path.map(stop);
  Pose2 T_stop_robot;
  Pose2 T_odom_robot = path.map(stop - 1).T_odom_robot;
  std::optional<PathDisagreement> worst;
  double largest_m = kLargestJump_m;
  const auto compare = [&](const Pose2& T_stop_next, const Pose2& T_odom_next) {
    const Pose2 corrected = geometry::between(T_stop_robot, T_stop_next);
    const Pose2 odometry = geometry::between(T_odom_robot, T_odom_next);
    const double more_m = length_m(corrected) - length_m(odometry);
    if (more_m > largest_m) {
      largest_m = more_m;
      worst = PathDisagreement{Disagreement::kJump, stop - 1, stop, length_m(odometry),
                               length_m(corrected), 0.0};
    }
    T_stop_robot = T_stop_next;
    T_odom_robot = T_odom_next;
  };
  for (const topomap::TrackedScan& scan : map.track) compare(scan.T_stop_robot, scan.T_odom_robot);
  compare(path.corrected(stop - 1, stop), map.T_odom_robot);
  return worst;
}

double median_of(std::vector<double> values) {
  const auto middle = std::next(values.begin(), static_cast<std::ptrdiff_t>(values.size() / 2));
  std::ranges::nth_element(values, middle);
  return *middle;
}

/// The scale that parts with these ratios have in common; 1 if they have none.
double common_scale(const std::vector<double>& ratios) {
  constexpr double kMost = 0.9;
  const double scale = median_of(ratios);
  const double least = 0.5 * std::log(scale);
  const auto alike = std::ranges::count_if(ratios, [&](double ratio) {
    return least > 0.0 ? std::log(ratio) > least : std::log(ratio) < least;
  });
  return static_cast<double>(alike) >= kMost * static_cast<double>(ratios.size()) ? scale : 1.0;
}

}  // namespace

PathComparison compare_with_odometry(const storage::MapDocument& document) {
  const Path path(document);
  PathComparison comparison;
  std::vector<PathDisagreement>& found = comparison.disagreements;
  std::vector<double> shares;
  std::vector<double> ratios;
  for (std::uint32_t first = 0; first < path.size(); ++first) {
    const std::optional<Part> part = path.part_from(first);
    if (!part) continue;
    shares.push_back(part->apart_m / part->odometry_m);
    const double ratio = part->ratio();
    ratios.push_back(ratio);
    if (ratio > kLargestLengthRatio || ratio < 1.0 / kLargestLengthRatio) {
      add(found, Disagreement::kLength, *part);
    }
    if (std::abs(part->turn_rad) > kLargestTurn_rad) add(found, Disagreement::kTurn, *part);
  }
  for (std::uint32_t stop = 1; stop < path.size(); ++stop) {
    if (!path.step_to(stop)) continue;
    if (const auto jump = jump_before(path, stop)) found.push_back(*jump);
  }
  for (const auto& part : contradicted_steps(document.local_maps)) found.push_back(part);
  for (const auto& part : carried_stops(document.local_maps)) found.push_back(part);
  std::ranges::stable_sort(found, {}, &PathDisagreement::kind);
  if (!shares.empty()) {
    comparison.typical_share = median_of(std::move(shares));
    comparison.scale = common_scale(ratios);
  }
  return comparison;
}

}  // namespace topogeo::pipeline
