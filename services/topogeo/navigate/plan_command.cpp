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

void print_text(const planning::Route& route) {
  std::cout << fmt::format("length {:.2f} m, smallest clearance {:.2f} m, {} nodes, {} waypoints\n",
                           route.length_m, route.min_clearance_m, route.node_ids.size(),
                           route.points.size());
  for (const planning::RoutePart& part : route.parts) {
    if (part.on != planning::PlannedOn::kVirtualBranch) continue;
    std::cout << fmt::format("branch {} is virtual: the robot has passed there and seen little\n",
                             part.branch_id);
  }
  for (const planning::RoutePoint& point : route.points) {
    std::cout << fmt::format("{:9.3f} {:9.3f}  clearance {:.2f}\n", point.position_m.x(),
                             point.position_m.y(), point.clearance_m);
  }
}

void print_json(const planning::Route& route) {
  nlohmann::ordered_json json = {{"length_m", route.length_m},
                                 {"min_clearance_m", route.min_clearance_m},
                                 {"nodes", route.node_ids},
                                 {"branches", route.branch_ids},
                                 {"parts", nlohmann::ordered_json::array()},
                                 {"points", nlohmann::ordered_json::array()}};
  for (const planning::RoutePart& part : route.parts) {
    json["parts"].push_back(
        {{"on", describe(part.on)}, {"branch", part.branch_id}, {"first_point", part.first_point}});
  }
  for (const planning::RoutePoint& point : route.points) {
    json["points"].push_back({{"x_m", point.position_m.x()},
                              {"y_m", point.position_m.y()},
                              {"clearance_m", point.clearance_m}});
  }
  std::cout << json.dump(2) << '\n';
}

/// The floor under the route: the grid of the map or, if there is none, an empty one.
planning::HybridMap floor_of(const storage::MapDocument& document,
                             const pipeline::HybridMapConfig& config) {
  const pipeline::HybridMapParts parts = pipeline::parts_of(document);
  if (pipeline::has_grid(parts)) return pipeline::make_hybrid_map(parts, config);
  constexpr double kMargin_m = 2.0;
  std::vector<Eigen::Vector2d> points_m{{0.0, 0.0}};
  for (const topomap::MapNode& node : document.global_map.nodes) {
    points_m.push_back(node.position_m);
  }
  planning::FreeSpace space{planning::OccupancyGrid(planning::frame_around(points_m, kMargin_m))};
  planning::ZoneMap zones = planning::zones_by_width(space);
  return {std::move(space), std::move(zones)};
}

void draw(const PlanOptions& options, const storage::MapDocument& document,
          const planning::HybridRoute& route, std::span<const Eigen::Vector2d> blocked_m,
          const pipeline::HybridMapConfig& config) {
  const planning::HybridMap floor = floor_of(document, config);
  std::vector<planning::Cell> filled;
  for (const Eigen::Vector2d& point_m : blocked_m) {
    if (const auto cell = floor.frame().cell_of(point_m)) filled.push_back(*cell);
  }
  const std::string title = fmt::format("{}: {} to {} along branches",
                                        options.map.filename().string(), options.from, options.to);
  support::write_file_atomically(
      *options.picture,
      render::route_picture(floor, route, title, render::picture_format(*options.picture), {},
                            filled, &document.global_map));
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
  planning::PlanScene scene;
  scene.zones = document.drawing.zones;
  scene.lines = document.drawing.lines;
  scene.filled_m = blocked_m;
  const planning::PlanResult result =
      planning::plan(document.global_map, from_m, to_m, config.planning, scene);
  if (options.picture) {
    draw(options, document, planning::along_branches(result, from_m, to_m), blocked_m,
         config.hybrid_map);
  }
  if (!result.found()) {
    std::cerr << "topogeo: no route: " << result.reason << '\n';
    return service::kFailure;
  }
  if (options.json) {
    print_json(result.route);
  } else {
    print_text(result.route);
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
  command->add_flag("--json", options->json, "print JSON");
  command->callback([options, &exit_code] { exit_code = plan_route(*options); });
}

}  // namespace topogeo::cli
