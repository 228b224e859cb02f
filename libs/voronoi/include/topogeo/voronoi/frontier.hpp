// The frontier of one scan: the border between what it proves to be free and what it did not see.
//
// A place is as far from the objects as the scan shows only if the whole circle of that clearance
// was seen; where the frontier crosses the circle, an object that the robot does not see yet can
// lie nearer. Behind a corner the diagram runs between the corner and whatever shows beyond it, and
// changes with each step of the robot; the depth to which the circle is hidden separates such
// places from those that stay. tests/bench/RESULTS.md has the figures.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "topogeo/voronoi/generator_groups.hpp"

namespace topogeo::voronoi {

/// A reusable work space.
class Frontier {
 public:
  /// Takes the frontier of a scan: the free ends of the beams between the last reading of a group
  /// and the first of the next, the two outer beams of a field of view that is not a full turn, and
  /// the arc of the range limit. Between successive readings of one group there is none.
  /// `free_range_m` has one value per beam, 0 where nothing is known to be free.
  void compute(const BeamDirections& beams, std::span<const double> free_range_m,
               const GeneratorGroups& groups, double range_limit_m);
  /// Without a frontier everything counts as seen.
  void clear();

  /// Distance from a seen point (laser frame) to the frontier, metres; infinity without one.
  [[nodiscard]] double distance_m(const Eigen::Vector2d& point_m) const;

 private:
  struct Edge {
    Eigen::Vector2d from_m;
    Eigen::Vector2d along_m;
    double inverse_sq = 0.0;  ///< of the length; 0 for a point
  };
  /// Part of the circle of the range limit, counter-clockwise, at most a quarter.
  struct Arc {
    Eigen::Vector2d first;  ///< unit vectors
    Eigen::Vector2d last;
  };

  void add_gap(const BeamDirections& beams, std::span<const double> free_range_m,
               std::size_t first_beam, std::size_t beam_count);
  void add_edge(const Eigen::Vector2d& a_m, const Eigen::Vector2d& b_m);
  void add_arc(const Eigen::Vector2d& first, const Eigen::Vector2d& last);

  double range_limit_m_ = 0.0;
  std::vector<Edge> edges_;
  std::vector<Arc> arcs_;
};

}  // namespace topogeo::voronoi
