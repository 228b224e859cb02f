// topogeo store import: converts files of other programs to a map file, or adds them to one.
#include <exception>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/exchange/grid_image.hpp"
#include "topogeo/exchange/grid_map.hpp"
#include "topogeo/exchange/map_formats.hpp"
#include "topogeo/exchange/place_graph.hpp"
#include "topogeo/pipeline/hybrid_map_source.hpp"
#include "topogeo/pipeline/localization_run.hpp"
#include "topogeo/service/service_options.hpp"
#include "topogeo/storage/map_file.hpp"
#include "topogeo/support/cpu_time.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/support/progress_bar.hpp"

#include "common/configuration.hpp"
#include "common/domain_view.hpp"
#include "common/job.hpp"
#include "store/format_list.hpp"
#include "store/store_commands.hpp"
#include "store/store_files.hpp"

namespace topogeo::cli {
namespace {

namespace fs = std::filesystem;

struct ImportOptions {
  fs::path file;
  std::string format;
  fs::path out;
  std::optional<fs::path> into;
  std::optional<std::string> pose;  ///< T_map_file
  std::optional<fs::path> config;
  std::string robot_id = "robot";
  bool with_stops = false;
  std::string pixel_205 = "auto";
  exchange::GridMapSettings grid;
};

exchange::Pixel205 pixel_205_of(const std::string& word) {
  if (word == "unknown") return exchange::Pixel205::kUnknown;
  return word == "threshold" ? exchange::Pixel205::kThreshold : exchange::Pixel205::kAutomatic;
}

geometry::Pose2 pose_of_file(const ImportOptions& options) {
  if (!options.pose) return {};
  try {
    return pipeline::parse_pose(*options.pose);
  } catch (const std::invalid_argument& error) {
    throw service::UsageError(std::string("--pose: ") + error.what());
  }
}

void report_graph(const topomap::GlobalMap& map) {
  if (map.nodes.empty()) {
    std::cerr << "topogeo: the grid has no free place as wide as the robot: the map has no graph\n";
    return;
  }
  const std::size_t parts = exchange::parts_of_graph(map);
  std::cerr << fmt::format(
      "topogeo: {} nodes and {} branches made of the grid, {}\n", map.nodes.size(),
      map.branches.size(),
      parts == 1 ? "all connected" : fmt::format("in {} parts that no free path joins", parts));
}

/// Makes nodes and branches from a grid alone and, if wanted, the stops behind them.
void add_graph(storage::MapDocument& document, const ImportOptions& options,
               const pipeline::Config& config) {
  const planning::FreeSpace space(*document.drawing.grid, config.hybrid_map.inflation);
  exchange::GridMapSettings settings = options.grid;
  settings.fixed_spacing = settings.spacing_m != exchange::GridMapSettings{}.spacing_m;
  // A small grid takes a moment and needs no line.
  constexpr std::size_t kQuick = 200;
  support::ProgressBar bar(std::cerr, support::stderr_is_terminal(), "reading the grid", "stops");
  const double start_s = support::monotonic_s();
  settings.progress = [&](std::size_t done, std::size_t total) {
    if (total < kQuick) return;
    const double elapsed_s = support::monotonic_s() - start_s;
    done < total ? bar.update(done, total - 1, elapsed_s)
                 : bar.finish(done - 1, total - 1, elapsed_s);
  };
  storage::MapDocument made = [&] {
    try {
      return exchange::map_of_grid(space, config.local_mapper, config.global_map, options.robot_id,
                                   settings);
    } catch (const std::runtime_error& error) {
      throw service::BadInputError(options.file.string() + ": " + error.what());
    }
  }();
  report_graph(made.global_map);
  if (options.with_stops) {
    made.drawing = std::move(document.drawing);
    document = std::move(made);
  } else {
    document.global_map = std::move(made.global_map);
    document.trajectory.version = made.trajectory.version;
  }
}

/// The given format, or the one that the file seems to have.
const exchange::MapFormat& format_of(const ImportOptions& options) {
  if (!options.format.empty()) {
    return exchange::format_named(exchange::import_formats(), options.format);
  }
  try {
    const exchange::FormatGuess guess = exchange::guess_import_format(options.file);
    std::cerr << fmt::format("topogeo: {}: read as '{}', because {} (--format names another)\n",
                             options.file.string(), guess.format, guess.reason);
    return exchange::format_named(exchange::import_formats(), guess.format);
  } catch (const std::runtime_error& error) {
    throw service::BadInputError(error.what());
  }
}

int store_import(const ImportOptions& options) {
  const geometry::Pose2 T_map_file = pose_of_file(options);
  const pipeline::Config config = read_config(options.config);
  storage::MapDocument document;
  document.robot_id = options.robot_id;
  if (options.into) document = read_any_map(*options.into);
  const exchange::MapFormat& format = format_of(options);
  try {
    exchange::MapGraph graph =
        format.read(options.file, {.resolution_m = config.hybrid_map.grid.resolution_m,
                                   .pixel_205 = pixel_205_of(options.pixel_205)});
    exchange::Notes notes = std::move(graph.notes);
    exchange::move(graph, T_map_file);
    exchange::lay_over(document, std::move(graph), notes);
    storage::check(document.drawing);
    print_notes(notes);
  } catch (const std::exception& error) {
    throw service::BadInputError(error.what());
  }
  const bool bare = document.local_maps.empty() && document.global_map.nodes.empty();
  if (bare && document.drawing.grid) add_graph(document, options, config);
  const pipeline::HybridMapParts parts = pipeline::parts_of(document);
  if (exchange::lacks_clearances(document.global_map) && pipeline::has_grid(parts)) {
    exchange::take_clearances(document.global_map,
                              pipeline::make_hybrid_map(parts, config.hybrid_map).space());
  }
  storage::write_map_file(options.out, document);
  return service::kOk;
}

}  // namespace

void add_store_import_command(command_line::Command& store, int& exit_code) {
  command_line::Command* command =
      store.add_subcommand("import", "Make a map file from a file of another program");
  auto options = std::make_shared<ImportOptions>();
  command->add_option("file", options->file, "file to read")->required()->type_name("FILE");
  const std::span<const exchange::MapFormat> formats = exchange::import_formats();
  command
      ->add_option("--format", options->format,
                   "format of the file, see below; default: by its content")
      ->check(command_line::one_of(names_of(formats)))
      ->type_name("FORMAT");
  command->add_option("--out", options->out, "map file to write (map.pb)")
      ->required()
      ->type_name("MAP");
  command
      ->add_option("--into", options->into,
                   "map to merge the file into: its grid, places and zones of the same names, and "
                   "the graph of a map without stops are replaced; not changed unless it is also "
                   "--out")
      ->type_name("MAP");
  command
      ->add_option("--pose", options->pose,
                   "pose of the origin of the file in the map; default: 0,0,0")
      ->type_name("X,Y,DEG");
  add_config_option(*command, options->config);
  add_robot_option(*command, options->robot_id, "robot of a map without --into");
  command->add_flag("--with-stops", options->with_stops,
                    "for grids: keep the stops that the graph is made from, so that robots can "
                    "localize in the map (topogeo localize --map)");
  command
      ->add_option(
          "--pixel-205", options->pixel_205,
          "for grids: read pixels of 205, which map_saver writes for unknown, as 'unknown' "
          "or by the 'threshold's of the YAML; 'auto': unknown if the image has only the "
          "values of map_saver")
      ->check(command_line::one_of({"auto", "unknown", "threshold"}))
      ->capture_default_str()
      ->type_name("HOW");
  constexpr double kMost_m = 100.0;
  command
      ->add_option("--spacing", options->grid.spacing_m,
                   "for grids: distance between the places that the graph is made from, metres; "
                   "the default grows with grids of more than 3,000 places")
      ->check(command_line::range(0.2, kMost_m))
      ->capture_default_str()
      ->type_name("M");
  command
      ->add_option("--range", options->grid.range_m,
                   "for grids: range of the virtual laser at these places, metres")
      ->check(command_line::range(1.0, kMost_m))
      ->capture_default_str()
      ->type_name("M");
  command->footer(help_of(formats, &exchange::MapFormat::read_help) +
                  "A grid becomes a map with nodes and branches.");
  command->callback([options, &exit_code] { exit_code = store_import(*options); });
}

}  // namespace topogeo::cli
