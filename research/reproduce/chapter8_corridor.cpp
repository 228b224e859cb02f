// Thesis, 8.2: a corridor driven there and back.
#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>

#include "topogeo/support/format.hpp"

#include "reproduce/chapter8.hpp"
#include "reproduce/drawing.hpp"
#include "reproduce/shared_runs.hpp"

namespace topogeo::reproduce {
namespace {

using geometry::Pose2;
using render::FigureColour;
using render::FigurePanel;
using topomap::NodeKind;

constexpr const char* kCorridor = "corridor";
constexpr const char* kProductCorridor = "corridor, 10 m";

/// The stop at which the robot is farthest down the corridor.
std::size_t end_of_corridor(const Drive& drive) {
  const auto at = std::ranges::max_element(drive.truth, {}, &Pose2::x_m);
  return static_cast<std::size_t>(at - drive.truth.begin());
}

void figure_8_4(Report& report) {
  report.made_by(means_of(report.runs().drive(kCorridor)));
  report.draw({.title = "Readings where odometry has the robot",
               .panels = {readings_panel(report.runs().drive(kCorridor), "by odometry", false),
                          readings_panel(report.runs().drive(kCorridor), "in truth", true)}});
  const Drive& drive = report.runs().drive(kCorridor);
  const PoseErrors errors = pose_errors(drive.odometry, drive.truth);
  report.show("stops", static_cast<double>(drive.stops.size()));
  report.show("largest error by odometry", errors.largest_m, "m");
  report.states("by odometry the map is distorted (more than 1 m)", errors.largest_m > 1.0);
}

void figure_8_5(Report& report) {
  const Drive& drive = report.runs().drive(kCorridor);
  report.made_by(means_of(drive));
  report.draw({.title = "Local maps where odometry has the robot",
               .panels = {maps_panel(drive, drive.odometry, drive.stops.size(), "by odometry"),
                          maps_panel(drive, drive.truth, drive.stops.size(), "in truth")}});
  const PoseErrors errors = pose_errors(drive.odometry, drive.truth);
  report.states("local maps of one place lie apart (more than 1 m)", errors.last_m > 1.0);
  report.show("last position off by odometry", errors.last_m, "m");
}

void figure_8_6(Report& report) {
  const Drive& drive = report.runs().drive(kCorridor);
  const Correction& correction = report.runs().correction(kCorridor, kForwardAlone);
  report.made_by(means_of(drive, correction));
  const std::size_t end = end_of_corridor(drive);
  const topomap::GlobalMap map = fused(drive, correction.final_poses(), end + 1);
  FigurePanel panel;
  panel.title = "global map at the end of the corridor";
  add_walls(panel, drive.world, drive.T_world_first);
  add_map(panel, map, FigureColour::kGreen);
  report.draw({.title = "The corridor driven once", .panels = {panel}});
  const auto kinds = [&](NodeKind kind) {
    return static_cast<double>(std::ranges::count(map.nodes, kind, &topomap::MapNode::kind));
  };
  report.states("the map has nodes of doors", kinds(NodeKind::kDoor) > 0);
  report.states("the map has crossings", kinds(NodeKind::kReal) > 0);
  report.show("doors", kinds(NodeKind::kDoor));
  report.show("crossings", kinds(NodeKind::kReal));
  report.show("narrowings", kinds(NodeKind::kNarrowing));
  report.show("passages between hall and corridor", kinds(NodeKind::kHallCorridor));
  const std::vector<Pose2> driven(
      correction.final_poses().begin(),
      correction.final_poses().begin() + static_cast<std::ptrdiff_t>(end) + 1);
  report.show("mean error of positions", pose_errors(driven, drive.truth).mean_m, "m");
  report.show("the same by odometry",
              pose_errors({drive.odometry.begin(),
                           drive.odometry.begin() + static_cast<std::ptrdiff_t>(end) + 1},
                          drive.truth)
                  .mean_m,
              "m");
}

void figure_8_7(Report& report) {
  const Drive& drive = report.runs().drive(kCorridor);
  const Correction& correction = report.runs().correction(kCorridor);
  report.made_by(means_of(drive, correction));
  render::Figure figure;
  figure.title = "Solutions of backward corrections on the way back";
  figure.columns = 4;
  const std::size_t end = end_of_corridor(drive);
  std::size_t most = 0;
  std::size_t without = 0;
  for (std::size_t k = end + 1; k < drive.stops.size(); ++k) {
    const auto& solutions = correction.kept[k];
    most = std::max(most, solutions.size());
    if (solutions.empty()) ++without;
    if (solutions.empty() || figure.panels.size() == 8) continue;
    FigurePanel panel;
    panel.title = fmt::format("position {}: {} solution{}", k + 1, solutions.size(),
                              solutions.size() == 1 ? "" : "s");
    for (std::size_t p = 0; p < solutions.size(); ++p) {
      add_path(panel, solutions[p], distinct_colour(p));
    }
    figure.panels.push_back(std::move(panel));
  }
  if (figure.panels.empty()) {
    FigurePanel panel;
    panel.title = "no cycle was closed: forward correction";
    add_path(panel, correction.final_poses(), FigureColour::kRed);
    figure.panels.push_back(std::move(panel));
  }
  report.draw(figure, "A colour for each solution.");
  report.states("there are several valid solutions", most > 1);
  report.printed("positions on the way back without a backward correction",
                 static_cast<double>(without), 0);
  report.show("positions on the way back", static_cast<double>(drive.stops.size() - end - 1));
  const PoseErrors errors = pose_errors(correction.final_poses(), drive.truth);
  report.show("mean error of all positions at the end", errors.mean_m, "m");
  report.states("positions end nearer to the truth than odometry",
                errors.mean_m < pose_errors(drive.odometry, drive.truth).mean_m);
  const Drive& farther = report.runs().drive(kProductCorridor);
  const Correction& product = report.runs().correction(kProductCorridor, kProduct);
  report.beside("mean error of all positions at the end",
                pose_errors(product.final_poses(), farther.truth).mean_m, "m",
                matcher_text(product.config) + ", 10 m");
}

/// Length of the branches of a global map, or of a local one at its pose, inside a rectangle of the
/// world, metres.
template <class Map>
double length_within(const Map& map, const Pose2& T_world_map, const Eigen::Vector2d& low,
                     const Eigen::Vector2d& high) {
  double length_m = 0.0;
  for (const auto& branch : map.branches) {
    for (std::size_t i = 1; i < branch.points.size(); ++i) {
      const Eigen::Vector2d at_m = T_world_map * branch.points[i].position_m;
      const bool inside =
          (at_m.array() >= low.array()).all() && (at_m.array() <= high.array()).all();
      if (!inside) continue;
      length_m += (branch.points[i].position_m - branch.points[i - 1].position_m).norm();
    }
  }
  return length_m;
}

/// A panel around a place of the world, with the scene at the time of a stop.
FigurePanel place_panel(const Drive& drive, std::size_t stop, const Eigen::Vector2d& at_m,
                        const std::string& title) {
  FigurePanel panel;
  panel.title = title;
  add_walls(panel, world::scene_at(drive.world, drive.path_m[stop]), drive.T_world_first);
  const Eigen::Vector2d page = on_page(geometry::inverse(drive.T_world_first) * at_m);
  panel.extent = {page - Eigen::Vector2d(4.0, 4.0), page + Eigen::Vector2d(4.0, 4.0)};
  return panel;
}

// The door leaf of experiment_1.world.yaml that stands almost along the wall, and the corridor
// beside it.
const Eigen::Vector2d kLeafLow_m(18.3, -1.1);
const Eigen::Vector2d kLeafHigh_m(20.1, -0.55);
const Eigen::Vector2d kBesideLow_m(18.3, -0.55);
const Eigen::Vector2d kBesideHigh_m(20.1, 0.55);

/// For each stop before the door opens, the branch length behind the leaf in its local map; nothing
/// when the map has no branch along the leaf.
std::vector<std::optional<double>> behind_leaf_m(const Drive& drive,
                                                 const std::vector<Pose2>& poses) {
  constexpr double kDoorOpens_m = 33.0;  // of the path
  constexpr double kAlong_m = 1.5;       // of the 1.8 m beside the leaf
  std::vector<std::optional<double>> behind_m;
  for (std::size_t k = 0; k < drive.stops.size() && drive.path_m[k] < kDoorOpens_m; ++k) {
    const Pose2 T_world_stop = drive.T_world_first * poses[k];
    const topomap::LocalMap& map = *drive.stops[k];
    behind_m.emplace_back();
    if (length_within(map, T_world_stop, kBesideLow_m, kBesideHigh_m) < kAlong_m) continue;
    behind_m.back() = length_within(map, T_world_stop, kLeafLow_m, kLeafHigh_m);
  }
  return behind_m;
}

/// The first view with a branch behind the leaf, and the first one after it without.
struct FalseBranch {
  std::optional<std::size_t> seen;
  std::optional<std::size_t> gone;
  double length_m = 0.0;  ///< in the first view
  std::size_t last = 0;   ///< stop before the door opens
};

FalseBranch false_branch(const Drive& drive, const std::vector<Pose2>& poses) {
  const auto behind_m = behind_leaf_m(drive, poses);
  FalseBranch found;
  found.last = behind_m.empty() ? 0 : behind_m.size() - 1;
  for (std::size_t k = 0; k < behind_m.size(); ++k) {
    if (!found.seen && behind_m[k].value_or(0.0) > 0.0) {
      found.seen = k;
      found.length_m = *behind_m[k];
    } else if (found.seen && !found.gone && behind_m[k] == 0.0) {
      found.gone = k;
    }
  }
  return found;
}

/// Length behind the leaf in the global map of the stops up to one, metres.
double false_length_m(const Drive& drive, const std::vector<Pose2>& poses, std::size_t stop,
                      topomap::FusionRule rule) {
  return length_within(fused(drive, poses, stop + 1, rule), drive.T_world_first, kLeafLow_m,
                       kLeafHigh_m);
}

void figure_8_8(Report& report) {
  const Drive& drive = report.runs().drive(kCorridor);
  const Correction& correction = report.runs().correction(kCorridor, kForwardAlone);
  const std::vector<Pose2>& poses = correction.final_poses();
  report.made_by(means_of(drive, correction));
  const FalseBranch found = false_branch(drive, poses);
  report.states("a view has a branch behind the leaf", found.seen.has_value());
  report.states("a later view has none any more", found.gone.has_value());
  const std::size_t first = found.seen.value_or(found.last);
  const std::size_t then = found.gone.value_or(found.last);
  report.states("the global map has it then",
                false_length_m(drive, poses, first, topomap::FusionRule::kPairs) > 0.0);
  report.show("false branch of the view", found.length_m, "m");
  report.show("false branch left in the global map",
              false_length_m(drive, poses, found.last, topomap::FusionRule::kPairs), "m");
  const Drive& farther = report.runs().drive(kProductCorridor);
  const Correction& product = report.runs().correction(kProductCorridor, kProduct);
  const FalseBranch own = false_branch(farther, product.final_poses());
  const std::string by = matcher_text(product.config) + ", 10 m, fused by votes";
  report.beside("false branch of the view", own.length_m, "m", by);
  report.beside(
      "false branch left in the global map",
      false_length_m(farther, product.final_poses(), own.last, topomap::FusionRule::kVotes), "m",
      by);
  std::vector<FigurePanel> panels;
  for (const auto& [stop, title] : {std::pair{first, "(b) while it is seen"},
                                    std::pair{then, "(c) the view that has none any more"}}) {
    panels.push_back(place_panel(drive, stop, {19.2, 0.0}, title));
    add_map(panels.back(), fused(drive, poses, stop + 1), FigureColour::kGreen);
    add_map(panels.back(), *drive.stops[stop], poses[stop], FigureColour::kOrange);
  }
  report.draw({.title = "A leaf along the wall that looks like an opening", .panels = panels},
              "Global map green, local map orange.");
  report.note(
      "Published is that later views have no false branch any more, not that it leaves the global "
      "map; fusion joins branches and removes none.");
}

// The door of door_opens.world.yaml.
const Eigen::Vector2d kDoorLow_m(4.4, -2.4);
const Eigen::Vector2d kDoorHigh_m(5.6, -1.1);
constexpr double kDoorOpens_m = 12.0;

void figure_8_9(Report& report) {
  const Drive& drive = report.runs().drive("door");
  const Correction& correction = report.runs().correction("door", kForwardAlone);
  report.made_by(means_of(drive, correction));
  const auto opened = std::ranges::lower_bound(drive.path_m, kDoorOpens_m);
  const auto count = static_cast<std::size_t>(opened - drive.path_m.begin());
  const topomap::GlobalMap shut = fused(drive, correction.final_poses(), count);
  const topomap::GlobalMap open = fused(drive, correction.final_poses(), drive.stops.size());
  const Eigen::Vector2d door_m(5.0, -1.1);
  FigurePanel a = place_panel(drive, count - 1, door_m, "(a) before it opens");
  add_map(a, shut, FigureColour::kGreen);
  FigurePanel b = place_panel(drive, drive.stops.size() - 1, door_m, "(b) after it was seen open");
  add_map(b, open, FigureColour::kGreen);
  report.draw({.title = "A door that opens meanwhile", .panels = {a, b}});
  report.worked_out("branches through the shut door",
                    length_within(shut, drive.T_world_first, kDoorLow_m, kDoorHigh_m), 0.0, "m");
  report.states("a branch leads through the open door",
                length_within(open, drive.T_world_first, kDoorLow_m, kDoorHigh_m) > 0.3);
  const Drive& farther = report.runs().drive("door, 10 m");
  const Correction& product = report.runs().correction("door, 10 m", kProduct);
  report.beside("branches through the open door",
                length_within(fused(farther, product.final_poses(), farther.stops.size(),
                                    topomap::FusionRule::kVotes),
                              farther.T_world_first, kDoorLow_m, kDoorHigh_m),
                "m", matcher_text(product.config) + ", 10 m, fused by votes");
  const auto nodes = [](const topomap::GlobalMap& map) {
    return std::ranges::count_if(map.nodes, [](const topomap::MapNode& node) {
      return node.kind != NodeKind::kFictitious && node.kind != NodeKind::kVirtual;
    });
  };
  report.states("the map has more nodes afterwards", nodes(open) > nodes(shut));
}

void figure_8_10(Report& report) {
  const Drive& drive = report.runs().drive(kCorridor);
  const Correction& correction = report.runs().correction(kCorridor);
  report.made_by(means_of(drive, correction));
  const Eigen::Vector2d mouth_m(4.0, 0.0);
  const auto near_mouth = [&](const Eigen::Vector2d& at_m) {
    return (drive.T_world_first * at_m - mouth_m).norm() < 1.2;
  };
  std::size_t seen = 0;
  FigurePanel views = place_panel(drive, 0, mouth_m, "(a) states of single views");
  for (std::size_t k = 0; k < drive.stops.size(); ++k) {
    render::FigureDots dots{{}, FigureColour::kOrange, 3.5};
    for (const topomap::LocalNode& node : drive.stops[k]->nodes) {
      const Eigen::Vector2d at_m = correction.final_poses()[k] * node.position_m;
      const bool state = node.kind == NodeKind::kHallCorridor ||
                         node.kind == NodeKind::kNarrowing || node.kind == NodeKind::kDoor;
      if (!state || !near_mouth(at_m)) continue;
      dots.points.push_back(on_page(at_m));
      ++seen;
    }
    views.dots.push_back(std::move(dots));
  }
  const topomap::GlobalMap map = fused(drive, correction.final_poses(), drive.stops.size());
  FigurePanel together = place_panel(drive, 0, mouth_m, "(b) fused");
  add_map(together, map, FigureColour::kGreen);
  report.draw({.title = "Nodes of one passage become one", .panels = {views, together}});
  const auto left = std::ranges::count_if(map.nodes, [&](const topomap::MapNode& node) {
    return (node.kind == NodeKind::kHallCorridor || node.kind == NodeKind::kNarrowing ||
            node.kind == NodeKind::kDoor) &&
           near_mouth(node.position_m);
  });
  report.states("several views have a node of the passage", seen > 1);
  report.show("nodes of single views", static_cast<double>(seen));
  report.printed("nodes of the passage after fusion", static_cast<double>(left), 1);
}

}  // namespace

std::vector<Experiment> chapter8_corridor() {
  const std::string kThesis = "Thesis";
  return {
      {"figure-8.4", kThesis, "Figure 8.4",
       "Experiment 1, a corridor there and back: readings where odometry has the robot", figure_8_4,
       "", true},
      {"figure-8.5", kThesis, "Figure 8.5", "Experiment 1: local maps where odometry has the robot",
       figure_8_5, "", true},
      {"figure-8.6", kThesis, "Figure 8.6",
       "Experiment 1: the global map when the robot is at the end of the corridor", figure_8_6, "",
       true},
      {"figure-8.7", kThesis, "Figure 8.7",
       "Experiment 1: solutions of the backward correction on the way back", figure_8_7, "", true},
      {"figure-8.8", kThesis, "Figure 8.8",
       "Experiment 1: a leaf along the wall makes a false branch, which later views do not have",
       figure_8_8, "", true},
      {"figure-8.9", kThesis, "Figure 8.9", "A door seen open later adds its branch and node",
       figure_8_9, "", true},
      {"figure-8.10", kThesis, "Figure 8.10",
       "Experiment 1: nodes of the passage from hall to corridor become one", figure_8_10,
       "A state that too small a share of the views shows is left out of the global map", true},
  };
}

}  // namespace topogeo::reproduce
