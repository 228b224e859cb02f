// Fields of view, their overlap and the closing of a cycle (Thesis, 7.3.1.1: definitions
// 7.3.1-7.3.3, propositions 7.3.1 and 7.3.2; docs/algorithms.md, "Forward correction").
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/topomap/local_map.hpp"

namespace topogeo::topomap {

/// Rectangle along the axes of its frame, borders included; metres, low <= high.
struct VisibleRectangle {
  Eigen::Vector2d low_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d high_m = Eigen::Vector2d::Zero();
};

/// CV of a map in the frame of its robot: the rectangle around the robot and all elements that
/// matching uses: the nodes and branches that are not virtual, as in the Thesis, and with
/// `with_points` also the scan points, the only elements in a dead end.
VisibleRectangle visible_rectangle(const LocalMap& map, bool with_points = true);

bool contains(const VisibleRectangle& view, const Eigen::Vector2d& point_m);

/// The same field of view in another frame (eq. 7.19), for a pose anywhere in the rectangular
/// search space of the given half-widths (m, m, rad; none negative) around T_frame_robot: the
/// envelope over the space (fig. 7.9). The thesis takes only the corners of the space, which misses
/// how far a corner of the rectangle swings out between the two extreme headings; here the swing
/// counts. Throws std::invalid_argument for a half-width that is negative or not finite.
VisibleRectangle seen_from(const VisibleRectangle& view, const geometry::Pose2& T_frame_robot,
                           const Eigen::Vector3d& half_width);

/// Whether two fields of view in one frame have a point in common (proposition 7.3.1).
bool overlap(const VisibleRectangle& a, const VisibleRectangle& b);

/// Possible poses of the new map, relative to one earlier map.
struct PlacedView {
  geometry::Pose2 T_earlier_new;
  Eigen::Vector3d half_width = Eigen::Vector3d::Zero();  ///< of the search space: m, m, rad
};

/// MS of a new map (definition 7.3.3): ascending indices of the earlier maps whose field of view
/// overlaps its own. `places[i]` belongs to `earlier[i]`. Throws std::invalid_argument if their
/// sizes differ.
std::vector<std::uint32_t> overlap_set(const VisibleRectangle& view,
                                       std::span<const VisibleRectangle> earlier,
                                       std::span<const PlacedView> places);

/// The maps of MS_T that are neither in MS_{T-1} nor g_{T-1} itself: if there are any, a cycle
/// closes (proposition 7.3.2). Both sets and the result are ascending.
std::vector<std::uint32_t> newly_seen(std::span<const std::uint32_t> overlaps,
                                      std::span<const std::uint32_t> overlaps_before,
                                      std::uint32_t before);

}  // namespace topogeo::topomap
