// topogeo simulate-route: plans on a map, a drawn floor or a grid, and shows the route as steps and
// as a picture before anything moves (spec B2).
#include <exception>
#include <filesystem>
#include <iostream>
#include <memory>
#include <numbers>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>
#include <spdlog/fmt/fmt.h>

#include "topogeo/pipeline/world_grid.hpp"
#include "topogeo/planning/grid_file.hpp"
#include "topogeo/planning/hybrid_planner.hpp"
#include "topogeo/planning/motion_primitives.hpp"
#include "topogeo/render/route_picture.hpp"
#include "topogeo/service/service_options.hpp"
#include "topogeo/storage/map_file.hpp"
#include "topogeo/support/atomic_file.hpp"

#include "commands.hpp"
#include "target_text.hpp"

namespace topogeo::cli {
namespace {

struct SimulateRouteOptions {
  std::filesystem::path source;
  std::string from;
  std::string to;
  double heading_deg = 0.0;
  std::optional<std::filesystem::path> zones;
  std::optional<std::filesystem::path> picture;
};

/// A world file (.world.yaml), a grid (.yaml) or a map file, with the zones of the drawing if there
/// is one, otherwise those between the narrow passages.
planning::HybridMap read_source(const SimulateRouteOptions& options) {
  planning::ZoneDrawing drawing;
  if (options.zones) drawing = planning::read_zone_drawing(*options.zones);
  const std::string name = options.source.filename().string();
  std::vector<planning::Passage> passages;
  const planning::FreeSpace space([&] {
    if (name.ends_with(".world.yaml")) {
      return planning::grid_of(pipeline::drawing_of(simulation::load_world(options.source)));
    }
    if (name.ends_with(".yaml")) return planning::read_grid(options.source);
    const storage::MapDocument document = storage::read_map_file(options.source);
    passages = planning::passages_of(document.global_map);
    return planning::grid_from_scans(document.local_maps, document.trajectory.stops);
  }());
  if (!drawing.zones.empty()) {
    return {space, planning::drawn_zones(space, drawing.zones), drawing.places};
  }
  if (!passages.empty()) return {space, planning::zones_between(space, passages), drawing.places};
  return {space, planning::zones_by_width(space), drawing.places};
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

int simulate_route(const SimulateRouteOptions& options) {
  const auto from_m = point_of(options.from);
  if (!from_m) {
    throw service::UsageError(
        fmt::format("--from = '{}': expected X,Y in metres of the map frame, for example 1.5,-2",
                    options.from));
  }
  std::optional<render::PictureFormat> format;
  try {
    if (options.picture) format = render::picture_format(*options.picture);
  } catch (const std::exception& error) {
    throw service::UsageError(error.what());
  }
  const auto map = [&] {
    try {
      return read_source(options);
    } catch (const std::exception& error) {
      throw service::BadInputError(error.what());
    }
  }();
  const planning::HybridRoute route =
      planning::HybridPlanner(map).plan(*from_m, target_of(options.to));
  if (format) {
    const std::string title =
        fmt::format("{}: {} to {}", options.source.filename().string(), options.from, options.to);
    support::write_file_atomically(*options.picture,
                                   render::route_picture(map, route, title, *format));
  }
  if (!route.found()) {
    std::cerr << "topogeo: no route: " << route.reason;
    if (route.nearest_reachable_m) {
      std::cerr << fmt::format("; ({:.2f}, {:.2f}) is the nearest place that can be reached",
                               route.nearest_reachable_m->x(), route.nearest_reachable_m->y());
    }
    std::cerr << '\n';
    return service::kFailure;
  }
  print_steps(route, options.heading_deg * std::numbers::pi / 180.0);
  return service::kOk;
}

}  // namespace

void add_simulate_route_command(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand(
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
  command->add_option("--heading", options->heading_deg, "where the robot looks at the start")
      ->check(CLI::Range(-360.0, 360.0))
      ->type_name("DEG");
  command->add_option("--zones", options->zones, "drawn zones and places (YAML)")
      ->type_name("FILE");
  command->add_option("--picture", options->picture, "write the route on the map as .png or .svg")
      ->type_name("FILE");
  command->callback([options, &exit_code] { exit_code = simulate_route(*options); });
}

}  // namespace topogeo::cli
