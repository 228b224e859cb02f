// topogeo plan: the shortest path between two points of a map file.
#include <exception>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/pipeline/config.hpp"
#include "topogeo/pipeline/hybrid_map_source.hpp"
#include "topogeo/planning/goal_planner.hpp"
#include "topogeo/render/route_picture.hpp"
#include "topogeo/service/service_options.hpp"
#include "topogeo/storage/read_map.hpp"
#include "topogeo/support/atomic_file.hpp"
#include "topogeo/support/format.hpp"

#include "commands.hpp"
#include "common/configuration.hpp"
#include "navigate/goal_session.hpp"
#include "navigate/target_text.hpp"

namespace topogeo::cli {
namespace {

struct PlanOptions {
  std::filesystem::path map;
  std::string from;
  std::string to;
  std::optional<std::filesystem::path> config;
  std::vector<std::string> blocks;
  std::optional<std::filesystem::path> picture;
  bool json = false;
};

storage::MapDocument read_map(const std::filesystem::path& path) {
  try {
    return storage::read_map(path);
  } catch (const std::exception& error) {
    throw service::BadInputError(error.what());
  }
}

/// A route along branches, and the same with the lines from its start and to its goal.
struct BranchRoute {
  planning::PlanResult along;
  planning::HybridRoute whole;
};

void print_text(const BranchRoute& route) {
  const planning::HybridRoute& whole = route.whole;
  std::cout << fmt::format(
      "length {:.2f} m, smallest clearance {:.2f} m, {} nodes, {} waypoints (--json lists them)\n",
      whole.length_m, whole.min_clearance_m, route.along.route.node_ids.size(),
      whole.points_m.size());
  const double off_m = planning::length_on(whole, planning::PlannedOn::kOffBranch);
  if (off_m > 0.0) {
    std::cout << fmt::format("{:.2f} m of it between branches and start or goal\n", off_m);
  }
  for (const planning::RoutePart& part : whole.parts) {
    if (part.on != planning::PlannedOn::kVirtualBranch) continue;
    std::cout << fmt::format("branch {} is virtual: the robot has passed there and seen little\n",
                             part.branch_id);
  }
}

void print_json(const BranchRoute& route) {
  const planning::HybridRoute& whole = route.whole;
  nlohmann::ordered_json json = {{"length_m", whole.length_m},
                                 {"min_clearance_m", whole.min_clearance_m},
                                 {"nodes", route.along.route.node_ids},
                                 {"branches", route.along.route.branch_ids},
                                 {"parts", nlohmann::ordered_json::array()},
                                 {"points", nlohmann::ordered_json::array()}};
  for (const planning::RoutePart& part : whole.parts) {
    json["parts"].push_back(
        {{"on", describe(part.on)}, {"branch", part.branch_id}, {"first_point", part.first_point}});
  }
  for (std::size_t i = 0; i < whole.points_m.size(); ++i) {
    json["points"].push_back({{"x_m", whole.points_m[i].x()},
                              {"y_m", whole.points_m[i].y()},
                              {"clearance_m", whole.clearances_m[i]}});
  }
  std::cout << json.dump(2) << '\n';
}

/// The grid of the map with its zones; none if the map has no grid.
std::optional<planning::HybridMap> grid_of(const storage::MapDocument& document,
                                           const pipeline::HybridMapConfig& config) {
  const pipeline::HybridMapParts parts = pipeline::parts_of(document);
  if (!pipeline::has_grid(parts)) return std::nullopt;
  return pipeline::make_hybrid_map(parts, config);
}

/// The floor under the picture of a map without a grid.
planning::HybridMap empty_floor(const topomap::GlobalMap& map) {
  constexpr double kMargin_m = 2.0;
  std::vector<Eigen::Vector2d> points_m{{0.0, 0.0}};
  for (const topomap::MapNode& node : map.nodes) points_m.push_back(node.position_m);
  planning::FreeSpace space{planning::OccupancyGrid(planning::frame_around(points_m, kMargin_m))};
  planning::ZoneMap zones = planning::zones_by_width(space);
  return {std::move(space), std::move(zones)};
}

void draw(const PlanOptions& options, const topomap::GlobalMap& map,
          const planning::HybridMap& floor, const planning::HybridRoute& route,
          std::span<const Eigen::Vector2d> blocked_m) {
  std::vector<planning::Cell> filled;
  for (const Eigen::Vector2d& point_m : blocked_m) {
    if (const auto cell = floor.frame().cell_of(point_m)) filled.push_back(*cell);
  }
  const std::string title = fmt::format("{}: {} to {} along branches",
                                        options.map.filename().string(), options.from, options.to);
  support::write_file_atomically(
      *options.picture,
      render::route_picture(floor, route, title, render::picture_format(*options.picture), {},
                            filled, &map));
}

int plan_route(const PlanOptions& options) {
  const Eigen::Vector2d from_m = point_for("--from", options.from);
  const Eigen::Vector2d to_m = point_for("--to", options.to);
  const pipeline::Config config = read_config(options.config);
  std::vector<Eigen::Vector2d> blocked_m;
  for (const std::string& block : options.blocks) {
    blocked_m.push_back(point_for("--block", block));
  }
  check_picture(options.picture);
  const storage::MapDocument document = read_map(options.map);
  std::optional<planning::HybridMap> grid = grid_of(document, config.hybrid_map);
  planning::PlanScene scene;
  scene.space = grid ? &grid->space() : nullptr;
  scene.zones = document.drawing.zones;
  scene.lines = document.drawing.lines;
  scene.filled_m = blocked_m;
  scene.prove_goal = true;  // as the planner of the robot does
  BranchRoute route;
  route.along = planning::plan(document.global_map, from_m, to_m, config.planning, scene);
  route.whole = planning::along_branches(route.along, from_m, to_m);
  if (options.picture) {
    if (!grid) grid.emplace(empty_floor(document.global_map));
    draw(options, document.global_map, *grid, route.whole, blocked_m);
  }
  if (!route.whole.found()) {
    std::cerr << "topogeo: no route: " << no_route_text(route.whole) << '\n';
    return service::kFailure;
  }
  if (options.json) {
    print_json(route);
  } else {
    print_text(route);
  }
  return service::kOk;
}

}  // namespace

void add_plan_command(command_line::Command& app, int& exit_code) {
  command_line::Command* command =
      app.add_subcommand("plan", "Shortest route between two points of a map");
  auto options = std::make_shared<PlanOptions>();
  command->add_option("map", options->map, "map file (map.pb)")->required()->type_name("MAP");
  command->add_option("--from", options->from, "start, metres in the map frame")
      ->required()
      ->type_name("X,Y");
  command->add_option("--to", options->to, "goal, metres in the map frame")
      ->required()
      ->type_name("X,Y");
  command->add_option("--config", options->config, "configuration (YAML), for its planning section")
      ->type_name("FILE");
  command
      ->add_option("--block", options->blocks, "obstacle that is not on the map; may be repeated")
      ->type_name("X,Y")
      ->allow_extra_args(false);
  command->add_option("--picture", options->picture, "write the route on the map as .png or .svg")
      ->type_name("FILE");
  command->add_flag("--json", options->json, "for programs: all waypoints, nodes and branches");
  command->footer(
      "The route keeps to the branches and reaches its goal over free cells, or within the "
      "clearance\nof a branch where the map has no grid. `simulate-route` plans as the robot does, "
      "also over cells\nbetween the branches.");
  command->callback([options, &exit_code] { exit_code = plan_route(*options); });
}

}  // namespace topogeo::cli
