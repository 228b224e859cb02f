// topogeo store export: a map in the form of another program.
#include <chrono>
#include <exception>
#include <filesystem>
#include <iostream>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/exchange/carmen.hpp"
#include "topogeo/exchange/g2o.hpp"
#include "topogeo/exchange/geojson.hpp"
#include "topogeo/exchange/graphml.hpp"
#include "topogeo/exchange/grid_image.hpp"
#include "topogeo/exchange/lif.hpp"
#include "topogeo/exchange/masks.hpp"
#include "topogeo/exchange/rmf.hpp"
#include "topogeo/exchange/route_network.hpp"
#include "topogeo/exchange/zone_set.hpp"
#include "topogeo/pipeline/hybrid_map_source.hpp"
#include "topogeo/results/outputs.hpp"
#include "topogeo/scan/carmen_log_writer.hpp"
#include "topogeo/service/service_options.hpp"
#include "topogeo/storage/map_file.hpp"
#include "topogeo/storage/tum.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/topomap/trajectory.hpp"

#include "store_commands.hpp"
#include "store_files.hpp"

namespace topogeo::cli {
namespace {

namespace fs = std::filesystem;

struct ExportOptions {
  fs::path file;
  std::string format;
  fs::path out;
  std::optional<fs::path> config;
  std::optional<double> robot_radius_m;
  exchange::NetworkSettings network;
  exchange::ExportHeader header;
};

/// The map and what is made of it when a format needs it.
class ExportSource {
 public:
  explicit ExportSource(const ExportOptions& options)
      : options_(options),
        config_(read_config(options.config)),
        document_(read_any_map(options.file)) {}

  [[nodiscard]] const storage::MapDocument& document() const { return document_; }

  planning::HybridMap hybrid_map() const {
    try {
      return pipeline::make_hybrid_map(pipeline::parts_of(document_), config_.hybrid_map);
    } catch (const std::invalid_argument& error) {
      throw service::BadInputError(options_.file.string() + ": " + error.what());
    }
  }

  [[nodiscard]] exchange::NetworkSettings settings() const {
    exchange::NetworkSettings settings = options_.network;
    const pipeline::HybridMapConfig& grid = config_.hybrid_map;
    settings.robot_radius_m =
        options_.robot_radius_m.value_or(grid.inflation.forbidden_cells * grid.grid.resolution_m);
    return settings;
  }

  [[nodiscard]] exchange::ExportHeader header() const {
    exchange::ExportHeader header = options_.header;
    header.robot_id = document_.robot_id;
    header.stamp_ns = std::chrono::duration_cast<std::chrono::nanoseconds>(
                          std::chrono::system_clock::now().time_since_epoch())
                          .count();
    return header;
  }

  [[nodiscard]] exchange::RouteNetwork network() const {
    std::optional<planning::HybridMap> map;
    if (pipeline::has_grid(pipeline::parts_of(document_))) map = hybrid_map();
    exchange::RouteNetwork network = exchange::route_network(
        document_.global_map, document_.drawing, map ? &map->space() : nullptr, settings());
    print_notes(network.notes);
    return network;
  }

 private:
  const ExportOptions& options_;
  pipeline::Config config_;
  storage::MapDocument document_;
};

/// Nothing in the folder when it fails: the log is made beside and renamed.
void write_carmen(const fs::path& out, const storage::MapDocument& document) {
  const exchange::StopScans log = exchange::stop_scans(document);
  const fs::path unfinished = out.parent_path() / (".unfinished-" + out.filename().string());
  try {
    scan::CarmenLogWriter writer(unfinished, log.T_robot_laser);
    for (const scan::Scan& scan : log.scans) writer.write(scan);
    writer.close();
    fs::rename(unfinished, out);
  } catch (...) {
    std::error_code ignored;
    fs::remove(unfinished, ignored);
    throw;
  }
  print_notes(
      {fmt::format("beams are up to {:.3f} degrees from the points of the map, {} points "
                   "share a beam with a nearer one",
                   log.angle_error_rad * 180.0 / std::numbers::pi, log.lost_points)});
}

/// The files of a format; none where it is written otherwise.
std::vector<exchange::OutputFile> files_of(const ExportOptions& options,
                                           const ExportSource& source) {
  const storage::MapDocument& map = source.document();
  const std::string& format = options.format;
  if (format == "pgm") return exchange::grid_files(options.out, source.hybrid_map().space().grid());
  if (format == "geojson") {
    return {{options.out, exchange::geojson_text(map.global_map, map.drawing, source.network())}};
  }
  if (format == "graphml") {
    return {{options.out, exchange::graphml_text(map.global_map, map.drawing.places)}};
  }
  if (format == "lif") {
    exchange::LifText lif =
        exchange::lif_text(map.global_map, map.drawing, source.settings(), source.header());
    print_notes(lif.notes);
    return {{options.out, std::move(lif.text)}};
  }
  if (format == "zones") {
    return {{options.out, exchange::zone_set_text(map.drawing.zones, source.header())}};
  }
  if (format == "rmf") {
    return {{options.out, exchange::rmf_text(source.network(), map.drawing.places,
                                             options.header.map_id, options.header.level)}};
  }
  if (format == "masks") {
    exchange::MaskFiles masks =
        exchange::mask_files(options.out, source.hybrid_map().frame(), map.drawing.zones);
    print_notes(masks.notes);
    return std::move(masks.files);
  }
  const std::string title = options.file.filename().string();
  if (format == "svg") return {{options.out, results::map_svg(map, title)}};
  if (format == "png") return {{options.out, results::map_png(map, title)}};
  if (format == "g2o") return {{options.out, exchange::g2o_text(map)}};
  if (format == "tum") {
    return {{options.out,
             storage::trajectory_tum(topomap::expand_trajectory(map.trajectory, map.local_maps))}};
  }
  if (format == "pb") return {{options.out, storage::map_file_bytes(map)}};
  return {};
}

int store_export(const ExportOptions& options) {
  const ExportSource source(options);
  try {
    if (options.format == "carmen") {
      write_carmen(options.out, source.document());
    } else {
      exchange::write_files(files_of(options, source));
    }
  } catch (const std::invalid_argument& error) {
    throw service::BadInputError(options.file.string() + ": " + error.what());
  }
  return service::kOk;
}

}  // namespace

void add_store_export_command(command_line::Command& store, int& exit_code) {
  command_line::Command* command =
      store.add_subcommand("export", "Write a map in the form of another program");
  auto options = std::make_shared<ExportOptions>();
  command->add_option("file", options->file, "map file or database")->required()->type_name("FILE");
  command->add_option("--format", options->format, "what to write, see below")
      ->required()
      ->check(command_line::one_of({"pgm", "masks", "geojson", "lif", "zones", "rmf", "graphml",
                                    "svg", "png", "g2o", "tum", "carmen", "pb"}))
      ->type_name("FORMAT");
  command->add_option("--out", options->out, "file to write, or the name that several begin with")
      ->required()
      ->type_name("PATH");
  command
      ->add_option("--config", options->config, "configuration (YAML), for its hybrid_map section")
      ->type_name("FILE");
  constexpr double kWidest_m = 10.0;
  command
      ->add_option("--robot-radius", options->robot_radius_m,
                   "of graphs: where the robot is wider than the way, edges are left out, metres; "
                   "default: what the configuration forbids around obstacles")
      ->check(command_line::range(0.0, kWidest_m))
      ->type_name("M");
  command
      ->add_option("--tolerance", options->network.tolerance_m,
                   "of graphs: how far a straight edge may pass from the branch, metres")
      ->check(command_line::range(0.0, 1.0))
      ->capture_default_str()
      ->type_name("M");
  command->add_flag("--with-virtual", options->network.with_virtual,
                    "of graphs: also branches that no scan has seen");
  command->add_flag("--only-free", options->network.only_free,
                    "of graphs: leave out edges that the grid forbids");
  command
      ->add_option("--map-id", options->header.map_id,
                   "of lif, zones and rmf: how robots and fleet managers call the map")
      ->capture_default_str()
      ->type_name("NAME");
  command->add_option("--level", options->header.level, "of lif and rmf: level of the building")
      ->capture_default_str()
      ->type_name("NAME");
  command
      ->add_option("--manufacturer", options->header.manufacturer, "of lif and zones: who made it")
      ->capture_default_str()
      ->type_name("NAME");
  command->footer(
      "pgm      grid as PATH.pgm and PATH.yaml, for map_server of ROS\n"
      "geojson  graph, places and zones, for the route server of Nav2\n"
      "masks    PATH_keepout and PATH_speed, zones for costmap filters of Nav2\n"
      "lif      graph and places in the Layout Interchange Format 1.0.0 of the VDMA\n"
      "zones    zones as a zone set of VDA 5050 3.0\n"
      "rmf      graph as a navigation graph of Open-RMF (YAML)\n"
      "svg, png the picture of the map\n"
      "graphml  the graph without loss, for graph programs\n"
      "g2o      pose graph of the stops\n"
      "tum      corrected pose of each scan\n"
      "carmen   scans of the stops as a log (gzip when PATH ends in .gz)\n"
      "pb       the whole map as a map file (map.pb)\n"
      "docs/exchange.md says of each what is written and what is lost.");
  command->callback([options, &exit_code] { exit_code = store_export(*options); });
}

}  // namespace topogeo::cli
