// Rotation, extent and scale of the picture of a map.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "topogeo/render/map_picture.hpp"

namespace topogeo::render {

/// Laser points of all stops in the map frame, those of one scan together; walls as a last one.
using ScanOutline = std::vector<Eigen::Vector2d>;
std::vector<ScanOutline> outlines_in_map(const MapPicture& picture);

/// Direction of most walls in the map frame, [0, pi/2), modulo 90 degrees because walls meet at
/// right angles. Derived from the lines between neighbouring points; 0 without walls.
double dominant_wall_direction_rad(const std::vector<ScanOutline>& outlines);

struct Layout {
  double rotation_cos = 1.0;  ///< rotation from the map frame to the picture's frame
  double rotation_sin = 0.0;
  Eigen::Vector2d min_m = Eigen::Vector2d::Zero();  ///< corners of the visible part, rotated frame
  Eigen::Vector2d max_m = Eigen::Vector2d::Zero();
  double scale_px_per_m = 1.0;
  double map_left_px = 0.0;  ///< the map's rectangle on the page
  double map_top_px = 0.0;
  double map_width_px = 0.0;
  double map_height_px = 0.0;
  std::uint32_t width_px = 0;  ///< of the page
  std::uint32_t height_px = 0;

  [[nodiscard]] Eigen::Vector2d turned_m(const Eigen::Vector2d& point_map_m) const {
    return {rotation_cos * point_map_m.x() - rotation_sin * point_map_m.y(),
            rotation_sin * point_map_m.x() + rotation_cos * point_map_m.y()};
  }
  /// x to the right, y down.
  [[nodiscard]] Eigen::Vector2d turned_to_px(const Eigen::Vector2d& turned) const {
    return {map_left_px + (turned.x() - min_m.x()) * scale_px_per_m,
            map_top_px + (max_m.y() - turned.y()) * scale_px_per_m};
  }
  [[nodiscard]] Eigen::Vector2d to_px(const Eigen::Vector2d& point_map_m) const {
    return turned_to_px(turned_m(point_map_m));
  }
};

Layout make_layout(const MapPicture& picture, const std::vector<ScanOutline>& outlines,
                   const PictureOptions& options);

/// Height of the strip below the map for legend and scale bar.
inline constexpr double kLegendHeight_px = 84.0;

}  // namespace topogeo::render
