// Generator groups: the scan points that belong to one object (Thesis, 4.2.1).
//
// The five steps of the Thesis in its order, each a function. Points stay in beam order and a group
// is a run of successive points, so every step works on the borders between runs. Joining by 4.8
// and 4.9 does not depend on the direction: contiguous groups are joined until nothing changes,
// alternate groups nearest pair first, so that the mirror image of a scan has the mirror image of
// its groups.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "topogeo/scan/scan.hpp"
#include "topogeo/voronoi/voronoi_config.hpp"

namespace topogeo::voronoi {

/// One reading within the range limit.
struct GroupPoint {
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();  ///< laser frame
  float range_m = 0.0F;
  std::uint32_t beam = 0;
  bool on_wall = false;  ///< on the same surface as the reading of the previous beam (4.7)
};

/// Points [begin, end) of GeneratorGroups::points.
struct PointRun {
  std::uint32_t begin = 0;
  std::uint32_t end = 0;
  [[nodiscard]] std::uint32_t size() const { return end - begin; }
};

struct GeneratorGroups {
  std::vector<GroupPoint>
      points;                    ///< in beam order; in a closed scan starting at a border of groups
  std::vector<PointRun> groups;  ///< in the order of their points, without gaps
  bool closed = false;  ///< the scan covers a full turn: the last group is next to the first
};

/// Unit vectors of the beams of one scan geometry, computed once per geometry.
class BeamDirections {
 public:
  /// Returns true if the geometry differs from the last one. Throws std::invalid_argument if the
  /// first angle is not within +-100 rad, the step is not finite or below 1e-5 rad, or there are
  /// more than 65,000 beams or more than one turn of them.
  bool update(const scan::Scan& scan);
  [[nodiscard]] const std::vector<Eigen::Vector2d>& directions() const { return directions_; }
  [[nodiscard]] double angle_min_rad() const { return angle_min_rad_; }
  [[nodiscard]] double angle_step_rad() const { return angle_step_rad_; }
  /// True if the last beam is next to the first.
  [[nodiscard]] bool closed() const;

 private:
  std::vector<Eigen::Vector2d> directions_;
  double angle_min_rad_ = 0.0;
  double angle_step_rad_ = 0.0;
};

/// True for a reading in S_DVL (4.2): finite, above zero, at most the range limit.
bool within_limit(float range_m, const VoronoiConfig& config);

/// Step 1 (4.7). Fills `out` from the scan: every run of successive readings is one group, split
/// where ranges jump and the readings are not on one wall either.
void split_at_discontinuities(const scan::Scan& scan, const BeamDirections& beams,
                              const VoronoiConfig& config, GeneratorGroups& out);
/// Step 2 (4.8).
void join_contiguous_groups(const VoronoiConfig& config, GeneratorGroups& groups);
/// Step 3 (4.9).
void join_alternate_groups(const VoronoiConfig& config, GeneratorGroups& groups);
/// Step 4 (4.10).
void drop_small_groups(const VoronoiConfig& config, GeneratorGroups& groups);
/// Step 5 (4.11, 4.12). Beyond the corner at the end of a wall along the path, readings are farther
/// away: the range jumps outward where successive beams turn towards the line of motion, inward
/// where they turn away from it. That is 4.11 for the first quadrant (ahead on the right), 4.12 for
/// the second (ahead on the left), and for a wider field of view their mirror images behind the
/// robot. Quadrants refer to the configured forward direction, however the laser is mounted.
void join_across_hidden_zones(const BeamDirections& beams, const VoronoiConfig& config,
                              GeneratorGroups& groups);

/// All enabled steps, in order.
void make_generator_groups(const scan::Scan& scan, const BeamDirections& beams,
                           const VoronoiConfig& config, GeneratorGroups& out);

}  // namespace topogeo::voronoi
