#include "draw_map.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>
#include <utility>

#include "canvas.hpp"
#include "labels.hpp"
#include "legend.hpp"
#include "point_raster.hpp"

namespace topogeo::render {
namespace {

void draw_laser_points(cairo_t* cr, const std::vector<ScanOutline>& outlines,
                       const Layout& layout) {
  constexpr double kFinestCell_m = 0.03;
  const double cell_m = std::max(kFinestCell_m, 1.0 / layout.scale_px_per_m);
  set_colour(cr, kLaserPoints);
  cairo_set_line_cap(cr, CAIRO_LINE_CAP_BUTT);
  cairo_set_line_width(cr, std::clamp(cell_m * layout.scale_px_per_m, 1.25, 2.5));
  for (const RasterRun& run : raster_runs(outlines, layout, cell_m)) {
    move_to(cr, layout.turned_to_px(run.from_m));
    line_to(cr, layout.turned_to_px(run.to_m));
  }
  cairo_stroke(cr);
  cairo_set_line_cap(cr, CAIRO_LINE_CAP_ROUND);
}

void draw_path(cairo_t* cr, std::span<const topomap::StampedPose> poses,
               std::span<const std::int64_t> starts_ns, const Layout& layout, const Colour& colour,
               double width_px) {
  if (poses.empty()) return;
  set_colour(cr, colour);
  cairo_set_line_width(cr, width_px);
  Eigen::Vector2d last_px = layout.to_px(poses.front().pose.position_m());
  move_to(cr, last_px);
  for (const topomap::StampedPose& p : poses) {
    const Eigen::Vector2d point_px = layout.to_px(p.pose.position_m());
    if (std::ranges::binary_search(starts_ns, p.stamp_ns)) {
      move_to(cr, point_px);
      last_px = point_px;
      continue;
    }
    if ((point_px - last_px).norm() < 1.0) continue;  // a standing robot
    line_to(cr, point_px);
    last_px = point_px;
  }
  cairo_stroke(cr);
}

// White under the dashes interrupts the line of the trajectory.
void draw_unmatched(cairo_t* cr, const MapPicture& picture, const Layout& layout) {
  for (const bool dashed : {false, true}) {
    set_colour(cr, dashed ? kCorrected : kWhite);
    cairo_set_line_width(cr, dashed ? 2.0 : 4.0);
    cairo_set_line_cap(cr, dashed ? CAIRO_LINE_CAP_BUTT : CAIRO_LINE_CAP_ROUND);
    set_dashes(cr, dashed);
    for (const std::vector<Eigen::Vector2d>& part : picture.unmatched_m) {
      if (part.empty()) continue;
      move_to(cr, layout.to_px(part.front()));
      for (const Eigen::Vector2d& point_m : part) line_to(cr, layout.to_px(point_m));
      cairo_stroke(cr);
    }
  }
  set_dashes(cr, false);
  cairo_set_line_cap(cr, CAIRO_LINE_CAP_ROUND);
}

void draw_branches(cairo_t* cr, const topomap::GlobalMap& map, bool virtual_ones,
                   const Layout& layout) {
  cairo_set_line_width(cr, virtual_ones ? 3.0 : 2.0);
  set_colour(cr, virtual_ones ? kVirtualBranch : kBranch);
  set_dashes(cr, virtual_ones);
  for (const topomap::MapBranch& branch : map.branches) {
    if (branch.points.empty() || branch.is_virtual != virtual_ones) continue;
    Eigen::Vector2d last_px = layout.to_px(branch.points.front().position_m);
    move_to(cr, last_px);
    for (std::size_t i = 1; i < branch.points.size(); ++i) {
      const Eigen::Vector2d point_px = layout.to_px(branch.points[i].position_m);
      const bool is_end = i + 1 == branch.points.size();
      if (!is_end && (point_px - last_px).norm() < 1.0) continue;
      line_to(cr, point_px);
      last_px = point_px;
    }
    cairo_stroke(cr);
  }
  set_dashes(cr, false);
}

// One line for all closures between the same two parts of the path: a corridor driven twice has
// hundreds, which would hide the map.
void draw_loop_closures(cairo_t* cr, const MapPicture& picture, const Layout& layout) {
  constexpr std::uint32_t kStretch_stops = 8;
  std::set<std::pair<std::uint32_t, std::uint32_t>> drawn;
  set_colour(cr, kLoopClosure);
  cairo_set_line_width(cr, 0.75);
  for (const topomap::LoopClosure& closure : picture.loop_closures) {
    if (std::max(closure.earlier_id, closure.later_id) >= picture.stops.size()) continue;
    const auto stretches =
        std::pair(closure.earlier_id / kStretch_stops, closure.later_id / kStretch_stops);
    if (!drawn.insert(stretches).second) continue;
    move_to(cr, layout.to_px(picture.stops[closure.earlier_id].T_map_robot.position_m()));
    line_to(cr, layout.to_px(picture.stops[closure.later_id].T_map_robot.position_m()));
  }
  cairo_stroke(cr);
}

void draw_nodes(cairo_t* cr, const topomap::GlobalMap& map, const Layout& layout) {
  for (const topomap::MapNode& node : map.nodes) {
    const Eigen::Vector2d centre_px = layout.to_px(node.position_m);
    draw_node_marker(cr, node.kind, {snapped(centre_px.x()), snapped(centre_px.y())});
  }
}

Colour colour_of(planning::ZoneKind kind) {
  switch (kind) {
    case planning::ZoneKind::kNoGo:
      return kNoGoZone;
    case planning::ZoneKind::kSlow:
      return kSlowZone;
    case planning::ZoneKind::kOneWay:
      return kOneWayZone;
    case planning::ZoneKind::kPreferred:
      return kPreferredLane;
    case planning::ZoneKind::kRoom:
      break;
  }
  return kDrawnRoom;
}

Eigen::Vector2d middle_of(const std::vector<Eigen::Vector2d>& points_m) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& point_m : points_m) sum += point_m;
  return sum / static_cast<double>(std::max<std::size_t>(points_m.size(), 1));
}

/// The allowed direction, through the middle of the zone.
void draw_direction(cairo_t* cr, const PictureZone& zone, const Layout& layout) {
  constexpr double kArrowHalf_m = 0.6;
  constexpr double kArrowHead_m = 0.35;
  const auto along = [&](double turn_rad) {
    const double angle_rad = zone.heading_rad + turn_rad;
    return Eigen::Vector2d(std::cos(angle_rad), std::sin(angle_rad));
  };
  const Eigen::Vector2d middle_m = middle_of(zone.corners_m);
  const Eigen::Vector2d tip_m = middle_m + kArrowHalf_m * along(0.0);
  move_to(cr, layout.to_px(middle_m - kArrowHalf_m * along(0.0)));
  line_to(cr, layout.to_px(tip_m));
  for (const double turn_rad : {2.6, -2.6}) {
    move_to(cr, layout.to_px(tip_m));
    line_to(cr, layout.to_px(tip_m + kArrowHead_m * along(turn_rad)));
  }
  cairo_stroke(cr);
}

void draw_zones(cairo_t* cr, const std::vector<PictureZone>& zones, const Layout& layout) {
  constexpr double kZonePaleness = 0.25;
  for (const PictureZone& zone : zones) {
    if (zone.corners_m.size() < 3) continue;
    move_to(cr, layout.to_px(zone.corners_m.front()));
    for (const Eigen::Vector2d& corner_m : zone.corners_m) line_to(cr, layout.to_px(corner_m));
    cairo_close_path(cr);
    if (zone.kind != planning::ZoneKind::kRoom) {
      set_colour(cr, paled(colour_of(zone.kind), kZonePaleness));
      cairo_fill_preserve(cr);
    }
    set_colour(cr, colour_of(zone.kind));
    cairo_set_line_width(cr, 2.0);
    cairo_stroke(cr);
    if (zone.kind == planning::ZoneKind::kOneWay) draw_direction(cr, zone, layout);
  }
}

void draw_names(cairo_t* cr, const std::vector<PictureName>& names, const Layout& layout) {
  constexpr double kNameSize_px = 14.0;
  constexpr double kPlaceDot_px = 4.0;
  const Rect map{layout.map_left_px, layout.map_top_px, layout.map_width_px, layout.map_height_px};
  Labels labels;
  for (const PictureName& name : names) labels.block(layout.to_px(name.at_m), kPlaceDot_px);
  for (const PictureName& name : names) {
    const Eigen::Vector2d at_px = layout.to_px(name.at_m);
    if (name.is_place) {
      circle(cr, at_px, kPlaceDot_px);
      fill_and_edge(cr, kDoor, kWhite, 1.5);
    }
    set_colour(cr, kInk);
    labels.draw(cr, name.text, at_px, kPlaceDot_px + 2.0, kNameSize_px, map, true);
  }
}

void draw_title(cairo_t* cr, const MapPicture& picture, const Layout& layout) {
  set_colour(cr, kInk);
  constexpr double kTitleSize_px = 18.0;
  draw_text(cr, picture.title, 24.0, 28.0, kTitleSize_px);
  if (picture.stops.empty() && picture.corrected.empty() && picture.walls_m.empty()) {
    draw_text(cr, "nothing mapped yet", layout.map_left_px, layout.map_top_px + 20.0, 14.0);
  }
}

}  // namespace

void draw_map(cairo_t* cr, const MapPicture& picture, const std::vector<ScanOutline>& outlines,
              const Layout& layout) {
  start_page(cr);

  cairo_save(cr);
  cairo_rectangle(cr, layout.map_left_px, layout.map_top_px, layout.map_width_px,
                  layout.map_height_px);
  cairo_clip(cr);
  draw_zones(cr, picture.zones, layout);
  draw_laser_points(cr, outlines, layout);
  draw_path(cr, picture.odometry, picture.drive_starts_ns, layout, kOdometry, 1.5);
  if (picture.global_map != nullptr) draw_branches(cr, *picture.global_map, false, layout);
  draw_loop_closures(cr, picture, layout);
  draw_path(cr, picture.corrected, picture.drive_starts_ns, layout, kCorrected, 2.0);
  draw_unmatched(cr, picture, layout);
  if (picture.global_map != nullptr) {
    // On top of the trajectory, which runs along the branches.
    draw_branches(cr, *picture.global_map, true, layout);
    draw_nodes(cr, *picture.global_map, layout);
  }
  if (!picture.corrected.empty()) {
    draw_start_marker(cr, layout.to_px(picture.corrected.front().pose.position_m()));
  }
  draw_names(cr, picture.names, layout);
  cairo_restore(cr);

  draw_title(cr, picture, layout);
  draw_legend(cr, picture, layout);
}

}  // namespace topogeo::render
