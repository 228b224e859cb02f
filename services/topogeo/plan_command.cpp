// topogeo plan: the shortest way between two points of a map file.
#include <exception>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/pipeline/config.hpp"
#include "topogeo/planning/route_planner.hpp"
#include "topogeo/service/service_options.hpp"
#include "topogeo/storage/read_map.hpp"
#include "topogeo/support/format.hpp"

#include "commands.hpp"
#include "target_text.hpp"

namespace topogeo::cli {
namespace {

struct PlanOptions {
  std::filesystem::path map;
  std::string from;
  std::string to;
  std::optional<std::filesystem::path> config;
  bool json = false;
};

pipeline::LoadedConfig load_map(const std::optional<std::filesystem::path>& file) {
  try {
    return pipeline::load_config(file);
  } catch (const std::exception& error) {
    throw service::UsageError(error.what());
  }
}

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
                                 {"points", nlohmann::ordered_json::array()}};
  for (const planning::RoutePoint& point : route.points) {
    json["points"].push_back({{"x_m", point.position_m.x()},
                              {"y_m", point.position_m.y()},
                              {"clearance_m", point.clearance_m}});
  }
  std::cout << json.dump(2) << '\n';
}

int plan_route(const PlanOptions& options) {
  const Eigen::Vector2d from_m = point_for("--from", options.from);
  const Eigen::Vector2d to_m = point_for("--to", options.to);
  const pipeline::LoadedConfig config = load_map(options.config);
  const storage::MapDocument document = read_map(options.map);
  const planning::PlanResult result =
      planning::plan(document.global_map, from_m, to_m, config.config.planning);
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
  command->add_flag("--json", options->json, "print JSON");
  command->callback([options, &exit_code] { exit_code = plan_route(*options); });
}

}  // namespace topogeo::cli
