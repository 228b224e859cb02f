// topogeo store align, merge and remove-session: joins and separates maps of one place.
#include <cmath>
#include <exception>
#include <filesystem>
#include <iostream>
#include <memory>
#include <numbers>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/exchange/align.hpp"
#include "topogeo/exchange/merge.hpp"
#include "topogeo/exchange/sessions.hpp"
#include "topogeo/pipeline/hybrid_map_source.hpp"
#include "topogeo/service/service_options.hpp"
#include "topogeo/storage/map_file.hpp"
#include "topogeo/support/format.hpp"

#include "common/configuration.hpp"
#include "common/job.hpp"
#include "common/map_or_grid.hpp"
#include "store/store_commands.hpp"
#include "store/store_files.hpp"

namespace topogeo::cli {
namespace {

namespace fs = std::filesystem;

struct AlignOptions {
  fs::path map;
  fs::path foreign;
  std::optional<fs::path> config;
  bool json = false;
  exchange::AlignSettings settings;
};

/// Reads a map; a world or grid becomes a map of a robot's simulated views.
storage::MapDocument read_with_stops(const fs::path& file, const pipeline::Config& config) {
  if (file.extension() != ".yaml") return read_any_map(file);
  try {
    const bool is_world = file.filename().string().ends_with(".world.yaml");
    return map_with_stops(
        is_world
            ? *pipeline::read_drawing(file, std::nullopt, config.hybrid_map.grid.resolution_m).grid
            : read_grid(file),
        config, "drawing");
  } catch (const std::exception& error) {
    throw service::BadInputError(error.what());
  }
}

void print_alignment(const exchange::Alignment& a, bool json) {
  const geometry::Pose2& T = a.T_map_foreign;
  const double degrees = T.theta_rad * 180.0 / std::numbers::pi;
  // Avoids a minus before a zero.
  const auto shown = [](double value) { return std::fabs(value) < 5e-4 ? 0.0 : value; };
  if (json) {
    const nlohmann::ordered_json out = {{"found", a.found},
                                        {"reason", a.reason},
                                        {"x_m", T.x_m},
                                        {"y_m", T.y_m},
                                        {"theta_rad", T.theta_rad},
                                        {"sigma_m", a.sigma_m},
                                        {"sigma_rad", a.sigma_rad},
                                        {"confidence", a.confidence},
                                        {"rivalry", a.rivalry},
                                        {"stops_searched", a.searched},
                                        {"stops_agreeing", a.agreeing},
                                        {"stops_expected", a.expected},
                                        {"stops_fitting", a.fitting}};
    std::cout << out.dump(2) << '\n';
    return;
  }
  std::cout << fmt::format(
      "{}x {:.3f} m, y {:.3f} m, heading {:.2f} degrees, +- {:.3f} m, {:.2f} degrees\n"
      "confidence {:.2f}: {} of {} stops agree, {} of {} that the map should show fit, next best "
      "pose {:.0f} %\n",
      a.found ? "" : "refused: ", shown(T.x_m), shown(T.y_m), shown(degrees), a.sigma_m,
      a.sigma_rad * 180.0 / std::numbers::pi, a.confidence, a.agreeing, a.searched, a.fitting,
      a.expected, 100.0 * a.rivalry);
  if (!a.found) return;
  std::cout << fmt::format("--pose {:.3f},{:.3f},{:.2f}\n", shown(T.x_m), shown(T.y_m),
                           shown(degrees));
}

int store_align(const AlignOptions& options) {
  const pipeline::Config config = read_config(options.config);
  const storage::MapDocument map = read_with_stops(options.map, config);
  const storage::MapDocument foreign = read_with_stops(options.foreign, config);
  try {
    const exchange::Alignment alignment = exchange::align(map, foreign, options.settings);
    print_alignment(alignment, options.json);
    if (alignment.found) return service::kOk;
    std::cerr << "topogeo: not aligned: " << alignment.reason << '\n';
    return service::kFailure;
  } catch (const std::invalid_argument& error) {
    throw service::BadInputError(error.what());
  }
}

struct MergeOptions {
  fs::path a;
  fs::path b;
  fs::path out;
  std::optional<fs::path> config;
};

int store_merge(const MergeOptions& options) {
  const pipeline::Config config = read_config(options.config);
  const storage::MapDocument a = read_any_map(options.a);
  const storage::MapDocument b = read_any_map(options.b);
  try {
    const exchange::MergedMap merged = exchange::merge(a, b, config);
    print_alignment(merged.alignment, false);
    print_notes(merged.notes);
    if (!merged.merged) return service::kFailure;
    storage::write_map_file(options.out, merged.document);
    std::cout << fmt::format("{} stops joined, {} left out: {} stops, {} loops, {} nodes in {}\n",
                             merged.joined, merged.left_out, merged.document.local_maps.size(),
                             merged.document.loop_closures.size(),
                             merged.document.global_map.nodes.size(), options.out.string());
    return service::kOk;
  } catch (const std::invalid_argument& error) {
    throw service::BadInputError(error.what());
  }
}

struct RemoveOptions {
  fs::path map;
  std::string session;
  fs::path out;
  std::optional<fs::path> config;
};

int store_remove_session(const RemoveOptions& options) {
  const pipeline::Config config = read_config(options.config);
  const auto session = exchange::session_of_text(options.session);
  if (!session) {
    throw service::UsageError(fmt::format(
        "session '{}': expected an id of `topogeo store info`, hexadecimal", options.session));
  }
  const storage::MapDocument map = read_any_map(options.map);
  try {
    const storage::MapDocument rest = exchange::without_session(map, *session, config.global_map);
    storage::write_map_file(options.out, rest);
    std::cout << fmt::format("{} stops removed, {} are left in {}\n",
                             map.local_maps.size() - rest.local_maps.size(), rest.local_maps.size(),
                             options.out.string());
    if (rest.edges.empty()) {
      print_notes({"the map keeps no measurements: the other poses stay as they are"});
    }
    return service::kOk;
  } catch (const std::invalid_argument& error) {
    throw service::BadInputError(options.map.string() + ": " + error.what());
  }
}

}  // namespace

void add_store_join_commands(command_line::Command& store, int& exit_code) {
  command_line::Command* command =
      store.add_subcommand("align", "Find the pose of another map or drawing in a map");
  auto options = std::make_shared<AlignOptions>();
  constexpr const char* kWhat = "map file or database, world (.world.yaml), or grid (.yaml)";
  command->add_option("map", options->map, kWhat)->required()->type_name("MAP");
  command->add_option("foreign", options->foreign, kWhat)->required()->type_name("FOREIGN");
  command->add_flag("--json", options->json, "print all numbers as JSON");
  add_config_option(*command, options->config);
  command->footer(
      "Prints where the origin of FOREIGN is in MAP, for the option --pose of `store import`.\n"
      "Exit codes: 0 found, 1 ambiguous or not found, 3 unusable input.");
  command->callback([options, &exit_code] { exit_code = store_align(*options); });

  command_line::Command* merge = store.add_subcommand("merge", "Merge two maps of one place");
  auto maps = std::make_shared<MergeOptions>();
  merge->add_option("a", maps->a, "map file or database; the result is in its frame")
      ->required()
      ->type_name("A");
  merge->add_option("b", maps->b, "map file or database")->required()->type_name("B");
  merge->add_option("--out", maps->out, "map file to write (map.pb)")->required()->type_name("MAP");
  add_config_option(*merge, maps->config);
  merge->footer(
      "The maps are aligned, then the drives of the smaller one are mapped into the other. A and "
      "B\n"
      "stay as they are. Exit codes: 0 merged, 1 ambiguous or nothing in common, 3 unusable "
      "input.");
  merge->callback([maps, &exit_code] { exit_code = store_merge(*maps); });

  command_line::Command* remove =
      store.add_subcommand("remove-session", "Make a map without the stops of a session");
  auto removed = std::make_shared<RemoveOptions>();
  remove->add_option("map", removed->map, "map file or database")->required()->type_name("MAP");
  remove->add_option("session", removed->session, "id, as `topogeo store info` prints it")
      ->required()
      ->type_name("ID");
  remove->add_option("--out", removed->out, "map file to write (map.pb)")
      ->required()
      ->type_name("MAP");
  add_config_option(*remove, removed->config);
  remove->callback([removed, &exit_code] { exit_code = store_remove_session(*removed); });
}

}  // namespace topogeo::cli
