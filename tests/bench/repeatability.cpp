// Share of a local map that is found again in the local map made half a metre farther on.
//
//   topogeo_repeatability [--world FILE]... [--log FILE --reference FILE.tum]... [--config FILE]
//
// Compares each scan with the next one that lies `--apart` metres away by the true poses
// (simulation) or by the reference trajectory (recorded log). A node or branch point is in common
// view when the other scan proves the place to be free, within its range limit, and shows the
// circle of its clearance as far as the configuration requires of a real node. It is found again
// when the other map has a real node (a confirmed branch) within 0.15 m of it; states have 0.3 m,
// because a door has no exact position along the branch. Both directions count. Prints a table row
// for each input, or with --total one for all together; repeatability.sh makes whole tables.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/geometry/pose2.hpp"
#include "topogeo/pipeline/config.hpp"
#include "topogeo/topomap/local_map_builder.hpp"
#include "topogeo/voronoi/local_voronoi.hpp"

#include "recordings.hpp"

namespace {

using namespace topogeo;
using topomap::LocalMap;
using topomap::NodeKind;

constexpr double kFound_m = 0.15;

/// A local map and the area seen free when it was made.
struct View {
  geometry::Pose2 T_world_robot;
  geometry::Pose2 T_robot_laser;
  LocalMap map;
  double angle_min_rad = 0.0;
  double angle_step_rad = 0.0;
  std::vector<double> free_range_m;
  voronoi::Frontier frontier;
  double largest_hidden_share = 1.0;

  /// True if the scan also proves the distance of the nearest object from there, so it could hold
  /// the same node or branch point.
  [[nodiscard]] bool confirms(const Eigen::Vector2d& point_robot_m, double clearance_m) const {
    const Eigen::Vector2d at = geometry::inverse(T_robot_laser) * point_robot_m;
    return clearance_m - frontier.distance_m(at) <= largest_hidden_share * clearance_m;
  }
  /// True if the scan proves a point to be free.
  [[nodiscard]] bool sees(const Eigen::Vector2d& point_robot_m) const {
    const Eigen::Vector2d at = geometry::inverse(T_robot_laser) * point_robot_m;
    const double turn = 2.0 * M_PI;
    const double offset_rad = std::atan2(at.y(), at.x()) - angle_min_rad;
    const auto beam = static_cast<long>(
        std::lround((offset_rad - std::floor(offset_rad / turn) * turn) / angle_step_rad));
    if (beam < 0 || beam >= static_cast<long>(free_range_m.size())) return false;
    return at.norm() < free_range_m[static_cast<std::size_t>(beam)];
  }
};

std::vector<View> views_of(const bench::Recording& input,
                           const pipeline::LocalMapperConfig& config) {
  voronoi::LocalVoronoi voronoi{config.voronoi};
  voronoi::LocalVoronoiDiagram diagram;
  std::vector<View> views;
  for (std::size_t i = 0; i < input.scans.size(); ++i) {
    if (!input.T_world_robot[i]) continue;
    const scan::Scan& scan = input.scans[i];
    View view;
    view.T_world_robot = *input.T_world_robot[i];
    view.T_robot_laser = config.T_robot_laser;
    view.angle_min_rad = scan.angle_min_rad;
    view.angle_step_rad = scan.angle_step_rad;
    voronoi.compute(scan, diagram);
    topomap::build_local_map(diagram, scan, config.T_robot_laser, config.local_map, view.map);
    view.free_range_m.assign(voronoi.free_range_m().begin(), voronoi.free_range_m().end());
    view.frontier = voronoi.frontier();
    view.largest_hidden_share = config.local_map.largest_hidden_share;
    views.push_back(std::move(view));
  }
  return views;
}

/// Number of elements of one kind in common view, and of those found again.
struct Tally {
  std::size_t count = 0;
  std::size_t found = 0;
  double distance_m = 0.0;  ///< sum over the elements found

  void add(double apart_m, double found_m) {
    ++count;
    if (apart_m > found_m) return;
    ++found;
    distance_m += apart_m;
  }
  Tally& operator+=(const Tally& other) {
    count += other.count;
    found += other.found;
    distance_m += other.distance_m;
    return *this;
  }
};

struct Counts {
  std::size_t scans = 0, with_node = 0, real_nodes = 0;
  std::size_t pairs = 0;
  Tally nodes, states, points;
  /// In common view if the place is, regardless of the circle; a node counts as found where
  /// branches meet, confirmed or not.
  Tally nodes_by_place, points_by_place;

  Counts& operator+=(const Counts& other) {
    scans += other.scans;
    with_node += other.with_node;
    real_nodes += other.real_nodes;
    pairs += other.pairs;
    nodes += other.nodes;
    states += other.states;
    points += other.points;
    nodes_by_place += other.nodes_by_place;
    points_by_place += other.points_by_place;
    return *this;
  }
};

bool is_state(const topomap::LocalNode& node) {
  return node.kind == NodeKind::kDoor || node.kind == NodeKind::kNarrowing ||
         node.kind == NodeKind::kHallCorridor;
}

bool is_real(const topomap::LocalNode& node) {
  return node.kind == NodeKind::kReal;
}

/// A meeting of three or more branches, confirmed or not.
bool is_meeting(const topomap::LocalNode& node) {
  return node.kind != NodeKind::kVirtual && node.base_groups.size() >= 3;
}

/// Distance to the nearest node of `map` that is wanted.
double nearest_node_m(const LocalMap& map, const Eigen::Vector2d& at,
                      bool (*wanted)(const topomap::LocalNode&)) {
  double best_m = std::numeric_limits<double>::infinity();
  for (const topomap::LocalNode& node : map.nodes) {
    if (wanted(node)) best_m = std::min(best_m, (node.position_m - at).norm());
  }
  return best_m;
}

double distance_to_segment_m(const Eigen::Vector2d& a, const Eigen::Vector2d& b,
                             const Eigen::Vector2d& at) {
  const Eigen::Vector2d along = b - a;
  const double sq = along.squaredNorm();
  const double t = sq > 0.0 ? std::clamp((at - a).dot(along) / sq, 0.0, 1.0) : 0.0;
  return (a + t * along - at).norm();
}

double nearest_branch_m(const LocalMap& map, const Eigen::Vector2d& at) {
  double best_m = std::numeric_limits<double>::infinity();
  for (const topomap::LocalBranch& branch : map.branches) {
    if (branch.is_virtual || !branch.confirmed) continue;
    for (std::size_t i = 0; i + 1 < branch.points.size(); ++i) {
      best_m = std::min(best_m, distance_to_segment_m(branch.points[i].position_m,
                                                      branch.points[i + 1].position_m, at));
    }
  }
  return best_m;
}

void look_for(const View& from, const View& in, Counts& counts) {
  const geometry::Pose2 T_in_from = geometry::inverse(in.T_world_robot) * from.T_world_robot;
  for (const topomap::LocalNode& node : from.map.nodes) {
    const Eigen::Vector2d at = T_in_from * node.position_m;
    if (!in.sees(at)) continue;
    const bool confirmed = in.confirms(at, node.clearance_m);
    if (is_real(node)) {
      const double apart_m = nearest_node_m(in.map, at, is_real);
      counts.nodes_by_place.add(nearest_node_m(in.map, at, is_meeting), kFound_m);
      if (confirmed) counts.nodes.add(apart_m, kFound_m);
    } else if (is_state(node) && confirmed) {
      counts.states.add(nearest_node_m(in.map, at, is_state), 2.0 * kFound_m);
    }
  }
  for (const topomap::LocalBranch& branch : from.map.branches) {
    if (branch.is_virtual || !branch.confirmed) continue;
    for (std::size_t i = 1; i + 1 < branch.points.size(); ++i) {
      const Eigen::Vector2d at = T_in_from * branch.points[i].position_m;
      if (!in.sees(at)) continue;
      const double apart_m = nearest_branch_m(in.map, at);
      counts.points_by_place.add(apart_m, kFound_m);
      if (in.confirms(at, branch.points[i].clearance_m)) counts.points.add(apart_m, kFound_m);
    }
  }
}

/// The scan after number i whose distance is nearest to `apart_m`, within a quarter of it.
std::optional<std::size_t> partner(const std::vector<View>& views, std::size_t i, double apart_m) {
  constexpr std::size_t kAhead = 20;
  std::optional<std::size_t> best;
  double best_m = 0.25 * apart_m;
  for (std::size_t j = i + 1; j < std::min(views.size(), i + 1 + kAhead); ++j) {
    const Eigen::Vector2d step_m =
        views[j].T_world_robot.position_m() - views[i].T_world_robot.position_m();
    if (std::abs(step_m.norm() - apart_m) > best_m) continue;
    best_m = std::abs(step_m.norm() - apart_m);
    best = j;
  }
  return best;
}

Counts compare(const std::vector<View>& views, double apart_m) {
  Counts counts;
  counts.scans = views.size();
  for (std::size_t i = 0; i < views.size(); ++i) {
    const auto real =
        std::ranges::count(views[i].map.nodes, NodeKind::kReal, &topomap::LocalNode::kind);
    counts.real_nodes += static_cast<std::size_t>(real);
    counts.with_node += real > 0 ? 1 : 0;
    const auto j = partner(views, i, apart_m);
    if (!j) continue;
    ++counts.pairs;
    look_for(views[i], views[*j], counts);
    look_for(views[*j], views[i], counts);
  }
  return counts;
}

double ratio(double part, std::size_t whole) {
  return whole > 0 ? part / static_cast<double>(whole) : 0.0;
}

double share(const Tally& tally) {
  return ratio(static_cast<double>(tally.found), tally.count);
}

constexpr const char* kHeader =
    "| | pairs | scans with a real node | real nodes a scan | real nodes found again | m apart | "
    "of those with only the place in view, found as any meeting of branches | states a pair | "
    "states found again | branch points found again | m apart | of those with only the place in "
    "view |\n|---|---|---|---|---|---|---|---|---|---|---|---|\n";

void print(const std::string& name, const Counts& counts) {
  std::printf(
      "| %s | %zu | %.2f | %.2f | %.3f of %zu | %.3f | %.3f | %.2f | %.3f | %.3f | %.3f | %.3f |\n",
      name.c_str(), counts.pairs, ratio(static_cast<double>(counts.with_node), counts.scans),
      ratio(static_cast<double>(counts.real_nodes), counts.scans), share(counts.nodes),
      counts.nodes.count, ratio(counts.nodes.distance_m, counts.nodes.found),
      share(counts.nodes_by_place),
      ratio(0.5 * static_cast<double>(counts.states.count), counts.pairs), share(counts.states),
      share(counts.points), ratio(counts.points.distance_m, counts.points.found),
      share(counts.points_by_place));
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  command_line::Command app{"how much of a local map is found again half a metre farther on"};
  std::vector<std::string> worlds;
  std::vector<std::string> logs;
  std::vector<std::string> references;
  std::string config_file;
  std::string total;
  double apart_m = 0.5;
  bool header = false;
  app.add_option("--world", worlds, "world file to simulate a log in");
  app.add_option("--log", logs, "CARMEN log");
  app.add_option("--reference", references, "reference trajectory of each log, TUM");
  app.add_option("--config", config_file, "configuration file")
      ->check(command_line::existing_file());
  app.add_option("--total", total, "one row of this name for all together");
  app.add_option("--apart", apart_m, "metres between two scans")
      ->capture_default_str()
      ->check(command_line::range(0.05, 5.0));
  app.add_flag("--header", header, "print the head of the table first");
  if (const auto exit_code = app.parse_or_report(argc, argv)) return *exit_code;
  if (logs.size() != references.size()) {
    std::fprintf(stderr, "topogeo_repeatability: every --log needs a --reference\n");
    return 2;
  }
  try {
    const pipeline::Config config =
        pipeline::load_config(
            config_file.empty() ? std::nullopt : std::optional<std::filesystem::path>(config_file))
            .config;
    if (header) std::fputs(kHeader, stdout);
    Counts all;
    const auto take = [&](const bench::Recording& input) {
      const Counts counts = compare(views_of(input, config.local_mapper), apart_m);
      if (total.empty()) print(input.name, counts);
      all += counts;
    };
    for (const std::string& world : worlds) take(bench::simulated(world));
    for (std::size_t i = 0; i < logs.size(); ++i) {
      take(bench::recorded(logs[i], references[i], config.log));
    }
    if (!total.empty()) print(total, all);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "topogeo_repeatability: %s\n", error.what());
    return 1;
  }
  return 0;
}
