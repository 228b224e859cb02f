#include "topogeo/voronoi/frontier.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace topogeo::voronoi {
namespace {

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

}  // namespace

void Frontier::clear() {
  edges_.clear();
  arcs_.clear();
}

void Frontier::add_edge(const Eigen::Vector2d& a_m, const Eigen::Vector2d& b_m) {
  const Eigen::Vector2d along_m = b_m - a_m;
  const double sq = along_m.squaredNorm();
  edges_.push_back({a_m, along_m, sq > 0.0 ? 1.0 / sq : 0.0});
}

void Frontier::add_arc(const Eigen::Vector2d& first, const Eigen::Vector2d& last) {
  // Extends one arc while beams reach the limit, up to a quarter, so that signs of cross products
  // show which points are inside.
  if (!arcs_.empty() && arcs_.back().last == first && arcs_.back().first.dot(last) > 0.0) {
    arcs_.back().last = last;
  } else {
    arcs_.push_back({first, last});
  }
}

void Frontier::add_gap(const BeamDirections& beams, std::span<const double> free_range_m,
                       std::size_t first_beam, std::size_t beam_count) {
  const std::size_t turn = free_range_m.size();
  for (std::size_t i = 0; i + 1 < beam_count; ++i) {
    const std::size_t a = (first_beam + i) % turn;
    const std::size_t b = (a + 1) % turn;
    const double range_a_m = free_range_m[a];
    const double range_b_m = free_range_m[b];
    const auto& directions = beams.directions();
    if (range_a_m == 0.0 && range_b_m == 0.0) continue;
    if (range_a_m == range_limit_m_ && range_b_m == range_limit_m_) {
      add_arc(directions[a], directions[b]);
    } else {
      add_edge(directions[a] * range_a_m, directions[b] * range_b_m);
    }
  }
}

void Frontier::compute(const BeamDirections& beams, std::span<const double> free_range_m,
                       const GeneratorGroups& groups, double range_limit_m) {
  clear();
  range_limit_m_ = range_limit_m;
  const std::size_t beam_count = free_range_m.size();
  if (beam_count == 0 || groups.groups.empty()) return;
  const auto first_beam = [&](std::size_t group) {
    return std::size_t{groups.points[groups.groups[group].begin].beam};
  };
  const auto last_beam = [&](std::size_t group) {
    return std::size_t{groups.points[groups.groups[group].end - 1].beam};
  };
  for (std::size_t group = 0; group + 1 < groups.groups.size(); ++group) {
    const std::size_t from = last_beam(group);
    const std::size_t to = first_beam(group + 1);
    add_gap(beams, free_range_m, from, (to + beam_count - from) % beam_count + 1);
  }
  const std::size_t last = last_beam(groups.groups.size() - 1);
  const std::size_t first = first_beam(0);
  if (groups.closed) {
    const bool unbroken = groups.groups.size() == 1 && groups.points.front().on_wall;
    if (unbroken) return;
    add_gap(beams, free_range_m, last, (first + beam_count - last) % beam_count + 1);
    return;
  }
  add_gap(beams, free_range_m, last, beam_count - last);
  add_gap(beams, free_range_m, 0, first + 1);
  for (const std::size_t outer : {std::size_t{0}, beam_count - 1}) {
    add_edge(Eigen::Vector2d::Zero(), beams.directions()[outer] * free_range_m[outer]);
  }
}

double Frontier::distance_m(const Eigen::Vector2d& point_m) const {
  double best_sq = std::numeric_limits<double>::infinity();
  for (const Edge& edge : edges_) {
    const Eigen::Vector2d from_m = point_m - edge.from_m;
    const double t = std::clamp(from_m.dot(edge.along_m) * edge.inverse_sq, 0.0, 1.0);
    best_sq = std::min(best_sq, (from_m - t * edge.along_m).squaredNorm());
  }
  const double range_m = point_m.norm();
  for (const Arc& arc : arcs_) {
    if (cross(arc.first, point_m) >= 0.0 && cross(point_m, arc.last) >= 0.0) {
      best_sq = std::min(best_sq, (range_limit_m_ - range_m) * (range_limit_m_ - range_m));
    } else {
      for (const Eigen::Vector2d& end : {arc.first, arc.last}) {
        best_sq = std::min(best_sq, (end * range_limit_m_ - point_m).squaredNorm());
      }
    }
  }
  return std::sqrt(best_sq);
}

}  // namespace topogeo::voronoi
