// Thesis, 4.2.2: the grid, distances of its cells, nodes and branches.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "topogeo/support/cpu_time.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/voronoi/distance_error.hpp"
#include "topogeo/voronoi/thesis_voronoi.hpp"

#include "reproduce/chapter4.hpp"
#include "reproduce/drawing.hpp"

namespace topogeo::reproduce {
namespace {

using render::Figure;
using render::FigureColour;
using render::FigurePanel;
using voronoi::VoronoiConfig;

double how_many(std::size_t n) {
  return static_cast<double>(n);
}

/// Side lengths of the grid, metres: across and ahead.
Eigen::Vector2d grid_size_m(const scan::Scan& scan, const VoronoiConfig& config) {
  voronoi::LocalVoronoi maker(config);
  static_cast<void>(maker.compute(scan));
  return {maker.grid().rows() * config.resolution_m, maker.grid().cols() * config.resolution_m};
}

void figure_4_17(Report& report) {
  const SeenScene seen = scene4("4_08", voronoi::thesis_voronoi());
  VoronoiConfig whole = voronoi::thesis_voronoi();
  whole.window_of_groups = false;
  const Eigen::Vector2d large_m = grid_size_m(seen.scan, whole);
  const Eigen::Vector2d small_m = grid_size_m(seen.scan, voronoi::thesis_voronoi());
  double x_max_m = 0.0;
  double y_max_m = 0.0;
  for (const voronoi::GroupPoint& point : seen.diagram.groups.points) {
    x_max_m = std::max(x_max_m, std::fabs(point.position_m.y()));
    y_max_m = std::max(y_max_m, point.position_m.x());
  }
  FigurePanel panel = groups_panel(seen, "grid of the range and of the groups");
  add_rectangle(panel, {{0.0, -4.0}, {4.0, 4.0}}, FigureColour::kGrey, true);
  add_rectangle(panel, {{0.0, -x_max_m}, {y_max_m, x_max_m}}, FigureColour::kBlue);
  report.draw({.title = "The grid, cut to the extent of the groups (4.14)", .panels = {panel}},
              "Dashed: of the range limit; blue: of the groups.");
  report.states("the grid becomes smaller", small_m.x() * small_m.y() < large_m.x() * large_m.y());
  report.show("cells of the range limit", std::round(large_m.x() * large_m.y() / (0.05 * 0.05)));
  report.show("cells of the groups", std::round(small_m.x() * small_m.y() / (0.05 * 0.05)));
}

double time_of_diagram_ms(const scan::Scan& scan, const VoronoiConfig& config) {
  constexpr int kRuns = 5;
  double best_ms = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kRuns; ++i) {
    const double start_s = support::monotonic_s();
    voronoi::LocalVoronoi maker(config);
    static_cast<void>(maker.compute(scan));
    best_ms = std::min(best_ms, 1e3 * (support::monotonic_s() - start_s));
  }
  return best_ms;
}

void figure_4_18(Report& report) {
  Figure figure;
  figure.title = "The same scan with two sizes of cells";
  std::array<double, 2> ms{};
  for (const bool coarse : {false, true}) {
    VoronoiConfig config = voronoi::thesis_splitting_alone();
    config.resolution_m = coarse ? 0.10 : 0.02;
    const SeenScene seen = scene4("4_08", config);
    const double time_ms = time_of_diagram_ms(seen.scan, config);
    ms[coarse ? 1 : 0] = time_ms;
    figure.panels.push_back(
        diagram_panel(seen, fmt::format("cells of {:.0f} cm", 100.0 * config.resolution_m)));
    report.at_most(fmt::format("time with cells of {:.0f} cm", 100.0 * config.resolution_m),
                   time_ms, coarse ? 57.0 : 1373.0, "ms");
    report.worked_out(fmt::format("nodes with cells of {:.0f} cm", 100.0 * config.resolution_m),
                      how_many(seen.diagram.nodes.size()), 1);
  }
  report.states("smaller cells take longer", ms[0] > ms[1]);
  report.draw(figure);
}

void figure_4_19(Report& report) {
  const SeenScene seen = scene4("4_20", voronoi::thesis_voronoi());
  const Eigen::Vector2d cell_m(1.975, -0.325);
  const auto& groups = seen.diagram.groups;
  FigurePanel panel = groups_panel(seen, "from one cell to each group");
  double off_m = 0.0;
  for (std::size_t g = 0; g < groups.groups.size(); ++g) {
    Eigen::Vector2d nearest_m = Eigen::Vector2d::Constant(1e3);
    for (std::uint32_t i = groups.groups[g].begin; i < groups.groups[g].end; ++i) {
      const Eigen::Vector2d& at_m = groups.points[i].position_m;
      if ((at_m - cell_m).norm() < (nearest_m - cell_m).norm()) nearest_m = at_m;
    }
    panel.lines.push_back({{on_page(cell_m), on_page(nearest_m)}, FigureColour::kBlack, 1.25});
    panel.texts.push_back({on_page(0.5 * (cell_m + nearest_m)),
                           fmt::format("{:.2f} m", (nearest_m - cell_m).norm())});
    // Group 1 is the whole wall to the right, so its nearest point is on the perpendicular.
    if (g == 0) off_m = std::fabs((nearest_m - cell_m).norm() - (cell_m.y() + 0.9));
  }
  report.draw({.title = "Distance of a cell to groups (4.16)", .panels = {panel}});
  report.worked_out("distance to the wall, off its perpendicular", off_m, 0.0, "m");
}

// The print truncates digits instead of rounding.
void table_4_1(Report& report) {
  struct Row {
    int resolution_cm;
    double error_cm;
    double twice_cm;
  };
  for (const Row& row : {Row{1, 0.71, 1.41}, Row{3, 2.12, 4.24}, Row{5, 3.53, 7.07},
                         Row{7, 4.95, 9.9}, Row{9, 6.36, 12.73}}) {
    const double error_cm = 100.0 * voronoi::largest_distance_error_m(0.01 * row.resolution_cm);
    report.printed(fmt::format("E_max of cells of {} cm", row.resolution_cm), error_cm,
                   row.error_cm, "cm");
    report.printed(fmt::format("2 E_max of cells of {} cm", row.resolution_cm), 2.0 * error_cm,
                   row.twice_cm, "cm");
  }
}

/// Largest difference between the clearance of points of a diagram and their distances to their
/// base groups.
double unequal_m(const SeenScene& seen) {
  double worst_m = 0.0;
  const auto& groups = seen.diagram.groups;
  const auto check = [&](const Eigen::Vector2d& at_m, double clearance_m, std::uint16_t group) {
    double nearest_m = std::numeric_limits<double>::infinity();
    for (std::uint32_t i = groups.groups[group].begin; i < groups.groups[group].end; ++i) {
      nearest_m = std::min(nearest_m, (groups.points[i].position_m - at_m).norm());
    }
    worst_m = std::max(worst_m, std::fabs(nearest_m - clearance_m));
  };
  for (const voronoi::DiagramNode& node : seen.diagram.nodes) {
    for (const std::uint16_t group : seen.diagram.groups_of(node)) {
      check(node.position_m, node.clearance_m, group);
    }
  }
  for (const voronoi::DiagramBranch& branch : seen.diagram.branches) {
    for (const voronoi::DiagramPoint& point : seen.diagram.points_of(branch)) {
      for (const std::uint16_t group : branch.base_groups) {
        check(point.position_m, point.clearance_m, group);
      }
    }
  }
  return worst_m;
}

void add_circle(FigurePanel& panel, const Eigen::Vector2d& centre_m, double radius_m) {
  render::FigureLine line{{}, FigureColour::kViolet, 1.0, true};
  for (int i = 0; i < 60; ++i) {
    const double angle_rad = 2.0 * std::numbers::pi * i / 60;
    line.points.push_back(
        on_page(centre_m + radius_m * Eigen::Vector2d(std::cos(angle_rad), std::sin(angle_rad))));
  }
  line.closed = true;
  panel.lines.push_back(std::move(line));
}

void figure_4_20(Report& report) {
  const SeenScene seen = scene4("4_20", voronoi::thesis_voronoi());
  FigurePanel at_node = diagram_panel(seen, "node and its distance to three groups");
  for (const voronoi::DiagramNode& node : seen.diagram.nodes) {
    add_circle(at_node, node.position_m, node.clearance_m);
  }
  FigurePanel at_branches = diagram_panel(seen, "a point of each branch, two groups");
  for (const voronoi::DiagramBranch& branch : seen.diagram.branches) {
    const auto points = seen.diagram.points_of(branch);
    const voronoi::DiagramPoint& middle = points[points.size() / 2];
    add_circle(at_branches, middle.position_m, middle.clearance_m);
  }
  report.draw({.title = "Nodes and branches are equally far from their base groups",
               .panels = {at_node, at_branches}},
              "Violet circles have the clearance as radius.");
  report.printed("groups", how_many(seen.diagram.groups.groups.size()), 3);
  report.printed("nodes", how_many(seen.diagram.nodes.size()), 1);
  report.printed("branches", how_many(seen.diagram.branches.size()), 3);
  report.at_most("distances to base groups differ by (2 E_max)", unequal_m(seen),
                 2.0 * voronoi::largest_distance_error_m(0.05), "m");
}

}  // namespace

std::vector<Experiment> chapter4_grid() {
  const std::string kThesis = "Thesis";
  return {
      {"figure-4.17", kThesis, "Figure 4.17",
       "The grid over the visible region, and cut to what the groups span", figure_4_17},
      {"figure-4.18", kThesis, "Figure 4.18",
       "The diagram with cells of 2 and of 10 cm, and the time for each", figure_4_18},
      {"figure-4.19", kThesis, "Figure 4.19", "Distance from a cell to the groups", figure_4_19},
      {"table-4.1", kThesis, "Table 4.1", "Largest error of distances by the size of cells",
       table_4_1},
      {"figure-4.20", kThesis, "Figure 4.20",
       "The groups that a node and three branches are equally far from", figure_4_20},
  };
}

}  // namespace topogeo::reproduce
