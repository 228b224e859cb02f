// topogeo places: lists the places and zones of a map, world or grid file or of the live map, and
// edits the places of a map file.
#include <algorithm>
#include <chrono>
#include <exception>
#include <filesystem>
#include <iostream>
#include <memory>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <nlohmann/json.hpp>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/messaging/event_loop.hpp"
#include "topogeo/messaging/signal_stop.hpp"
#include "topogeo/pipeline/config.hpp"
#include "topogeo/pipeline/hybrid_map_source.hpp"
#include "topogeo/pipeline/localization_run.hpp"
#include "topogeo/service/live_hybrid_map.hpp"
#include "topogeo/service/service_options.hpp"
#include "topogeo/storage/map_file.hpp"
#include "topogeo/support/cpu_time.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/support/patience.hpp"

#include "commands.hpp"
#include "common/configuration.hpp"
#include "common/domain_view.hpp"
#include "navigate/target_text.hpp"

namespace topogeo::cli {
namespace {

constexpr const char* kLive = "live";
constexpr std::chrono::milliseconds kMapPoll{50};

struct PlacesOptions {
  std::string source = kLive;
  std::vector<std::string> added;
  std::vector<std::string> removed;
  std::optional<std::filesystem::path> zones;
  std::optional<std::filesystem::path> config;
  DomainView view;
  std::string robot_id = "robot";
  double wait_s = 5.0;
  bool json = false;
};

/// NAME=X,Y or, for a base station, NAME=X,Y,DEG. Throws service::UsageError.
planning::Place place_of(const std::string& text) {
  const std::size_t equals = text.rfind('=');
  const std::string numbers = equals == std::string::npos ? "" : text.substr(equals + 1);
  planning::Place place{text.substr(0, equals)};
  if (const auto point = point_of(numbers)) {
    place.position_m = *point;
  } else {
    try {
      const geometry::Pose2 T_map_station = pipeline::parse_pose(numbers);
      place.position_m = T_map_station.position_m();
      place.station_heading_rad = T_map_station.theta_rad;
    } catch (const std::invalid_argument&) {
      throw service::UsageError(fmt::format(
          "--add '{}': expected NAME=X,Y or, for a base station, NAME=X,Y,DEG in metres "
          "and degrees of the map frame, for example \"room A=1.5,-2\"",
          text));
    }
  }
  if (!std::holds_alternative<std::string>(target_of(place.name))) {
    throw service::UsageError(
        fmt::format("--add '{}': the name would be taken for a point or a node", text));
  }
  return place;
}

void remove_place(std::vector<planning::Place>& places, const std::string& name) {
  if (std::erase_if(places, [&](const planning::Place& place) { return place.name == name; }) > 0) {
    return;
  }
  std::string names;
  for (const planning::Place& place : places) {
    names += (names.empty() ? "'" : ", '") + place.name + "'";
  }
  throw service::BadInputError(
      fmt::format("--remove '{}': there is no such place, {}", name,
                  names.empty() ? "the map has none" : "the map has " + names));
}

/// Throws service::UsageError for a place that no map could keep.
void check_added(const storage::MapDrawing& added) {
  try {
    storage::check(added);
  } catch (const storage::DrawingError& error) {
    throw service::UsageError(std::string("--add: ") + error.what());
  }
}

/// Throws service::UsageError for a place outside of the map, to which no robot could be sent.
void check_inside(const std::vector<planning::Place>& places, const storage::MapDocument& document,
                  const pipeline::HybridMapConfig& config) {
  const pipeline::HybridMapParts parts = pipeline::parts_of(document);
  if (places.empty() || !pipeline::has_grid(parts)) return;
  const planning::HybridMap map = pipeline::make_hybrid_map(parts, config);
  for (const planning::Place& place : places) {
    if (map.frame().cell_of(place.position_m)) continue;
    throw service::UsageError(fmt::format("--add '{}': {:g},{:g} is outside of the map", place.name,
                                          place.position_m.x(), place.position_m.y()));
  }
}

/// Changes the places of a map file and rewrites it.
void edit(const PlacesOptions& options) {
  storage::MapDrawing added;
  for (const std::string& text : options.added) {
    storage::MapDrawing drawn;
    drawn.places.push_back(place_of(text));
    pipeline::lay_over(added, std::move(drawn));
  }
  const std::filesystem::path file = options.source;
  if (options.source == kLive || file.extension() == ".yaml") {
    throw service::UsageError("--add and --remove need a map file (map.pb)");
  }
  try {
    storage::MapDocument document = storage::read_map_file(file);
    for (const std::string& name : options.removed) remove_place(document.drawing.places, name);
    check_added(added);
    check_inside(added.places, document, read_config(options.config).hybrid_map);
    pipeline::lay_over(document.drawing, std::move(added));
    storage::write_map_file(file, document);
  } catch (const service::UsageError&) {
    throw;
  } catch (const service::BadInputError&) {
    throw;
  } catch (const std::invalid_argument& error) {
    throw service::UsageError(error.what());
  } catch (const std::exception& error) {
    throw service::BadInputError(error.what());
  }
}

std::string zone_text(const planning::HybridMap& map, const Eigen::Vector2d& position_m) {
  const auto cell = map.frame().cell_of(position_m);
  if (!cell) return "outside of the map";
  const planning::ZoneId id = map.zone_of(*cell);
  if (id == planning::kNoZone) return "no room for the robot there";
  const std::string& name = map.zones().zones[id].name;
  return name.empty() ? fmt::format("zone {}", id) : fmt::format("zone {} ({})", id, name);
}

void print_places(const planning::HybridMap& map) {
  for (const planning::Place& place : map.places()) {
    constexpr double kDegrees = 180.0 / std::numbers::pi;
    const std::string station = place.station_heading_rad
                                    ? fmt::format(", base station, heading {:.1f} deg",
                                                  *place.station_heading_rad * kDegrees)
                                    : "";
    std::cout << fmt::format("{:20} {:8.2f} {:8.2f}  {}{}\n", place.name, place.position_m.x(),
                             place.position_m.y(), zone_text(map, place.position_m), station);
  }
  if (map.places().empty()) std::cout << "no places\n";
  const double cell_m2 = map.frame().resolution_m * map.frame().resolution_m;
  for (const planning::Zone& zone : map.zones().zones) {
    std::cout << fmt::format(
        "zone {:3}  {:8.1f} m2  {} borders{}\n", zone.id, static_cast<double>(zone.cells) * cell_m2,
        map.nodes_of(zone.id).size(), zone.name.empty() ? "" : "  " + zone.name);
  }
}

void print_places_json(const planning::HybridMap& map) {
  nlohmann::ordered_json json = {{"places", nlohmann::ordered_json::array()},
                                 {"zones", nlohmann::ordered_json::array()}};
  for (const planning::Place& place : map.places()) {
    nlohmann::ordered_json one = {
        {"name", place.name}, {"x_m", place.position_m.x()}, {"y_m", place.position_m.y()}};
    if (place.station_heading_rad) one["station_heading_rad"] = *place.station_heading_rad;
    const auto cell = map.frame().cell_of(place.position_m);
    const planning::ZoneId zone = cell ? map.zone_of(*cell) : planning::kNoZone;
    if (zone != planning::kNoZone) one["zone"] = zone;
    json["places"].push_back(std::move(one));
  }
  const double cell_m2 = map.frame().resolution_m * map.frame().resolution_m;
  for (const planning::Zone& zone : map.zones().zones) {
    json["zones"].push_back({{"zone", zone.id},
                             {"name", zone.name},
                             {"area_m2", static_cast<double>(zone.cells) * cell_m2},
                             {"borders", map.nodes_of(zone.id).size()}});
  }
  std::cout << json.dump(2) << '\n';
}

void show_places(const PlacesOptions& options, const planning::HybridMap& map) {
  options.json ? print_places_json(map) : print_places(map);
}

void print_file(const PlacesOptions& options) {
  const pipeline::HybridMapConfig config = read_config(options.config).hybrid_map;
  const storage::MapDocument floor = [&] {
    try {
      return pipeline::read_floor(options.source, options.zones, config.grid.resolution_m);
    } catch (const std::exception& error) {
      throw service::BadInputError(error.what());
    }
  }();
  try {
    show_places(options, pipeline::make_hybrid_map(pipeline::parts_of(floor), config));
  } catch (const std::invalid_argument& error) {
    throw service::BadInputError(options.source + ": " + error.what());
  }
}

/// The live map of the robot. Throws std::runtime_error when none arrives in time.
std::shared_ptr<const planning::HybridMap> live_map(const PlacesOptions& options) {
  const messaging::Participant participant =
      join_for(options.view, "topogeo/places", options.robot_id);
  messaging::EventLoop loop;
  std::shared_ptr<const planning::HybridMap> map;
  std::string defect;
  std::optional<service::LiveHybridMap> live;
  live.emplace(participant, loop, [&](const auto& message, const auto& use) {
    if (message.robot_id() != options.robot_id.c_str()) return;
    try {
      use(message);
      map = live->map();
    } catch (const std::invalid_argument& error) {
      defect = error.what();
    }
    if (map) loop.stop();
  });
  const messaging::SignalStop signals([&](int) { loop.stop(); });
  support::Patience patience(options.wait_s, support::monotonic_s());
  bool stopped = false;
  while (!stopped && !patience.is_over(support::monotonic_s())) stopped = loop.run_for(kMapPoll);
  if (map) return map;
  throw std::runtime_error(
      fmt::format("no hybrid map of robot '{}' on domain {}, partition '{}' within {} s{}{}",
                  options.robot_id, options.view.domain, options.view.partition, options.wait_s,
                  defect.empty() ? "" : " (" + defect + ")", patience.reason()));
}

int places(const PlacesOptions& options) {
  if (!options.added.empty() || !options.removed.empty()) edit(options);
  if (options.source == kLive) {
    if (options.zones) throw service::UsageError("--zones needs a file, not the live map");
    show_places(options, *live_map(options));
  } else {
    print_file(options);
  }
  return service::kOk;
}

}  // namespace

void add_places_command(command_line::Command& app, int& exit_code) {
  command_line::Command* command =
      app.add_subcommand("places", "List places and zones of a file or of the live map");
  auto options = std::make_shared<PlacesOptions>();
  command
      ->add_option("source", options->source,
                   "map file, world (.world.yaml), grid (.yaml with its .pgm) or live")
      ->capture_default_str()
      ->type_name("FILE|live");
  command
      ->add_option("--add", options->added,
                   "add a place to a map file, or move it; with a heading it is a base station")
      ->type_name("NAME=X,Y[,DEG]");
  command->add_option("--remove", options->removed, "remove a place from a map file")
      ->type_name("NAME");
  command->add_option("--zones", options->zones, "drawn zones and places (YAML) beside a file")
      ->type_name("FILE");
  command
      ->add_option("--config", options->config,
                   "configuration (YAML), for its hybrid_map section; files only")
      ->type_name("FILE");
  command->add_flag("--json", options->json, "for programs: places and zones");
  add_robot_option(*command, options->robot_id, "robot of the live map");
  add_domain_options(*command, options->view);
  command->add_option("--wait-seconds", options->wait_s, "how long to wait for the live map")
      ->check(command_line::range(0.1, kLongestWait_s))
      ->capture_default_str();
  command->callback([options, &exit_code] { exit_code = places(*options); });
}

}  // namespace topogeo::cli
