#include "reproduce/drawing.hpp"

#include <array>
#include <cmath>
#include <numbers>

namespace topogeo::reproduce {

using geometry::Pose2;
using render::FigureColour;
using render::FigurePanel;

namespace {

constexpr int kCircleCorners = 48;
constexpr double kLabelAway_m = 0.25;

std::vector<Eigen::Vector2d> circle_on_page(const Eigen::Vector2d& centre_m, double radius_m) {
  std::vector<Eigen::Vector2d> points;
  for (int i = 0; i < kCircleCorners; ++i) {
    const double angle_rad = 2.0 * std::numbers::pi * i / kCircleCorners;
    points.push_back(
        on_page(centre_m + radius_m * Eigen::Vector2d(std::cos(angle_rad), std::sin(angle_rad))));
  }
  return points;
}

/// Dots of a node of this kind.
render::FigureDots node_dots(topomap::NodeKind kind, FigureColour colour) {
  switch (kind) {
    case topomap::NodeKind::kReal:
      return {{}, colour, 4.5};
    case topomap::NodeKind::kFictitious:
      return {{}, colour, 3.0, true};
    case topomap::NodeKind::kVirtual:
      return {{}, FigureColour::kSky, 3.5};
    case topomap::NodeKind::kDoor:
    case topomap::NodeKind::kNarrowing:
    case topomap::NodeKind::kHallCorridor:
      return {{}, FigureColour::kOrange, 5.0};
  }
  return {{}, colour, 3.0};
}

}  // namespace

FigureColour distinct_colour(std::size_t k) {
  constexpr std::array<FigureColour, 6> kColours{FigureColour::kRed,    FigureColour::kBlue,
                                                 FigureColour::kTeal,   FigureColour::kOrange,
                                                 FigureColour::kViolet, FigureColour::kSky};
  return kColours[k % kColours.size()];
}

void add_walls(FigurePanel& panel, const world::World& world, const Pose2& T_world_laser) {
  const Pose2 T_laser_world = geometry::inverse(T_world_laser);
  for (const world::Segment& wall : world.segments) {
    panel.lines.push_back({{on_page(T_laser_world * wall.a_m), on_page(T_laser_world * wall.b_m)},
                           FigureColour::kGrey,
                           1.0});
  }
  for (const world::Circle& circle : world.circles) {
    render::FigureLine line{circle_on_page(T_laser_world * circle.center_m, circle.radius_m),
                            FigureColour::kGrey, 1.0};
    line.closed = true;
    panel.lines.push_back(std::move(line));
  }
}

void add_robot(FigurePanel& panel, const Pose2& T_page_robot, FigureColour colour) {
  constexpr double kLength_m = 0.35;
  panel.lines.push_back({{on_page(T_page_robot.position_m()),
                          on_page(T_page_robot * Eigen::Vector2d(kLength_m, 0.0))},
                         colour,
                         2.0});
  panel.dots.push_back({{on_page(T_page_robot.position_m())}, colour, 4.0});
}

FigurePanel polar_panel(const scan::Scan& scan, double range_limit_m, const std::string& title) {
  FigurePanel panel;
  panel.title = title;
  panel.across = "angle from the right (degrees)";
  panel.up = "range (m)";
  panel.equal_scale = false;
  render::FigureDots within{{}, FigureColour::kRed, 1.5};
  render::FigureDots beyond{{}, FigureColour::kGrey, 1.5};
  double farthest_m = range_limit_m;
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    const double range_m = scan.ranges_m[i];
    if (!(range_m < 3.0 * range_limit_m)) continue;
    const double angle_rad =
        scan.angle_min_rad + static_cast<double>(i) * scan.angle_step_rad + 0.5 * std::numbers::pi;
    (range_m <= range_limit_m ? within : beyond)
        .points.emplace_back(angle_rad * 180.0 / std::numbers::pi, range_m);
    farthest_m = std::max(farthest_m, range_m);
  }
  panel.extent = {{0.0, 0.0}, {180.0, 1.05 * farthest_m}};
  panel.lines.push_back(
      {{{0.0, range_limit_m}, {180.0, range_limit_m}}, FigureColour::kGrey, 1.0, true});
  panel.dots = {beyond, within};
  return panel;
}

void add_groups(FigurePanel& panel, const voronoi::GeneratorGroups& groups) {
  for (std::size_t g = 0; g < groups.groups.size(); ++g) {
    render::FigureDots dots{{}, distinct_colour(g), 2.0};
    for (std::uint32_t i = groups.groups[g].begin; i < groups.groups[g].end; ++i) {
      dots.points.push_back(on_page(groups.points[i].position_m));
    }
    if (dots.points.empty()) continue;
    const Eigen::Vector2d middle = dots.points[dots.points.size() / 2];
    panel.dots.push_back(std::move(dots));
    panel.texts.push_back({middle + kLabelAway_m * middle.normalized(), std::to_string(g + 1)});
  }
}

void add_diagram(FigurePanel& panel, const voronoi::LocalVoronoiDiagram& diagram) {
  for (const voronoi::DiagramBranch& branch : diagram.branches) {
    render::FigureLine line{{}, FigureColour::kGreen, 2.5};
    line.dashed = diagram.is_virtual;
    for (const voronoi::DiagramPoint& point : diagram.points_of(branch)) {
      line.points.push_back(on_page(point.position_m));
    }
    panel.lines.push_back(std::move(line));
  }
  render::FigureDots nodes{{}, FigureColour::kBlue, 5.0};
  for (const voronoi::DiagramNode& node : diagram.nodes) {
    nodes.points.push_back(on_page(node.position_m));
  }
  panel.dots.push_back(std::move(nodes));
}

void add_map(FigurePanel& panel, const topomap::LocalMap& map, const Pose2& T_page_robot,
             FigureColour colour) {
  for (const topomap::LocalBranch& branch : map.branches) {
    render::FigureLine line{{}, colour, branch.in_main_graph ? 2.0 : 0.8};
    line.dashed = branch.is_virtual;
    for (const topomap::BranchPoint& point : branch.points) {
      line.points.push_back(on_page(T_page_robot * point.position_m));
    }
    panel.lines.push_back(std::move(line));
  }
  for (const topomap::LocalNode& node : map.nodes) {
    render::FigureDots dots = node_dots(node.kind, colour);
    dots.points.push_back(on_page(T_page_robot * node.position_m));
    panel.dots.push_back(std::move(dots));
  }
}

void add_map(FigurePanel& panel, const topomap::GlobalMap& map, FigureColour colour) {
  for (const topomap::MapBranch& branch : map.branches) {
    render::FigureLine line{{}, branch.is_virtual ? FigureColour::kOrange : colour, 2.0};
    line.dashed = branch.is_virtual;
    for (const topomap::BranchPoint& point : branch.points) {
      line.points.push_back(on_page(point.position_m));
    }
    panel.lines.push_back(std::move(line));
  }
  for (const topomap::MapNode& node : map.nodes) {
    render::FigureDots dots = node_dots(node.kind, colour);
    dots.points.push_back(on_page(node.position_m));
    panel.dots.push_back(std::move(dots));
  }
}

void add_points(FigurePanel& panel, const topomap::LocalMap& map, const Pose2& T_page_robot,
                FigureColour colour, double radius_px) {
  render::FigureDots dots{{}, colour, radius_px};
  for (const topomap::ScanPoint& point : map.points) {
    dots.points.push_back(on_page(T_page_robot * Eigen::Vector2d(point.x_m, point.y_m)));
  }
  panel.dots.push_back(std::move(dots));
}

void add_rectangle(FigurePanel& panel, const topomap::VisibleRectangle& rectangle,
                   FigureColour colour, bool dashed) {
  render::FigureLine line{
      {on_page(rectangle.low_m), on_page({rectangle.high_m.x(), rectangle.low_m.y()}),
       on_page(rectangle.high_m), on_page({rectangle.low_m.x(), rectangle.high_m.y()})},
      colour,
      1.25};
  line.dashed = dashed;
  line.closed = true;
  panel.lines.push_back(std::move(line));
}

void add_path(FigurePanel& panel, const std::vector<Pose2>& poses, FigureColour colour, bool dashed,
              double dot_px) {
  render::FigureLine line{{}, colour, 1.25};
  line.dashed = dashed;
  render::FigureDots dots{{}, colour, dot_px};
  for (const Pose2& pose : poses) {
    line.points.push_back(on_page(pose.position_m()));
    dots.points.push_back(line.points.back());
  }
  panel.lines.push_back(std::move(line));
  panel.dots.push_back(std::move(dots));
}

}  // namespace topogeo::reproduce
