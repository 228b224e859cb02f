#include "topogeo/voronoi/generator_groups.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>

#include "topogeo/geometry/portable_math.hpp"
#include "topogeo/geometry/pose2.hpp"

namespace topogeo::voronoi {
namespace {

/// Finer than any laser; below it beam numbers would overflow.
constexpr double kLeastStep_rad = 1e-5;
/// For a full turn whose step was rounded in a log.
constexpr double kTurnTolerance_rad = 0.01;
constexpr double kFar = std::numeric_limits<double>::infinity();

struct Box {
  Eigen::Array2d low{kFar, kFar};
  Eigen::Array2d high{-kFar, -kFar};
};

Box box_of(const GeneratorGroups& groups, const PointRun& run) {
  Box box;
  for (std::uint32_t i = run.begin; i < run.end; ++i) {
    box.low = box.low.min(groups.points[i].position_m.array());
    box.high = box.high.max(groups.points[i].position_m.array());
  }
  return box;
}

/// Smallest distance between points of two groups (def. 4.2.6) if it is below `limit_m`, otherwise
/// infinity. Skips points farther than the limit from the other group's box, which leaves few
/// pairs.
double distance_below(const GeneratorGroups& groups, const PointRun& a, const PointRun& b,
                      double limit_m) {
  const Box box = box_of(groups, b);
  const double limit_sq = limit_m * limit_m;
  double best_sq = limit_sq;
  for (std::uint32_t i = a.begin; i < a.end; ++i) {
    const Eigen::Array2d p = groups.points[i].position_m.array();
    const Eigen::Array2d outside = (box.low - p).max(p - box.high).max(0.0);
    if (outside.square().sum() >= best_sq) continue;
    for (std::uint32_t j = b.begin; j < b.end; ++j) {
      const double sq = (groups.points[j].position_m.array() - p).square().sum();
      best_sq = std::min(best_sq, sq);
    }
  }
  return best_sq < limit_sq ? std::sqrt(best_sq) : kFar;
}

/// Joins group k with the next one (cyclic if k is the last).
void join_with_next(GeneratorGroups& groups, std::size_t k) {
  if (k + 1 < groups.groups.size()) {
    groups.groups[k].end = groups.groups[k + 1].end;
    groups.groups.erase(groups.groups.begin() + static_cast<std::ptrdiff_t>(k) + 1);
    return;
  }
  // The last group precedes the first: rotates the points until both are one run.
  const std::uint32_t moved = groups.groups.back().size();
  const auto middle = groups.points.end() - static_cast<std::ptrdiff_t>(moved);
  std::rotate(groups.points.begin(), middle, groups.points.end());
  groups.groups.pop_back();
  for (PointRun& run : groups.groups) {
    run.begin += moved;
    run.end += moved;
  }
  groups.groups.front().begin = 0;
}

void drop_group(GeneratorGroups& groups, std::size_t k) {
  const PointRun gone = groups.groups[k];
  groups.points.erase(groups.points.begin() + gone.begin, groups.points.begin() + gone.end);
  groups.groups.erase(groups.groups.begin() + static_cast<std::ptrdiff_t>(k));
  for (std::size_t i = k; i < groups.groups.size(); ++i) {
    groups.groups[i].begin -= gone.size();
    groups.groups[i].end -= gone.size();
  }
}

/// Tells which successive readings of a scan belong to one surface.
class Surfaces {
 public:
  Surfaces(const scan::Scan& scan, const BeamDirections& beams, const VoronoiConfig& config)
      : ranges_m_(scan.ranges_m), beams_(beams), config_(config) {}

  [[nodiscard]] bool is_reading(std::uint32_t beam) const {
    return within_limit(ranges_m_[beam], config_);
  }
  [[nodiscard]] Eigen::Vector2d position_m(std::uint32_t beam) const {
    return beams_.directions()[beam] * static_cast<double>(ranges_m_[beam]);
  }
  /// 4.7 for two successive beams; the second must have a reading.
  [[nodiscard]] bool continues(std::uint32_t before, std::uint32_t beam) const {
    if (!is_reading(before)) return false;
    const double jump_m =
        static_cast<double>(ranges_m_[beam]) - static_cast<double>(ranges_m_[before]);
    if (!config_.split_discontinuities || std::abs(jump_m) <= config_.discontinuity_m) return true;
    return config_.on_wall_m > 0.0 &&
           (on_line(next(before, -1), before, beam) || on_line(next(beam, 1), beam, before));
  }

 private:
  [[nodiscard]] std::optional<std::uint32_t> next(std::uint32_t beam, int step) const {
    const auto count = static_cast<std::uint32_t>(ranges_m_.size());
    const bool at_the_end = step > 0 ? beam + 1 == count : beam == 0;
    if (at_the_end && !beams_.closed()) return std::nullopt;
    return (beam + count + static_cast<std::uint32_t>(step)) % count;
  }
  /// True if reading `c` continues the line from reading `a` to `b`. Two readings define a line for
  /// not much more than their distance; along a wall the distances grow less than that.
  [[nodiscard]] bool on_line(std::optional<std::uint32_t> a, std::uint32_t b,
                             std::uint32_t c) const {
    if (!a || !is_reading(*a)) return false;
    constexpr double kLongest = 2.5;
    const Eigen::Vector2d base_m = position_m(b) - position_m(*a);
    const Eigen::Vector2d on_m = position_m(c) - position_m(b);
    const double sq = base_m.squaredNorm();
    const double along = base_m.dot(on_m);
    const double across = base_m.x() * on_m.y() - base_m.y() * on_m.x();
    return along > 0.0 && along <= kLongest * sq &&
           across * across <= config_.on_wall_m * config_.on_wall_m * sq;
  }

  const std::vector<float>& ranges_m_;
  const BeamDirections& beams_;
  const VoronoiConfig& config_;
};

/// True if group `between` is seen through the gap between its neighbours.
bool lies_behind(const GeneratorGroups& groups, std::size_t before, std::size_t between,
                 std::size_t after) {
  const auto& [points, runs, closed] = groups;
  return points[runs[between].begin].range_m > points[runs[before].end - 1].range_m &&
         points[runs[between].end - 1].range_m > points[runs[after].begin].range_m;
}

/// Number of borders between successive groups. Two groups of a closed scan have two.
std::size_t border_count(const GeneratorGroups& groups) {
  const std::size_t n = groups.groups.size();
  if (n < 2) return 0;
  return groups.closed ? n : n - 1;
}

/// Width of the gap between the groups `before` and `after`.
double gap_m(const GeneratorGroups& groups, std::size_t before, std::size_t after) {
  return (groups.points[groups.groups[before].end - 1].position_m -
          groups.points[groups.groups[after].begin].position_m)
      .norm();
}

}  // namespace

bool BeamDirections::update(const scan::Scan& scan) {
  if (!std::isfinite(scan.angle_min_rad) || std::abs(scan.angle_min_rad) > 100.0 ||
      !std::isfinite(scan.angle_step_rad) || scan.angle_step_rad < kLeastStep_rad) {
    throw std::invalid_argument("scan " + std::to_string(scan.sequence) + ": angle_min_rad " +
                                std::to_string(scan.angle_min_rad) + ", angle_step_rad " +
                                std::to_string(scan.angle_step_rad) +
                                ": must be finite, the step at least 1e-5");
  }
  const double turn =
      scan.angle_step_rad * static_cast<double>(std::max<std::size_t>(scan.ranges_m.size(), 1) - 1);
  if (turn > 2.0 * std::numbers::pi + kTurnTolerance_rad || scan.ranges_m.size() > 65000) {
    throw std::invalid_argument(
        "scan " + std::to_string(scan.sequence) + ": " + std::to_string(scan.ranges_m.size()) +
        " beams over " + std::to_string(turn) + " rad: must be at most 65000 and at most one turn");
  }
  if (scan.angle_min_rad == angle_min_rad_ && scan.angle_step_rad == angle_step_rad_ &&
      scan.ranges_m.size() == directions_.size()) {
    return false;
  }
  angle_min_rad_ = scan.angle_min_rad;
  angle_step_rad_ = scan.angle_step_rad;
  directions_.resize(scan.ranges_m.size());
  for (std::size_t i = 0; i < directions_.size(); ++i) {
    const auto [sin, cos] =
        geometry::sincos(angle_min_rad_ + static_cast<double>(i) * angle_step_rad_);
    directions_[i] = {cos, sin};
  }
  return true;
}

bool BeamDirections::closed() const {
  const double tolerance_rad = std::max(0.5 * angle_step_rad_, kTurnTolerance_rad);
  return static_cast<double>(directions_.size()) * angle_step_rad_ >
         2.0 * std::numbers::pi - tolerance_rad;
}

bool within_limit(float range_m, const VoronoiConfig& config) {
  return range_m > 0.0F && static_cast<double>(range_m) <= config.range_limit_m;
}

void split_at_discontinuities(const scan::Scan& scan, const BeamDirections& beams,
                              const VoronoiConfig& config, GeneratorGroups& out) {
  out.points.clear();
  out.groups.clear();
  out.closed = beams.closed();
  const Surfaces surfaces(scan, beams, config);
  for (std::uint32_t i = 0; i < scan.ranges_m.size(); ++i) {
    if (!surfaces.is_reading(i)) continue;
    const auto at = static_cast<std::uint32_t>(out.points.size());
    const bool on_wall = i > 0 && surfaces.continues(i - 1, i);
    if (!on_wall) out.groups.push_back({at, at});
    out.points.push_back({surfaces.position_m(i), scan.ranges_m[i], i, on_wall});
    out.groups.back().end = at + 1;
  }
  if (!out.closed || out.groups.empty() || !surfaces.is_reading(0)) return;
  const auto last = static_cast<std::uint32_t>(scan.ranges_m.size()) - 1;
  if (!surfaces.continues(last, 0)) return;
  out.points.front().on_wall = true;
  if (out.groups.size() > 1) join_with_next(out, out.groups.size() - 1);
}

void join_contiguous_groups(const VoronoiConfig& config, GeneratorGroups& groups) {
  bool changed = true;
  while (changed) {
    changed = false;
    for (std::size_t k = 0; k < border_count(groups);) {
      const PointRun& next = groups.groups[(k + 1) % groups.groups.size()];
      if (distance_below(groups, groups.groups[k], next, config.contiguous_m) < kFar) {
        join_with_next(groups, k);
        changed = true;
      } else {
        ++k;
      }
    }
  }
}

void join_alternate_groups(const VoronoiConfig& config, GeneratorGroups& groups) {
  // A stray reading in front of a wall must not remove the wall.
  const auto is_small = [&](std::size_t k) {
    return config.drop_small && config.alternate_large_only &&
           static_cast<int>(groups.groups[k].size()) <= config.min_group_points;
  };
  while (groups.groups.size() > 2) {
    // In a closed scan each of three groups is next to both others: none are alternate.
    if (groups.closed && groups.groups.size() == 3) return;
    const std::size_t n = groups.groups.size();
    const std::size_t pairs = groups.closed ? n : n - 2;
    const auto may_join = [&](std::size_t k) {
      const std::size_t after = (k + 2) % n;
      if (config.alternate_behind_only && !lies_behind(groups, k, (k + 1) % n, after)) return false;
      return !is_small(k) && !is_small(after);
    };
    double best_m = config.alternate_m;
    std::size_t best = n;
    for (std::size_t k = 0; k < pairs; ++k) {
      if (!may_join(k)) continue;
      const double m = distance_below(groups, groups.groups[k], groups.groups[(k + 2) % n], best_m);
      if (m < best_m) {
        best_m = m;
        best = k;
      }
    }
    if (best == n) return;
    // In a closed scan of four groups, a pair has one of the others on each side. The one in the
    // narrower gap is dropped, whichever is first in the scan.
    if (groups.closed && n == 4) {
      const std::size_t other = (best + 2) % n;
      if (may_join(other) && gap_m(groups, other, best) < gap_m(groups, best, other)) best = other;
    }
    const std::size_t between = (best + 1) % n;
    drop_group(groups, between);
    join_with_next(groups, between < best ? best - 1 : best);
  }
}

void drop_small_groups(const VoronoiConfig& config, GeneratorGroups& groups) {
  std::uint32_t kept_points = 0;
  std::size_t kept_groups = 0;
  for (const PointRun run : groups.groups) {
    if (static_cast<int>(run.size()) <= config.min_group_points) continue;
    std::copy(groups.points.begin() + run.begin, groups.points.begin() + run.end,
              groups.points.begin() + kept_points);
    groups.groups[kept_groups++] = {kept_points, kept_points + run.size()};
    kept_points += run.size();
  }
  groups.points.resize(kept_points);
  groups.groups.resize(kept_groups);
}

void join_across_hidden_zones(const BeamDirections& beams, const VoronoiConfig& config,
                              GeneratorGroups& groups) {
  const auto beam_count = static_cast<std::uint32_t>(beams.directions().size());
  for (std::size_t k = 0; k < border_count(groups);) {
    const PointRun& next_run = groups.groups[(k + 1) % groups.groups.size()];
    const GroupPoint& last = groups.points[groups.groups[k].end - 1];
    const GroupPoint& next = groups.points[next_run.begin];
    const bool successive = (last.beam + 1) % beam_count == next.beam;
    const double angle_rad = geometry::wrap_angle(
        beams.angle_min_rad() + (static_cast<double>(last.beam) + 0.5) * beams.angle_step_rad() -
        config.forward_rad);
    // Ahead on the right and behind on the left the beams turn towards the line of motion.
    const bool towards_motion = (angle_rad < 0.0) == (std::abs(angle_rad) < 0.5 * std::numbers::pi);
    const bool hidden = towards_motion ? last.range_m < next.range_m : last.range_m > next.range_m;
    if (successive && hidden) {
      join_with_next(groups, k);
    } else {
      ++k;
    }
  }
}

void make_generator_groups(const scan::Scan& scan, const BeamDirections& beams,
                           const VoronoiConfig& config, GeneratorGroups& out) {
  split_at_discontinuities(scan, beams, config, out);
  const auto join = [&] {
    if (config.join_contiguous) join_contiguous_groups(config, out);
    if (config.join_alternate) join_alternate_groups(config, out);
  };
  join();
  if (config.drop_small) {
    const std::size_t before = out.groups.size();
    drop_small_groups(config, out);
    if (config.join_again && out.groups.size() < before) join();
  }
  if (config.join_hidden_zones) join_across_hidden_zones(beams, config, out);
}

}  // namespace topogeo::voronoi
