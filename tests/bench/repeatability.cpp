// How much of a local map is found again in the local map made half a metre farther on.
//
//   topogeo_repeatability (--world FILE | --log FILE --reference FILE.tum) [--config FILE]
//
// For each scan the next one that lies `--apart` metres away by the true poses (simulation) or by
// the reference trajectory (recorded log). A node or branch point is in common view when the other
// scan proves the place to be free, within its range limit. It is found again when the other map
// has a real node (a branch) within 0.15 m of it. Both directions count. Prints one line of a
// table.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/pipeline/config.hpp"
#include "topogeo/scan/carmen_log_reader.hpp"
#include "topogeo/simulation/simulate_log.hpp"
#include "topogeo/storage/tum.hpp"
#include "topogeo/topomap/local_map_builder.hpp"
#include "topogeo/voronoi/local_voronoi.hpp"

namespace {

using namespace topogeo;
using topomap::LocalMap;
using topomap::NodeKind;

constexpr double kFound_m = 0.15;

/// A local map and what was seen free when it was made.
struct View {
  geometry::Pose2 T_world_robot;
  geometry::Pose2 T_robot_laser;
  LocalMap map;
  double angle_min_rad = 0.0;
  double angle_step_rad = 0.0;
  std::vector<double> free_range_m;
  voronoi::Frontier frontier;
  double largest_hidden_share = 1.0;

  /// True if the scan also proves how far the nearest object is from there: it could hold the same
  /// node or branch point.
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

struct Input {
  std::vector<scan::Scan> scans;
  std::vector<geometry::Pose2> T_world_robot;
};

Input simulated(const std::string& world) {
  simulation::SimulatedLog log = simulation::simulate_log(simulation::load_world(world), {});
  return {std::move(log.scans), std::move(log.T_world_robot)};
}

Input recorded(const std::string& log, const std::string& reference,
               const pipeline::Config& config) {
  const auto truth = storage::read_trajectory_tum(reference);
  scan::CarmenLogReader reader(log, config.log);
  Input input;
  std::size_t next = 0;
  while (auto scan = reader.next()) {
    while (next < truth.size() && truth[next].stamp_ns < scan->stamp_ns - 1'000'000) ++next;
    if (next == truth.size()) break;
    if (std::abs(truth[next].stamp_ns - scan->stamp_ns) > 1'000'000) continue;
    input.T_world_robot.push_back(truth[next].pose);
    input.scans.push_back(std::move(*scan));
  }
  return input;
}

std::vector<View> views_of(const Input& input, const pipeline::LocalMapperConfig& config) {
  voronoi::LocalVoronoi voronoi{config.voronoi};
  voronoi::LocalVoronoiDiagram diagram;
  std::vector<View> views;
  for (std::size_t i = 0; i < input.scans.size(); ++i) {
    const scan::Scan& scan = input.scans[i];
    View view;
    view.T_world_robot = input.T_world_robot[i];
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

/// How many of a kind of element were looked for and found.
struct Tally {
  std::size_t count = 0;
  std::size_t found = 0;
  double distance_m = 0.0;        ///< sum over those found
  double every_distance_m = 0.0;  ///< sum over all

  void add(double apart_m, double found_m) {
    ++count;
    every_distance_m += std::min(apart_m, kFar_m);
    if (apart_m > found_m) return;
    ++found;
    distance_m += apart_m;
  }

  static constexpr double kFar_m = 1.0;  ///< what counts at most for one that is not found
};

struct Counts {
  std::size_t pairs = 0;
  Tally nodes, nodes_place, states, points, points_place;
};

bool is_state(NodeKind kind) {
  return kind == NodeKind::kDoor || kind == NodeKind::kNarrowing || kind == NodeKind::kHallCorridor;
}

/// Distance to the nearest node of `map` that `wanted` accepts.
template <typename Wanted>
double nearest_node_m(const LocalMap& map, const Eigen::Vector2d& at, Wanted wanted) {
  double best_m = std::numeric_limits<double>::infinity();
  for (const topomap::LocalNode& node : map.nodes) {
    if (wanted(node.kind)) best_m = std::min(best_m, (node.position_m - at).norm());
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
    if (node.kind == NodeKind::kReal) {
      const double apart_m =
          nearest_node_m(in.map, at, [](NodeKind kind) { return kind == NodeKind::kReal; });
      counts.nodes_place.add(apart_m, kFound_m);
      if (confirmed) counts.nodes.add(apart_m, kFound_m);
    } else if (is_state(node.kind) && confirmed) {
      counts.states.add(nearest_node_m(in.map, at, is_state), 2.0 * kFound_m);
    }
  }
  for (const topomap::LocalBranch& branch : from.map.branches) {
    if (branch.is_virtual || !branch.confirmed) continue;
    for (std::size_t i = 1; i + 1 < branch.points.size(); ++i) {
      const Eigen::Vector2d at = T_in_from * branch.points[i].position_m;
      if (!in.sees(at)) continue;
      const double apart_m = nearest_branch_m(in.map, at);
      counts.points_place.add(apart_m, kFound_m);
      if (in.confirms(at, branch.points[i].clearance_m)) counts.points.add(apart_m, kFound_m);
    }
  }
}

/// The scan after number i that lies most nearly `apart_m` away, within a quarter of it.
std::optional<std::size_t> partner(const std::vector<View>& views, std::size_t i, double apart_m) {
  constexpr std::size_t kAhead = 20;
  std::optional<std::size_t> best;
  double best_m = 0.25 * apart_m;
  for (std::size_t j = i + 1; j < std::min(views.size(), i + 1 + kAhead); ++j) {
    const Eigen::Vector2d way_m =
        views[j].T_world_robot.position_m() - views[i].T_world_robot.position_m();
    if (std::abs(way_m.norm() - apart_m) > best_m) continue;
    best_m = std::abs(way_m.norm() - apart_m);
    best = j;
  }
  return best;
}

Counts compare(const std::vector<View>& views, double apart_m) {
  Counts counts;
  for (std::size_t i = 0; i < views.size(); ++i) {
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

double found(const Tally& tally) {
  return ratio(static_cast<double>(tally.found), tally.count);
}

void print(const std::string& name, const std::vector<View>& views, const Counts& counts) {
  std::size_t nodes = 0;
  std::size_t with_node = 0;
  for (const View& view : views) {
    const auto real =
        std::ranges::count(view.map.nodes, NodeKind::kReal, &topomap::LocalNode::kind);
    nodes += static_cast<std::size_t>(real);
    with_node += real > 0 ? 1 : 0;
  }
  std::printf(
      "| %s | %zu | %.2f | %.2f | %.3f of %zu | %.3f | %.3f | %.3f of %zu | %.3f of %zu | "
      "%.3f | %.3f | %.3f |\n",
      name.c_str(), counts.pairs, ratio(static_cast<double>(with_node), views.size()),
      ratio(static_cast<double>(nodes), views.size()), found(counts.nodes), counts.nodes.count,
      ratio(counts.nodes.distance_m, counts.nodes.found), found(counts.nodes_place),
      found(counts.states), counts.states.count, found(counts.points), counts.points.count,
      ratio(counts.points.distance_m, counts.points.found),
      ratio(counts.points.every_distance_m, counts.points.count), found(counts.points_place));
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"how much of a local map is found again half a metre farther on"};
  std::string world;
  std::string log;
  std::string reference;
  std::optional<std::string> config_file;
  std::string name;
  double apart_m = 0.5;
  app.add_option("--world", world, "world file to simulate a log in");
  app.add_option("--log", log, "CARMEN log")->excludes("--world");
  app.add_option("--reference", reference, "reference trajectory of the log, TUM");
  app.add_option("--config", config_file, "configuration file");
  app.add_option("--name", name, "first column");
  app.add_option("--apart", apart_m, "metres between two scans")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    const pipeline::Config config =
        pipeline::load_config(config_file ? std::optional<std::filesystem::path>(*config_file)
                                          : std::nullopt)
            .config;
    const Input input = world.empty() ? recorded(log, reference, config) : simulated(world);
    const auto views = views_of(input, config.local_mapper);
    print(name, views, compare(views, apart_m));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "topogeo_repeatability: %s\n", error.what());
    return 1;
  }
  return 0;
}
