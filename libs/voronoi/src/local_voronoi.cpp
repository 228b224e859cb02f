#include "topogeo/voronoi/local_voronoi.hpp"

#include <algorithm>
#include <cmath>

#include "virtual_sites.hpp"

namespace topogeo::voronoi {
namespace {

/// True for a beam with an echo, near or far.
bool is_echo(float range_m) {
  return range_m > 0.0F && std::isfinite(range_m);
}

}  // namespace

LocalVoronoi::LocalVoronoi(const VoronoiConfig& config) : config_(config) {
  check(config_);
}

/// Space is free up to the reading or the range limit. A beam without an echo proves nothing,
/// unless it is a short drop-out between two beams with echoes.
void LocalVoronoi::measure_free_space(const scan::Scan& scan) {
  const std::size_t count = scan.ranges_m.size();
  free_range_m_.assign(count, 0.0);
  const auto most = static_cast<std::size_t>(config_.dropout_rad / scan.angle_step_rad + 1e-6);
  const auto fill_between = [&](std::size_t from, std::size_t to) {
    if (to - from - 1 > most) return;
    const double free_m = std::min(free_range_m_[from], free_range_m_[to % count]);
    for (std::size_t i = from + 1; i < to; ++i) free_range_m_[i % count] = free_m;
  };
  std::size_t first = count;  // first echo of all, and last echo before i
  std::size_t last = count;
  for (std::size_t i = 0; i < count; ++i) {
    if (!is_echo(scan.ranges_m[i])) continue;
    free_range_m_[i] = std::min(static_cast<double>(scan.ranges_m[i]), config_.range_limit_m);
    if (last < count) fill_between(last, i);
    if (first == count) first = i;
    last = i;
  }
  if (beams_.closed() && first < count) fill_between(last, first + count);
}

LocalVoronoiDiagram LocalVoronoi::compute(const scan::Scan& scan) {
  LocalVoronoiDiagram diagram;
  compute(scan, diagram);
  return diagram;
}

void LocalVoronoi::compute(const scan::Scan& scan, LocalVoronoiDiagram& out) {
  if (beams_.update(scan)) grid_.set_geometry(beams_, config_);
  make_generator_groups(scan, beams_, config_, out.groups);
  measure_free_space(scan);

  trace(out);
  out.is_virtual = out.branches.empty();
  if (out.is_virtual && !scan.ranges_m.empty()) {
    // Groups that do not meet in view are like one group to the robot.
    if (!out.groups.groups.empty()) {
      out.groups.groups = {{0, static_cast<std::uint32_t>(out.groups.points.size())}};
    }
    // For navigation, a beam without an echo is free: otherwise a robot in the open could not move.
    std::replace(free_range_m_.begin(), free_range_m_.end(), 0.0, config_.range_limit_m);
    add_virtual_groups(beams_, free_range_m_, config_, out.groups);
    trace(out);
    drop_tight_ends(out);
  }
  measure_hidden_depths(out);
}

/// If the line of a virtual group meets a wall, the branch between them runs into the corner. The
/// line is no object, so parts narrower than the robot there are no path. A branch that is narrow
/// all along stays: the robot is in it.
void LocalVoronoi::drop_tight_ends(LocalVoronoiDiagram& diagram) const {
  const double least_m = 0.5 * config_.contiguous_m;
  std::uint32_t dropped = 0;  // of the branches so far
  for (DiagramBranch& branch : diagram.branches) {
    branch.points.begin -= dropped;
    branch.points.end -= dropped;
    const auto tight = [&](std::uint32_t i) { return diagram.points[i].clearance_m < least_m; };
    auto [first, end] = branch.points;
    while (branch.node_a == DiagramBranch::kLoose && first < end && tight(first)) ++first;
    while (branch.node_b == DiagramBranch::kLoose && first < end && tight(end - 1)) --end;
    if (end - first < 2) continue;
    const auto at = [&](std::uint32_t i) { return diagram.points.begin() + std::ptrdiff_t{i}; };
    diagram.points.erase(at(end), at(branch.points.end));
    diagram.points.erase(at(branch.points.begin), at(first));
    dropped += branch.points.size() - (end - first);
    branch.points.end = branch.points.begin + (end - first);
  }
}

void LocalVoronoi::trace(LocalVoronoiDiagram& diagram) {
  place_sites(diagram.groups);
  grid_.compute(sites_, free_range_m_);
  cracks_.trace(grid_, sites_, config_, diagram);
}

/// Uses the configured spacing, doubled while the sites exceed the limit of the grid.
void LocalVoronoi::place_sites(const GeneratorGroups& groups) {
  double spacing_m = config_.site_spacing_m;
  place_sites(groups, spacing_m);
  while (sites_.size() >= NearestSiteGrid::kNone && spacing_m > 0.0) {
    spacing_m = spacing_m < config_.range_limit_m ? 2.0 * spacing_m : 0.0;
    place_sites(groups, spacing_m);
  }
}

/// Every reading of a group is a site, and so are points on a wall between distant readings.
void LocalVoronoi::place_sites(const GeneratorGroups& groups, double spacing_m) {
  sites_.clear();
  for (std::size_t g = 0; g < groups.groups.size(); ++g) {
    const PointRun& run = groups.groups[g];
    const auto group = static_cast<std::uint16_t>(g);
    for (std::uint32_t i = run.begin; i < run.end; ++i) {
      const Eigen::Vector2d& at_m = groups.points[i].position_m;
      if (i > run.begin && groups.points[i].on_wall && spacing_m > 0.0) {
        const Eigen::Vector2d& from_m = groups.points[i - 1].position_m;
        const double pieces = std::min(100.0, std::ceil((at_m - from_m).norm() / spacing_m));
        for (double piece = 1.0; piece < pieces; ++piece) {
          sites_.push_back({from_m + (piece / pieces) * (at_m - from_m), group});
        }
      }
      sites_.push_back({at_m, group});
    }
  }
}

void LocalVoronoi::measure_hidden_depths(LocalVoronoiDiagram& diagram) {
  if (diagram.is_virtual) {
    frontier_.clear();
  } else {
    frontier_.compute(beams_, free_range_m_, diagram.groups, config_.range_limit_m);
  }
  const auto measure = [&](auto& place) {
    place.hidden_m = std::max(0.0, place.clearance_m - frontier_.distance_m(place.position_m));
  };
  for (DiagramPoint& point : diagram.points) measure(point);
  for (DiagramNode& node : diagram.nodes) measure(node);
}

}  // namespace topogeo::voronoi
