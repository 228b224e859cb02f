// topogeo simulate-route: plans on a map, a drawn floor or a grid, and shows the route as steps and
// a picture before anything moves (MACONDO, III.3.1; docs/algorithms.md, "Hybrid map and planner").
#include <exception>
#include <filesystem>
#include <iostream>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/pipeline/config.hpp"
#include "topogeo/pipeline/hybrid_map_source.hpp"
#include "topogeo/planning/goal_planner.hpp"
#include "topogeo/planning/motion_primitives.hpp"
#include "topogeo/planning/outline_planner.hpp"
#include "topogeo/render/route_picture.hpp"
#include "topogeo/service/service_options.hpp"
#include "topogeo/support/atomic_file.hpp"
#include "topogeo/support/format.hpp"

#include "commands.hpp"
#include "common/configuration.hpp"
#include "navigate/target_text.hpp"

namespace topogeo::cli {
namespace {

struct SimulateRouteOptions {
  std::filesystem::path source;
  std::string from;
  std::string to;
  double heading_deg = 0.0;
  std::vector<std::string> blocks;
  std::optional<std::filesystem::path> zones;
  std::optional<std::filesystem::path> config;
  std::optional<std::filesystem::path> picture;
};

struct Floor {
  planning::HybridMap map;
  topomap::GlobalMap graph;
};

/// Reads a world file (.world.yaml), a grid (.yaml) or a map file as the hybrid map that robots
/// would get from it.
Floor read_source(const SimulateRouteOptions& options, const pipeline::HybridMapConfig& config) {
  storage::MapDocument floor =
      pipeline::read_floor(options.source, options.zones, config.grid.resolution_m);
  planning::HybridMap map = pipeline::make_hybrid_map(pipeline::parts_of(floor), config);
  return {std::move(map), std::move(floor.global_map)};
}

/// Obstacles at the points of --block.
struct Blocks {
  std::vector<Eigen::Vector2d> points_m;
  std::vector<planning::Cell> cells;
};

/// Checks that a point is on the map. Throws service::UsageError if it is not.
Blocks blocks_of(const std::vector<std::string>& texts, const planning::GridFrame& frame) {
  Blocks blocks;
  for (const std::string& text : texts) {
    blocks.points_m.push_back(point_for("--block", text));
    const auto cell = frame.cell_of(blocks.points_m.back());
    if (!cell) {
      throw service::UsageError(fmt::format("--block = '{}': outside of the map", text));
    }
    blocks.cells.push_back(*cell);
  }
  return blocks;
}

/// Metres on virtual branches and beside branches are listed separately, because they are the last
/// resort.
void print_parts(const planning::HybridRoute& route) {
  const double virtual_m = planning::length_on(route, planning::PlannedOn::kVirtualBranch);
  const double branch_m = planning::length_on(route, planning::PlannedOn::kBranch);
  if (branch_m + virtual_m == 0.0) return;
  std::cout << fmt::format("along branches {:.2f} m, virtual ones {:.2f} m, off them {:.2f} m\n",
                           branch_m, virtual_m,
                           planning::length_on(route, planning::PlannedOn::kOffBranch));
}

void print_steps(const planning::HybridRoute& route, double heading_rad) {
  std::cout << fmt::format(
      "length {:.2f} m ({:.2f} m over cells), smallest clearance {:.2f} m, {} zones, {} nodes\n",
      route.length_m, route.cost_m, route.min_clearance_m, route.zones.size(), route.nodes.size());
  constexpr double kDegrees = 180.0 / std::numbers::pi;
  int step = 0;
  for (const planning::MotionPrimitive& primitive :
       planning::motion_primitives(route.points_m, heading_rad)) {
    ++step;
    switch (primitive.kind) {
      case planning::MotionKind::kAdvance:
        std::cout << fmt::format("{:3}  advance    {:7.2f} m\n", step, primitive.amount);
        break;
      case planning::MotionKind::kTurnLeft:
        std::cout << fmt::format("{:3}  turn left  {:7.1f} deg\n", step,
                                 kDegrees * primitive.amount);
        break;
      case planning::MotionKind::kTurnRight:
        std::cout << fmt::format("{:3}  turn right {:7.1f} deg\n", step,
                                 kDegrees * primitive.amount);
        break;
    }
  }
}

/// Searches the path of a robot that is not round or cannot turn on the spot, because a route for
/// its largest disc may have none. Prints the length of the path, or the reason why there is none.
bool print_path_of_outline(const SimulateRouteOptions& options, const planning::HybridMap& map,
                           const planning::HybridRoute& route, const Blocks& blocks,
                           const navigation::GuardConfig& guard) {
  planning::OutlineConfig config;
  config.footprint = navigation::outline_of(guard);
  config.minimum_radius_m = guard.minimum_turning_radius_m;
  const Eigen::Vector2d from_m = route.points_m.front();
  const geometry::Pose2 start{from_m.x(), from_m.y(),
                              options.heading_deg * std::numbers::pi / 180.0};
  const planning::OutlinePath path = planning::plan_outline(
      map.space(), start, {route.points_m.back(), std::nullopt}, blocks.points_m, config);
  if (!path.found()) {
    std::cerr << "topogeo: " << path.reason << '\n';
    return false;
  }
  int reversals = 0;
  for (std::size_t i = 1; i < path.samples.size(); ++i) {
    reversals += path.samples[i].backward != path.samples[i - 1].backward ? 1 : 0;
  }
  std::cout << fmt::format("path of the outline {:.2f} m, {} changes between ahead and back\n",
                           path.samples.back().distance_m, reversals);
  return true;
}

int simulate_route(const SimulateRouteOptions& options) {
  const Eigen::Vector2d from_m = point_for("--from", options.from);
  std::optional<render::PictureFormat> format;
  try {
    if (options.picture) format = render::picture_format(*options.picture);
  } catch (const std::exception& error) {
    throw service::UsageError(error.what());
  }
  const pipeline::Config config = read_config(options.config);
  const Floor floor = [&] {
    try {
      return read_source(options, config.hybrid_map);
    } catch (const std::exception& error) {
      throw service::BadInputError(error.what());
    }
  }();
  const Blocks blocks = blocks_of(options.blocks, floor.map.frame());
  const planning::HybridRoute route = planning::plan_to_goal(
      {&floor.map, &floor.graph}, from_m, target_of(options.to), blocks.points_m,
      {config.planner, config.hybrid_planner, config.planning});
  if (format) {
    const std::string title =
        fmt::format("{}: {} to {}", options.source.filename().string(), options.from, options.to);
    support::write_file_atomically(
        *options.picture,
        render::route_picture(floor.map, route, title, *format, {}, blocks.cells, &floor.graph));
  }
  if (!route.found()) {
    std::cerr << "topogeo: no route: " << no_route_text(route) << '\n';
    return service::kFailure;
  }
  print_parts(route);
  print_steps(route, options.heading_deg * std::numbers::pi / 180.0);
  const navigation::GuardConfig& guard = config.navigator.guard;
  const bool goes = !navigation::plans_poses(guard) ||
                    print_path_of_outline(options, floor.map, route, blocks, guard);
  return goes ? service::kOk : service::kFailure;
}

}  // namespace

void add_simulate_route_command(command_line::Command& app, int& exit_code) {
  command_line::Command* command = app.add_subcommand(
      "simulate-route", "Show a route on a map, world or grid as steps and as a picture");
  auto options = std::make_shared<SimulateRouteOptions>();
  command
      ->add_option("source", options->source,
                   "map file, world (.world.yaml) or grid (.yaml with its .pgm)")
      ->required()
      ->type_name("FILE");
  command->add_option("--from", options->from, "start, metres in the map frame")
      ->required()
      ->type_name("X,Y");
  command->add_option("--to", options->to, "goal: a point, a node or the name of a place")
      ->required()
      ->type_name("X,Y|#NODE|PLACE");
  command->add_option("--heading", options->heading_deg, "heading of the robot at the start")
      ->check(command_line::range(-360.0, 360.0))
      ->type_name("DEG");
  command
      ->add_option("--block", options->blocks, "obstacle that is not on the map; may be repeated")
      ->type_name("X,Y")
      ->allow_extra_args(false);
  command
      ->add_option("--config", options->config,
                   "configuration (YAML), for its hybrid_map, hybrid_planner, planning, planner, "
                   "robot and base.minimum_turning_radius_m")
      ->type_name("FILE");
  command->add_option("--zones", options->zones, "drawn zones and places (YAML)")
      ->type_name("FILE");
  command->add_option("--picture", options->picture, "write the route on the map as .png or .svg")
      ->type_name("FILE");
  command->callback([options, &exit_code] { exit_code = simulate_route(*options); });
}

}  // namespace topogeo::cli
