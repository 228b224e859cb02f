// A picture of the search for the relative pose of two stops: searched area, result, and the two
// local maps at that pose (Thesis, figs. 6.2 and 6.4).
//
// All in the robot frame of the reference stop, x (forward) up and y (left) to the left.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/render/map_picture.hpp"
#include "topogeo/render/picture_format.hpp"
#include "topogeo/topomap/local_map.hpp"

namespace topogeo::render {

/// Poses are T_reference_query.
struct MatchPicture {
  const topomap::LocalMap* reference = nullptr;
  const topomap::LocalMap* query = nullptr;
  geometry::Pose2 T_predicted;   ///< centre of the search
  double ellipse_major_m = 0.0;  ///< semi-axes of the error ellipse of the prediction
  double ellipse_minor_m = 0.0;
  double ellipse_direction_rad = 0.0;                      ///< of its major axis from x
  Eigen::Vector2d half_width_m = Eigen::Vector2d::Zero();  ///< of the searched rectangle
  std::vector<geometry::Pose2> solutions;                  ///< best first; numbered from 1
  bool found = false;
  geometry::Pose2 T_found;  ///< the refined pose, if found
  std::string title;
  std::vector<std::string> lines;  ///< below the plans
};

/// The bytes of the file, `max_width_px` wide: on the left the field of view of the reference, its
/// points, branches and nodes, and those of the query at the pose found (blue) or, without one, at
/// the prediction; on the right the searched rectangle with ellipse and solutions. The same picture
/// gives the same SVG bytes. Throws std::invalid_argument for a width out of range.
std::string match_picture(const MatchPicture& picture, PictureFormat format,
                          const PictureOptions& options = {});

}  // namespace topogeo::render
