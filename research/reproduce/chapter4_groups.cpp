// Thesis, 4.2.1: the groups of a scan, with and without each rule.
#include <algorithm>
#include <cmath>
#include <limits>

#include "topogeo/support/format.hpp"
#include "topogeo/topomap/thesis_local_map.hpp"
#include "topogeo/voronoi/thesis_voronoi.hpp"

#include "reproduce/chapter4.hpp"
#include "reproduce/drawing.hpp"

namespace topogeo::reproduce {

SeenScene scene4(const std::string& number, const voronoi::VoronoiConfig& config,
                 std::size_t place) {
  return see_scene(number, config, topomap::thesis_local_map(), place);
}

render::FigurePanel groups_panel(const SeenScene& seen, const std::string& title) {
  render::FigurePanel panel;
  panel.title = title;
  add_walls(panel, seen.world, seen.T_world_laser);
  add_groups(panel, seen.diagram.groups);
  add_robot(panel, {});
  panel.extent = {{-4.3, -0.5}, {4.3, 4.5}};
  return panel;
}

render::FigurePanel diagram_panel(const SeenScene& seen, const std::string& title) {
  render::FigurePanel panel = groups_panel(seen, title);
  add_diagram(panel, seen.diagram);
  return panel;
}

namespace {

using render::Figure;
using render::FigureColour;
using render::FigurePanel;
using voronoi::VoronoiConfig;

double count(std::size_t n) {
  return static_cast<double>(n);
}

/// Panels of a figure that explains one rule: the readings, then groups and diagram without and
/// with the rule.
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
    report.worked_out(name + ": branch off the line ahead", off_m, 0.0, "m");
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
                    "m");
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

/// Draws the area that a corner hides: seen from the robot, the walls turn away at the near point
/// of a range jump, and the next wall begins at the far point. The walls of these scenes are
/// parallel to the axes of the robot.
void add_hidden(FigurePanel& panel, const SeenScene& seen) {
  const auto& groups = seen.diagram.groups;
  for (std::size_t g = 1; g < groups.groups.size(); ++g) {
    const voronoi::GroupPoint& last = groups.points[groups.groups[g - 1].end - 1];
    const voronoi::GroupPoint& first = groups.points[groups.groups[g].begin];
    const bool on_one_side = last.position_m.y() * first.position_m.y() > 0.0F;
    const bool right = last.position_m.y() < 0.0F;
    if (!on_one_side || right != (last.range_m < first.range_m)) continue;
    const voronoi::GroupPoint& near = right ? last : first;
    const voronoi::GroupPoint& far = right ? first : last;
    auto corner_m = near.position_m;
    corner_m.y() = far.position_m.y();
    render::FigureLine area{{on_page(near.position_m), on_page(far.position_m), on_page(corner_m)},
                            FigureColour::kSky};
    area.filled = true;
    panel.lines.push_back(std::move(area));
  }
}

void figure_4_13(Report& report) {
  const SeenScene seen = scene4("4_15", without_hidden_zones());
  FigurePanel panel = groups_panel(seen, "behind the corner");
  add_hidden(panel, seen);
  report.draw({.title = "What a corner hides", .panels = {panel}}, "The hidden area is sky blue.");
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
  report.draw(figure, "Groups without the rule, hidden areas sky blue.");
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

}  // namespace

std::vector<Experiment> chapter4_groups() {
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
  };
}

}  // namespace topogeo::reproduce
