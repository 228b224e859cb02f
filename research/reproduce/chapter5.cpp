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

constexpr const char* kOwnRule = "our rule for states";

/// The printed rule: each confirmed change of slope is a state (5.1 to 5.4).
LocalMapConfig printed_states() {
  LocalMapConfig config = topomap::thesis_local_map();
  config.state_rule = topomap::StateRule::kSlopes;
  return config;
}

bool is_state(const LocalNode& node) {
  return node.kind == NodeKind::kDoor || node.kind == NodeKind::kNarrowing ||
         node.kind == NodeKind::kHallCorridor;
}

std::size_t count_states(const topomap::LocalMap& map) {
  return static_cast<std::size_t>(std::ranges::count_if(map.nodes, is_state));
}

/// The state nearest to a place; throws std::out_of_range without any.
const LocalNode& state_near(const topomap::LocalMap& map, const Eigen::Vector2d& place_m) {
  const LocalNode* nearest = nullptr;
  for (const LocalNode& node : map.nodes) {
    if (!is_state(node)) continue;
    if (nearest == nullptr ||
        (node.position_m - place_m).norm() < (nearest->position_m - place_m).norm()) {
      nearest = &node;
    }
  }
  if (nearest == nullptr) throw std::out_of_range("the map has no state");
  return *nearest;
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
  const Eigen::Vector2d door_m(1.05, 1.1);
  const SeenScene printed = scene5("5_05", printed_states());
  const SeenScene own = scene5("5_05", topomap::thesis_local_map());
  const LocalNode& state = state_near(printed.map, door_m);
  const LocalNode& own_state = state_near(own.map, door_m);
  FigurePanel by_print = clearance_panel(printed.map, &state);
  by_print.title = "by the printed rule, between the next states";
  FigurePanel by_own = clearance_panel(own.map, &own_state);
  by_own.title = "by our rule, along the whole branch";
  double least_m = own_state.clearance_m;
  for (const render::FigureLine& line : by_own.lines) {
    for (const Eigen::Vector2d& point : line.points) least_m = std::min(least_m, point.y());
  }
  report.draw({.title = "Where the slope of the clearance changes its sign (5.1)",
               .panels = {by_print, by_own}},
              "Orange: the new state.");
  report.states("clearance falls and rises again", by_own.lines.size() == 2);
  report.worked_out("state above the least clearance", state.clearance_m - least_m, 0.0, "m");
  report.beside("state above the least clearance", own_state.clearance_m - least_m, "m", kOwnRule);
}

/// States by the printed rule and, beside them, by our own.
void compare_states(Report& report, const SeenScene& printed, const SeenScene& own,
                    const Eigen::Vector2d& expected_m) {
  report.printed("new states", number_of(count_states(printed.map)), 1);
  report.show("of them doors", number_of(count_nodes(printed.map, NodeKind::kDoor)));
  report.show("of them narrowings", number_of(count_nodes(printed.map, NodeKind::kNarrowing)));
  report.show("of them passages between hall and corridor",
              number_of(count_nodes(printed.map, NodeKind::kHallCorridor)));
  report.worked_out("state to where the scene has it",
                    (state_near(printed.map, expected_m).position_m - expected_m).norm(), 0.0, "m");
  report.beside("new states", number_of(count_states(own.map)), "", kOwnRule);
  report.beside("state to where the scene has it",
                (state_near(own.map, expected_m).position_m - expected_m).norm(), "m", kOwnRule);
}

/// Figures 5.4 and 5.5: one state at the place given by the scene.
void draw_state(Report& report, const std::string& number, const Eigen::Vector2d& expected_m) {
  const SeenScene without = scene5(number, without_states());
  const SeenScene printed = scene5(number, printed_states());
  const SeenScene own = scene5(number, topomap::thesis_local_map());
  Figure figure;
  figure.title = "A state by the clearance along a branch";
  figure.columns = 2;
  figure.panels = {clearance_panel(own.map, &state_near(own.map, expected_m)),
                   map_panel(without, "by the diagram alone"),
                   map_panel(printed, "states by the printed rule"),
                   map_panel(own, "states by our rule")};
  report.draw(figure, "States are orange.");
  report.printed("states of the diagram alone", number_of(count_states(without.map)), 0);
  compare_states(report, printed, own, expected_m);
}

void figure_5_4(Report& report) {
  draw_state(report, "5_04", {1.5, 0.1});
}

void figure_5_5(Report& report) {
  draw_state(report, "5_05", {1.05, 1.1});
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
  const Eigen::Vector2d narrowing_m(1.6, -0.125);
  const SeenScene printed = scene5("5_07", printed_states());
  const SeenScene own = scene5("5_07", topomap::thesis_local_map());
  Figure figure;
  figure.title = "A corridor between two doors, one of them open into it";
  figure.columns = 2;
  figure.panels = {map_panel(cut, "without far points"),
                   map_panel(printed, "states by the printed rule"),
                   map_panel(own, "states by our rule"),
                   clearance_panel(own.map, &state_near(own.map, narrowing_m))};
  report.draw(figure, "States are orange.");
  report.printed("stretches of branches cut off", number_of(count_off_main(cut.map)), 1);
  compare_states(report, printed, own, narrowing_m);
}

}  // namespace

std::vector<Experiment> chapter5() {
  const std::string kThesis = "Thesis";
  const std::string kPrintedRule =
      "By 5.3 and 5.4 a single later point that lies far enough and on the same side confirms a "
      "change of slope, so steps between cells of the diagram make states even in an exact scan "
      "(docs/algorithms.md, Local topo-geometric map, errata)";
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
       "From a hall into a corridor: the state where the clearance stops falling", figure_5_4,
       kPrintedRule},
      {"figure-5.5", kThesis, "Figure 5.5",
       "A door in a corridor: the state at the least clearance", figure_5_5, kPrintedRule},
      {"figure-5.6", kThesis, "Figure 5.6", "Points of a branch beyond a gap are cut off",
       figure_5_6},
      {"figure-5.7", kThesis, "Figure 5.7",
       "Two doors and a narrowing: far points cut off, then the state of the narrowing", figure_5_7,
       kPrintedRule},
  };
}

}  // namespace topogeo::reproduce
