// Pictures of a map as PNG and SVG.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "topogeo/planning/drawn_zone.hpp"
#include "topogeo/topomap/global_map.hpp"
#include "topogeo/topomap/local_map.hpp"
#include "topogeo/topomap/trajectory.hpp"

namespace topogeo::render {

/// Contents of the picture, all in the map frame. Every part may be empty. The viewed data must
/// live until the picture is drawn.
/// A zone that people have drawn.
struct PictureZone {
  planning::ZoneKind kind = planning::ZoneKind::kRoom;
  std::vector<Eigen::Vector2d> corners_m;
  double heading_rad = 0.0;  ///< of a one-way zone
};

/// A name of a room, place or zone.
struct PictureName {
  std::string text;
  Eigen::Vector2d at_m = Eigen::Vector2d::Zero();
  bool is_place = false;  ///< marked by a dot
};

struct MapPicture {
  std::span<const topomap::LocalMap> local_maps;    ///< for their laser points
  std::span<const topomap::StopPose> stops;         ///< corrected; stops[i] is of local_maps[i]
  std::span<const topomap::StampedPose> odometry;   ///< from topomap::expand_odometry
  std::span<const topomap::StampedPose> corrected;  ///< from topomap::expand_trajectory
  std::span<const topomap::LoopClosure> loop_closures;
  const topomap::GlobalMap* global_map = nullptr;  ///< nullptr: none yet
  std::string title;
  /// Parts of the trajectory that no match measures, as positions of stops (m); drawn dashed.
  std::vector<std::vector<Eigen::Vector2d>> unmatched_m = {};
  std::vector<Eigen::Vector2d> walls_m = {};  ///< of a drawn grid: middles of its cells
  /// Stamps of poses to which nothing was driven, ascending: no line leads to them.
  std::vector<std::int64_t> drive_starts_ns = {};
  std::vector<PictureZone> zones = {};
  std::vector<PictureName> names = {};
};

struct PictureOptions {
  std::uint32_t max_width_px = 1600;  ///< 400 to 16384
};

/// Writes the picture whole or not at all. Throws std::runtime_error naming the path, and
/// std::invalid_argument for a width out of range or more stops than local maps.
void draw_map_png(const std::filesystem::path& path, const MapPicture& picture,
                  const PictureOptions& options = {});
void draw_map_svg(const std::filesystem::path& path, const MapPicture& picture,
                  const PictureOptions& options = {});

/// The bytes of the files. The same picture gives the same SVG bytes.
std::string map_png(const MapPicture& picture, const PictureOptions& options = {});
std::string map_svg(const MapPicture& picture, const PictureOptions& options = {});

}  // namespace topogeo::render
