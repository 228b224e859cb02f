// Thesis, chapter 4: the local Voronoi diagram of one scan.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "topogeo/support/cpu_time.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/topomap/thesis_local_map.hpp"
#include "topogeo/voronoi/distance_error.hpp"
#include "topogeo/voronoi/thesis_voronoi.hpp"

#include "reproduce/drawing.hpp"
#include "reproduce/experiment.hpp"
#include "reproduce/scenes.hpp"

namespace topogeo::reproduce {
namespace {

using render::Figure;
using render::FigureColour;
using render::FigurePanel;
using voronoi::VoronoiConfig;

SeenScene scene4(const std::string& number, const VoronoiConfig& config, std::size_t place = 0) {
  return see_scene(number, config, topomap::thesis_local_map(), place);
}

double count(std::size_t n) {
  return static_cast<double>(n);
}

FigurePanel groups_panel(const SeenScene& seen, const std::string& title) {
  FigurePanel panel;
  panel.title = title;
  add_walls(panel, seen.world, seen.T_world_laser);
  add_groups(panel, seen.diagram.groups);
  add_robot(panel, {});
  panel.extent = {{-4.3, -0.5}, {4.3, 4.5}};
  return panel;
}

FigurePanel diagram_panel(const SeenScene& seen, const std::string& title) {
  FigurePanel panel = groups_panel(seen, title);
  add_diagram(panel, seen.diagram);
  return panel;
}

/// Panels of a figure that explains one rule: the readings, then groups and diagram without and
/// with it.
void draw_rule(Report& report, const SeenScene& without, const SeenScene& with,
               const std::string& rule) {
  Figure figure;
  figure.title = rule + ": without and with the rule";
  figure.columns = 3;
  figure.panels = {polar_panel(with.scan, 4.0, "readings"), groups_panel(without, "groups without"),
                   diagram_panel(without, "diagram without"), groups_panel(with, "groups with"),
                   diagram_panel(with, "diagram with")};
  report.draw(figure, "Walls grey, groups numbered; branches green, nodes blue.");
}

struct Counted {
  std::size_t groups = 0;
  std::size_t nodes = 0;
  std::size_t branches = 0;
};

Counted counted(const SeenScene& seen) {
  return {seen.diagram.groups.groups.size(), seen.diagram.nodes.size(),
          seen.diagram.branches.size()};
}

void compare(Report& report, const std::string& name, const Counted& seen, const Counted& expected,
             bool groups_printed) {
  (groups_printed
       ? report.printed(name + ": groups", count(seen.groups), count(expected.groups))
       : report.worked_out(name + ": groups", count(seen.groups), count(expected.groups)));
  report.worked_out(name + ": nodes", count(seen.nodes), count(expected.nodes));
  report.worked_out(name + ": branches", count(seen.branches), count(expected.branches));
}

void figure_4_7(Report& report) {
  Figure figure;
  figure.title = "Virtual groups where fewer than two objects are in sight";
  for (const bool one : {false, true}) {
    const SeenScene seen = scene4(one ? "4_07b" : "4_07a", voronoi::thesis_voronoi());
    const std::string name = one ? "one object" : "no object";
    FigurePanel panel = diagram_panel(seen, name);
    panel.extent = {{-4.3, -0.5}, {4.3, 4.5}};
    figure.panels.push_back(panel);
    report.states(name + ": the diagram is virtual", seen.diagram.is_virtual);
    report.printed(name + ": groups", count(seen.diagram.groups.groups.size()), 2);
    report.worked_out(name + ": branches", count(seen.diagram.branches.size()), 1);
    double off_m = 0.0;
    for (const voronoi::DiagramPoint& point : seen.diagram.points) {
      off_m = std::max(off_m, std::fabs(point.position_m.y()));
    }
    report.worked_out(name + ": branch off the line ahead", off_m, 0.0, "m", 0.025);
  }
  report.draw(figure, "Groups numbered, the virtual branch dashed.");
}

void figure_4_8(Report& report) {
  VoronoiConfig off = voronoi::thesis_splitting_alone();
  off.split_discontinuities = false;
  const SeenScene without = scene4("4_08", off);
  const SeenScene with = scene4("4_08", voronoi::thesis_splitting_alone());
  draw_rule(report, without, with, "Split at discontinuities (4.7)");
  compare(report, "with", counted(with), {4, 1, 4}, true);
  compare(report, "without", counted(without), {2, 0, 1}, false);
  report.worked_out("node to the middle of the crossing",
                    (with.diagram.nodes.at(0).position_m - Eigen::Vector2d(2.0, 0.1)).norm(), 0.0,
                    "m", 0.03);
}

/// The nearest points of two groups.
struct GroupGap {
  Eigen::Vector2d a_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d b_m = Eigen::Vector2d::Zero();
  double distance_m = std::numeric_limits<double>::infinity();
};

GroupGap gap_between(const voronoi::GeneratorGroups& groups, std::size_t a, std::size_t b) {
  GroupGap gap;
  for (std::uint32_t i = groups.groups[a].begin; i < groups.groups[a].end; ++i) {
    for (std::uint32_t j = groups.groups[b].begin; j < groups.groups[b].end; ++j) {
      const double distance_m = (groups.points[i].position_m - groups.points[j].position_m).norm();
      if (distance_m < gap.distance_m) {
        gap = {groups.points[i].position_m, groups.points[j].position_m, distance_m};
      }
    }
  }
  return gap;
}

void figure_4_9(Report& report) {
  const SeenScene seen = scene4("4_10", voronoi::thesis_splitting_alone());
  FigurePanel panel = groups_panel(seen, "least distance of neighbours");
  std::size_t narrow = 0;
  const auto& groups = seen.diagram.groups;
  for (std::size_t g = 1; g < groups.groups.size(); ++g) {
    const GroupGap gap = gap_between(groups, g - 1, g);
    const bool joined = gap.distance_m < voronoi::thesis_voronoi().contiguous_m;
    narrow += joined ? 1 : 0;
    panel.lines.push_back({{on_page(gap.a_m), on_page(gap.b_m)},
                           joined ? FigureColour::kRed : FigureColour::kBlack,
                           1.5});
    panel.texts.push_back(
        {on_page(0.5 * (gap.a_m + gap.b_m)), fmt::format("{:.2f} m", gap.distance_m)});
  }
  report.draw({.title = "Distance between groups", .panels = {panel}},
              "Red: nearer than the threshold of 0.55 m.");
  report.worked_out("pairs of neighbours below the threshold", count(narrow), 1);
}

void figure_4_10(Report& report) {
  VoronoiConfig config = voronoi::thesis_splitting_alone();
  const SeenScene without = scene4("4_10", config);
  config.join_contiguous = true;
  const SeenScene with = scene4("4_10", config);
  draw_rule(report, without, with, "Join contiguous groups (4.8)");
  compare(report, "without", counted(without), {6, 2, 7}, true);
  compare(report, "with", counted(with), {5, 2, 6}, true);
}

void figure_4_11(Report& report) {
  VoronoiConfig config = voronoi::thesis_splitting_alone();
  config.join_contiguous = true;
  const SeenScene without = scene4("4_11", config);
  config.join_alternate = true;
  const SeenScene with = scene4("4_11", config);
  draw_rule(report, without, with, "Join alternate groups (4.9)");
  compare(report, "without", counted(without), {6, 3, 7}, true);
  compare(report, "with", counted(with), {4, 1, 4}, false);
  report.states("there are fewer groups with the rule",
                with.diagram.groups.groups.size() < without.diagram.groups.groups.size());
}

std::uint32_t smallest_group(const SeenScene& seen) {
  std::uint32_t smallest = std::numeric_limits<std::uint32_t>::max();
  for (const voronoi::PointRun& run : seen.diagram.groups.groups) {
    smallest = std::min(smallest, run.size());
  }
  return smallest;
}

void figure_4_12(Report& report) {
  VoronoiConfig config = voronoi::thesis_splitting_alone();
  const SeenScene without = scene4("4_12", config);
  config.drop_small = true;
  config.min_group_points = 1;
  const SeenScene with = scene4("4_12", config);
  draw_rule(report, without, with, "Drop small groups (4.10)");
  report.printed("without: readings of the smallest group", smallest_group(without), 1);
  compare(report, "without", counted(without), {4, 2, 5}, false);
  compare(report, "with", counted(with), {3, 1, 3}, false);
}

VoronoiConfig without_hidden_zones() {
  VoronoiConfig config = voronoi::thesis_voronoi();
  config.join_hidden_zones = false;
  return config;
}

/// Draws what lies behind the jumps of range between neighbouring groups.
void add_hidden(FigurePanel& panel, const SeenScene& seen) {
  const auto& groups = seen.diagram.groups;
  for (std::size_t g = 1; g < groups.groups.size(); ++g) {
    const voronoi::GroupPoint& last = groups.points[groups.groups[g - 1].end - 1];
    const voronoi::GroupPoint& first = groups.points[groups.groups[g].begin];
    const voronoi::GroupPoint& near = last.range_m < first.range_m ? last : first;
    const voronoi::GroupPoint& far = last.range_m < first.range_m ? first : last;
    const double stretch = 4.0 / near.range_m;
    render::FigureLine area{
        {on_page(near.position_m), on_page(stretch * near.position_m), on_page(far.position_m)},
        FigureColour::kPaleGrey};
    area.filled = true;
    panel.lines.push_back(std::move(area));
  }
}

void figure_4_13(Report& report) {
  const SeenScene seen = scene4("4_15", without_hidden_zones());
  FigurePanel panel = groups_panel(seen, "behind the corner");
  add_hidden(panel, seen);
  report.draw({.title = "What a corner hides", .panels = {panel}}, "Hidden areas are pale.");
  const auto& groups = seen.diagram.groups;
  double jump_m = 0.0;
  for (std::size_t g = 1; g < groups.groups.size(); ++g) {
    jump_m = std::max(jump_m,
                      std::fabs(static_cast<double>(groups.points[groups.groups[g].begin].range_m) -
                                groups.points[groups.groups[g - 1].end - 1].range_m));
  }
  report.states("successive beams jump in range at the corner",
                jump_m > voronoi::thesis_voronoi().discontinuity_m);
  report.show("largest jump", jump_m, "m");
}

void figure_4_14(Report& report) {
  Figure figure;
  figure.title = "Hidden zones to the right (4.11) and to the left (4.12)";
  for (const bool left : {false, true}) {
    const std::string number = left ? "4_14b" : "4_14a";
    const SeenScene without = scene4(number, without_hidden_zones());
    const SeenScene with = scene4(number, voronoi::thesis_voronoi());
    const std::string side = left ? "left" : "right";
    FigurePanel panel = groups_panel(without, side);
    add_hidden(panel, without);
    figure.panels.push_back(panel);
    report.states(side + ": the rule joins the walls of the corner",
                  with.diagram.groups.groups.size() < without.diagram.groups.groups.size());
    report.show(side + ": groups without", count(without.diagram.groups.groups.size()));
    report.show(side + ": groups with", count(with.diagram.groups.groups.size()));
  }
  report.draw(figure, "Groups without the rule, hidden areas pale.");
}

void figure_4_15(Report& report) {
  const SeenScene without = scene4("4_15", without_hidden_zones());
  const SeenScene with = scene4("4_15", voronoi::thesis_voronoi());
  draw_rule(report, without, with, "Join across hidden zones (4.11, 4.12)");
  compare(report, "without", counted(without), {3, 1, 3}, false);
  compare(report, "with", counted(with), {2, 0, 1}, false);
  report.states("the branch at the corner goes",
                with.diagram.branches.size() < without.diagram.branches.size());
}

void figure_4_16(Report& report) {
  const SeenScene without = scene4("4_16", without_hidden_zones());
  const SeenScene with = scene4("4_16", voronoi::thesis_voronoi());
  const SeenScene nearer = scene4("4_16", voronoi::thesis_voronoi(), 1);
  draw_rule(report, without, with, "Openings lost from afar");
  report.draw({.title = "The same crossing, one metre on",
               .panels = {groups_panel(nearer, "groups"), diagram_panel(nearer, "diagram")}},
              "With the rule.", "nearer");
  compare(report, "without", counted(without), {4, 1, 4}, false);
  compare(report, "with", counted(with), {2, 0, 1}, false);
  compare(report, "with, nearer", counted(nearer), {4, 1, 4}, false);
  report.states("near by the openings are seen", nearer.diagram.branches.size() == 4);
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
                      count(seen.diagram.nodes.size()), 1);
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
    // Group 1 is the whole wall to the right: the perpendicular to it.
    if (g == 0) off_m = std::fabs((nearest_m - cell_m).norm() - (cell_m.y() + 0.9));
  }
  report.draw({.title = "Distance of a cell to groups (4.16)", .panels = {panel}});
  report.worked_out("distance to the wall, off its perpendicular", off_m, 0.0, "m", 0.01);
}

// The print cuts digits off where it should round.
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
                   row.error_cm, "cm", 0.0075);
    report.printed(fmt::format("2 E_max of cells of {} cm", row.resolution_cm), 2.0 * error_cm,
                   row.twice_cm, "cm", 0.0075);
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
  report.printed("groups", count(seen.diagram.groups.groups.size()), 3);
  report.printed("nodes", count(seen.diagram.nodes.size()), 1);
  report.printed("branches", count(seen.diagram.branches.size()), 3);
  report.at_most("distances to base groups differ by (2 E_max)", unequal_m(seen),
                 2.0 * voronoi::largest_distance_error_m(0.05), "m");
}

}  // namespace

std::vector<Experiment> chapter4() {
  const std::string kThesis = "Thesis";
  return {
      {"figure-4.7", kThesis, "Figure 4.7",
       "Virtual groups: two where nothing is in range, one beside a lone wall", figure_4_7},
      {"figure-4.8", kThesis, "Figure 4.8",
       "A crossing of corridors: readings, groups by jumps of range, diagram", figure_4_8},
      {"figure-4.9", kThesis, "Figure 4.9", "Least distance between two groups", figure_4_9},
      {"figure-4.10", kThesis, "Figure 4.10",
       "A crossing with an open door: groups nearer than the robot is wide become one",
       figure_4_10},
      {"figure-4.11", kThesis, "Figure 4.11",
       "A corridor with a recess in its wall: groups on both sides of a slit become one",
       figure_4_11},
      {"figure-4.12", kThesis, "Figure 4.12",
       "From a corridor into a hall: a group of one reading distorts the diagram and goes",
       figure_4_12},
      {"figure-4.13", kThesis, "Figure 4.13", "The zone that a corner hides from the laser",
       figure_4_13},
      {"figure-4.14", kThesis, "Figure 4.14", "Hidden zones in the first and the second quadrant",
       figure_4_14},
      {"figure-4.15", kThesis, "Figure 4.15",
       "From a corridor into a hall: the false branch at a hidden corner goes", figure_4_15},
      {"figure-4.16", kThesis, "Figure 4.16",
       "A crossing seen from afar, where the rule of hidden zones loses the side corridors",
       figure_4_16},
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
