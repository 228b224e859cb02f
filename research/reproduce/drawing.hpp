// Parts of figures in the axes of the publications: x to the right of the robot, y ahead.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/render/figure.hpp"
#include "topogeo/scan/scan.hpp"
#include "topogeo/topomap/global_map.hpp"
#include "topogeo/topomap/local_map.hpp"
#include "topogeo/topomap/visible_rectangle.hpp"
#include "topogeo/voronoi/local_voronoi.hpp"
#include "topogeo/world/world.hpp"

namespace topogeo::reproduce {

/// Converts x forward, y left to the axes of the page.
inline Eigen::Vector2d on_page(const Eigen::Vector2d& point_m) {
  return {-point_m.y(), point_m.x()};
}

/// The k-th of a series of distinct colours.
render::FigureColour distinct_colour(std::size_t k);

/// Surfaces of a world seen by a laser at T_world_laser, pale.
void add_walls(render::FigurePanel& panel, const world::World& world,
               const geometry::Pose2& T_world_laser);
/// The robot, at a pose in the frame of the page.
void add_robot(render::FigurePanel& panel, const geometry::Pose2& T_page_robot,
               render::FigureColour colour = render::FigureColour::kRed);
/// Ranges over the beam angles, from the right.
render::FigurePanel polar_panel(const scan::Scan& scan, double range_limit_m,
                                const std::string& title);
/// Readings of each group in its own colour, with the number of the group.
void add_groups(render::FigurePanel& panel, const voronoi::GeneratorGroups& groups);
/// Branches green, nodes blue, as in the Thesis, chapter 4.
void add_diagram(render::FigurePanel& panel, const voronoi::LocalVoronoiDiagram& diagram);
/// Branches (virtual ones dashed, those off the main graph thin) and nodes: real ones filled,
/// fictitious ones open, states in orange.
void add_map(render::FigurePanel& panel, const topomap::LocalMap& map,
             const geometry::Pose2& T_page_robot, render::FigureColour colour);
void add_map(render::FigurePanel& panel, const topomap::GlobalMap& map,
             render::FigureColour colour);
void add_points(render::FigurePanel& panel, const topomap::LocalMap& map,
                const geometry::Pose2& T_page_robot, render::FigureColour colour,
                double radius_px = 1.0);
/// A rectangle parallel to the axes of the frame.
void add_rectangle(render::FigurePanel& panel, const topomap::VisibleRectangle& rectangle,
                   render::FigureColour colour, bool dashed = false);
void add_path(render::FigurePanel& panel, const std::vector<geometry::Pose2>& poses,
              render::FigureColour colour, bool dashed = false, double dot_px = 2.0);

}  // namespace topogeo::reproduce
