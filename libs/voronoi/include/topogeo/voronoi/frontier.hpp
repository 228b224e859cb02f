// The frontier of one scan: the border between the space that it proves to be free and unseen
// space.
//
// The clearance of a place is certain only if its whole circle was seen; if the frontier crosses
// the circle, an unseen object can be nearer. Behind a corner the diagram runs between the corner
// and the next visible object, and changes with each step of the robot; the depth to which the
// circle is hidden separates such places from stable ones. docs/decisions/perception.md has the
// figures.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "topogeo/voronoi/generator_groups.hpp"

namespace topogeo::voronoi {

/// A reusable work space.
class Frontier {
 public:
  /// Computes the frontier of a scan: the free ends of the beams between the last reading of a
  /// group and the first of the next, the two outer beams of a field of view below a full turn, and
  /// the arc of the range limit. There is none between successive readings of one group.
  /// `free_range_m` has one value per beam, 0 if nothing is known to be free.
  void compute(const BeamDirections& beams, std::span<const double> free_range_m,
               const GeneratorGroups& groups, double range_limit_m);
  /// Removes the frontier: all space counts as seen.
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
