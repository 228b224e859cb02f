// Thesis, chapter 5: the local topo-geometric map of one scan.
#include <algorithm>
#include <cmath>

#include "topogeo/topomap/thesis_local_map.hpp"
#include "topogeo/voronoi/thesis_voronoi.hpp"

#include "reproduce/drawing.hpp"
#include "reproduce/experiment.hpp"
#include "reproduce/scenes.hpp"

namespace topogeo::reproduce {
namespace {

using render::Figure;
using render::FigureColour;
using render::FigurePanel;
using topomap::LocalBranch;
using topomap::LocalMapConfig;
using topomap::LocalNode;
using topomap::NodeKind;

SeenScene scene5(const std::string& number, const LocalMapConfig& config) {
  return see_scene(number, voronoi::thesis_voronoi(), config);
}

LocalMapConfig without_states() {
  LocalMapConfig config = topomap::thesis_local_map();
  config.find_states = false;
  return config;
}

double number_of(std::size_t n) {
  return static_cast<double>(n);
}

FigurePanel map_panel(const SeenScene& seen, const std::string& title) {
  FigurePanel panel;
  panel.title = title;
  add_walls(panel, seen.world, seen.T_world_laser);
  add_points(panel, seen.map, {}, FigureColour::kGrey, 1.5);
  add_map(panel, seen.map, {}, FigureColour::kBlue);
  add_robot(panel, {});
  panel.extent = {{-4.3, -0.5}, {4.3, 4.5}};
  return panel;
}

FigurePanel seen_panel(const SeenScene& seen, const std::string& title) {
  FigurePanel panel;
  panel.title = title;
  add_walls(panel, seen.world, seen.T_world_laser);
  add_groups(panel, seen.diagram.groups);
  add_diagram(panel, seen.diagram);
  add_robot(panel, {});
  panel.extent = {{-4.3, -0.5}, {4.3, 4.5}};
  return panel;
}

/// Branches of the main graph between nodes of these kinds, in either order.
std::size_t count_branches(const topomap::LocalMap& map, NodeKind a, NodeKind b) {
  return static_cast<std::size_t>(
      std::ranges::count_if(map.branches, [&](const LocalBranch& branch) {
        const NodeKind from = map.nodes[branch.node_a].kind;
        const NodeKind to = map.nodes[branch.node_b].kind;
        return branch.in_main_graph && ((from == a && to == b) || (from == b && to == a));
      }));
}

std::size_t count_off_main(const topomap::LocalMap& map) {
  return static_cast<std::size_t>(
      std::ranges::count(map.branches, false, &LocalBranch::in_main_graph));
}

/// The one node of that kind; throws std::out_of_range without one.
const LocalNode& node_of(const topomap::LocalMap& map, NodeKind kind) {
  const auto at = std::ranges::find(map.nodes, kind, &LocalNode::kind);
  if (at == map.nodes.end()) throw std::out_of_range("the map has no such node");
  return *at;
}

/// Clearance along the branches on both sides of a node, or of the longest branch.
FigurePanel clearance_panel(const topomap::LocalMap& map, const LocalNode* state) {
  FigurePanel panel;
  panel.title = "clearance along the branch";
  panel.across = "along the branch (m)";
  panel.up = "clearance (m)";
  panel.equal_scale = false;
  for (const LocalBranch& branch : map.branches) {
    const bool from = state != nullptr && branch.node_a == state->id;
    const bool to = state != nullptr && branch.node_b == state->id;
    if (!from && !to) continue;
    std::vector<topomap::BranchPoint> points = branch.points;
    if (to) std::ranges::reverse(points);
    const double side = panel.lines.empty() ? 1.0 : -1.0;
    render::FigureLine line{{}, FigureColour::kGreen, 2.0};
    double along_m = 0.0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (i > 0) along_m += (points[i].position_m - points[i - 1].position_m).norm();
      line.points.emplace_back(side * along_m, points[i].clearance_m);
    }
    panel.lines.push_back(std::move(line));
  }
  if (state != nullptr) {
    panel.dots.push_back({{{0.0, state->clearance_m}}, FigureColour::kOrange, 5.0});
  }
  return panel;
}

void figure_5_1(Report& report) {
  const SeenScene seen = scene5("5_01", without_states());
  report.draw({.title = "Nodes that share two groups are joined by a branch",
               .panels = {seen_panel(seen, "groups and diagram"), map_panel(seen, "local map")}},
              "Real nodes filled, fictitious ones open.");
  report.printed("groups", number_of(seen.diagram.groups.groups.size()), 4);
  report.printed("real nodes", number_of(count_nodes(seen.map, NodeKind::kReal)), 2);
  report.printed("branches", number_of(seen.map.branches.size()), 4);
  report.printed("branches between real nodes",
                 number_of(count_branches(seen.map, NodeKind::kReal, NodeKind::kReal)), 1);
  report.printed("branches from a real to a fictitious node",
                 number_of(count_branches(seen.map, NodeKind::kReal, NodeKind::kFictitious)), 3);
}

void figure_5_2(Report& report) {
  const SeenScene kept = scene5("5_02", without_states());
  LocalMapConfig removing = without_states();
  removing.remove_off_main_graph = true;
  const SeenScene removed = scene5("5_02", removing);
  Figure figure;
  figure.title = "From readings to the local map";
  figure.columns = 3;
  figure.panels = {polar_panel(kept.scan, 4.0, "readings"), seen_panel(kept, "groups and diagram"),
                   map_panel(kept, "local map, what is off the main graph thin"),
                   map_panel(removed, "what is off it removed")};
  report.draw(figure);
  report.printed("groups", number_of(kept.diagram.groups.groups.size()), 5);
  report.printed("nodes of the diagram", number_of(kept.diagram.nodes.size()), 1);
  report.printed("branches from the node",
                 number_of(count_branches(kept.map, NodeKind::kReal, NodeKind::kFictitious)), 4);
  report.printed("branches off the main graph", number_of(count_off_main(kept.map)), 1);
  report.printed("branches left when it is removed", number_of(removed.map.branches.size()), 4);
}

void figure_5_3(Report& report) {
  const SeenScene seen = scene5("5_05", topomap::thesis_local_map());
  const LocalNode& door = node_of(seen.map, NodeKind::kDoor);
  const FigurePanel panel = clearance_panel(seen.map, &door);
  report.draw(
      {.title = "Where the slope of the clearance changes its sign (5.1)", .panels = {panel}},
      "Orange: the new state.");
  double least_m = door.clearance_m;
  for (const render::FigureLine& line : panel.lines) {
    for (const Eigen::Vector2d& point : line.points) least_m = std::min(least_m, point.y());
  }
  report.states("clearance falls and rises again", panel.lines.size() == 2);
  report.worked_out("state above the least clearance", door.clearance_m - least_m, 0.0, "m", 0.01);
}

/// Figures 5.4 and 5.5: one state of this kind at the place given by the scene.
void draw_state(Report& report, const std::string& number, NodeKind kind,
                const Eigen::Vector2d& expected_m, double tolerance_m) {
  const SeenScene without = scene5(number, without_states());
  const SeenScene with = scene5(number, topomap::thesis_local_map());
  const LocalNode& state = node_of(with.map, kind);
  Figure figure;
  figure.title = "A state by the clearance along a branch";
  figure.panels = {clearance_panel(with.map, &state), map_panel(without, "by the diagram alone"),
                   map_panel(with, "with the new state")};
  report.draw(figure, "The state is orange.");
  report.printed("new states", number_of(count_nodes(with.map, kind)), 1);
  report.printed("states of the diagram alone", number_of(count_nodes(without.map, kind)), 0);
  report.worked_out("state to where the scene has it", (state.position_m - expected_m).norm(), 0.0,
                    "m", tolerance_m);
}

void figure_5_4(Report& report) {
  draw_state(report, "5_04", NodeKind::kHallCorridor, {1.5, 0.1}, 0.02);
}

void figure_5_5(Report& report) {
  draw_state(report, "5_05", NodeKind::kDoor, {1.05, 1.1}, 0.05);
}

LocalMapConfig uncut() {
  LocalMapConfig config = without_states();
  config.separated_m = 2.0;
  return config;
}

/// Largest step between successive points of the branches of the main graph.
double largest_step_m(const topomap::LocalMap& map) {
  double largest_m = 0.0;
  for (const LocalBranch& branch : map.branches) {
    if (!branch.in_main_graph) continue;
    for (std::size_t i = 1; i < branch.points.size(); ++i) {
      largest_m = std::max(largest_m,
                           (branch.points[i].position_m - branch.points[i - 1].position_m).norm());
    }
  }
  return largest_m;
}

void figure_5_6(Report& report) {
  const SeenScene before = scene5("5_07", uncut());
  const SeenScene after = scene5("5_07", without_states());
  report.draw({.title = "Far points of a branch (5.5)",
               .panels = {map_panel(before, "all points"), map_panel(after, "without far points")}},
              "What is cut off the main graph is thin.");
  report.states("without the cut far points belong to the main graph",
                count_off_main(before.map) == 0);
  report.states("with it they do not", count_off_main(after.map) > 0);
  report.at_most("largest step along branches after the cut", largest_step_m(after.map), 0.5, "m");
}

void figure_5_7(Report& report) {
  const SeenScene cut = scene5("5_07", without_states());
  const SeenScene with = scene5("5_07", topomap::thesis_local_map());
  const LocalNode& state = node_of(with.map, NodeKind::kNarrowing);
  report.draw({.title = "A corridor between two doors, one of them open into it",
               .panels = {map_panel(cut, "without far points"), map_panel(with, "with the state"),
                          clearance_panel(with.map, &state)}},
              "The narrowing is orange.");
  report.printed("narrowings", number_of(count_nodes(with.map, NodeKind::kNarrowing)), 1);
  report.printed("stretches of branches cut off", number_of(count_off_main(cut.map)), 1);
  report.worked_out("narrowing to where the scene has it",
                    (state.position_m - Eigen::Vector2d(1.6, -0.125)).norm(), 0.0, "m", 0.05);
}

}  // namespace

std::vector<Experiment> chapter5() {
  const std::string kThesis = "Thesis";
  return {
      {"figure-5.1", kThesis, "Figure 5.1",
       "Nodes and branches of a corridor with an open door: a branch joins nodes that share two "
       "groups",
       figure_5_1},
      {"figure-5.2", kThesis, "Figure 5.2",
       "A crossing from the readings to the map of states; the isolated branch goes", figure_5_2},
      {"figure-5.3", kThesis, "Figure 5.3",
       "Clearance of the points of a branch, with the change of slope that is a state", figure_5_3},
      {"figure-5.4", kThesis, "Figure 5.4",
       "From a hall into a corridor: the state where the clearance stops falling", figure_5_4},
      {"figure-5.5", kThesis, "Figure 5.5",
       "A door in a corridor: the state at the least clearance", figure_5_5},
      {"figure-5.6", kThesis, "Figure 5.6", "Points of a branch beyond a gap are cut off",
       figure_5_6},
      {"figure-5.7", kThesis, "Figure 5.7",
       "Two doors and a narrowing: far points cut off, then the state of the narrowing",
       figure_5_7},
  };
}

}  // namespace topogeo::reproduce
