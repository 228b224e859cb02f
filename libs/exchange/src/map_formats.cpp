#include "topogeo/exchange/map_formats.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "topogeo/exchange/geojson.hpp"
#include "topogeo/exchange/graphml.hpp"
#include "topogeo/exchange/grid_image.hpp"
#include "topogeo/exchange/grid_map.hpp"
#include "topogeo/exchange/lif.hpp"
#include "topogeo/exchange/read_text.hpp"
#include "topogeo/exchange/zone_set.hpp"
#include "topogeo/pipeline/hybrid_map_source.hpp"

#include "map_writer.hpp"

namespace topogeo::exchange {
namespace {

namespace fs = std::filesystem;

template <void (MapWriter::*Form)()>
ExportedMap write_as(const storage::MapDocument& map, const fs::path& path,
                     const ExportSettings& settings) {
  MapWriter writer(map, path, settings);
  (writer.*Form)();
  return writer.take();
}

/// Reads a text of a format without settings.
template <MapGraph (*Parse)(std::string_view, const std::string&)>
MapGraph read_as(const fs::path& file, const ImportSettings& /*settings*/) {
  return Parse(read_text(file), file.string());
}

MapGraph parse_zones(std::string_view text, const std::string& name) {
  ZoneSet set = parse_zone_set(text, name);
  MapGraph graph;
  graph.drawing.zones = std::move(set.zones);
  graph.notes = std::move(set.notes);
  storage::check(graph.drawing);
  return graph;
}

/// The YAML file of a grid: the given one, or that beside a given image.
fs::path yaml_of_grid(const fs::path& file) {
  constexpr std::array<std::string_view, 3> kImages = {".pgm", ".png", ".bmp"};
  if (std::ranges::find(kImages, file.extension().string()) == kImages.end()) return file;
  fs::path yaml = file;
  yaml.replace_extension(".yaml");
  if (fs::exists(yaml)) return yaml;
  throw std::runtime_error(file.string() + ": an image alone has no scale: expected '" +
                           yaml.string() + "' beside it, the YAML file of map_server");
}

MapGraph read_grid_as_map(const fs::path& file, const ImportSettings& settings) {
  GridImage image = read_grid_image(yaml_of_grid(file), settings.pixel_205);
  MapGraph graph;
  graph.drawing.grid = occupancy_of(image);
  graph.notes = std::move(image.notes);
  return graph;
}

/// Reads a drawing of this project: a world, or zones and places.
MapGraph read_own_drawing(const fs::path& file, const ImportSettings& settings) {
  MapGraph graph;
  graph.drawing = file.filename().string().ends_with(".world.yaml")
                      ? pipeline::read_drawing(file, std::nullopt, settings.resolution_m)
                      : pipeline::read_zones_and_places(file);
  try {
    if (graph.drawing.grid) check_grid_size(graph.drawing.grid->frame());
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(file.string() + ": " + error.what());
  }
  return graph;
}

const std::vector<MapFormat>& map_formats() {
  static const std::vector<MapFormat> kFormats = {
      {.name = "pgm",
       .endings = {".pgm", ".yaml"},
       .write_help = "grid as PATH.pgm and PATH.yaml, for map_server of ROS",
       .write = write_as<&MapWriter::grid>,
       .read_help = "image (PGM, PNG, BMP) and YAML of map_server (FILE is either of them), "
                    "modes trinary, scale, raw",
       .read = read_grid_as_map},
      {.name = "masks",
       .endings = {"_keepout.pgm", "_keepout.yaml", "_speed.pgm", "_speed.yaml"},
       .write_help = "PATH_keepout and PATH_speed, zones for costmap filters of Nav2",
       .write = write_as<&MapWriter::masks>},
      {.name = "geojson",
       .endings = {".geojson"},
       .write_help = "graph, places and zones, for the route server of Nav2",
       .write = write_as<&MapWriter::geojson>,
       .read_help = "graph, places and zones of Nav2's route server",
       .read = read_as<parse_geojson>},
      {.name = "lif",
       .endings = {".lif.json"},
       .write_help = "graph and places in the Layout Interchange Format 1.0.0 of the VDMA",
       .write = write_as<&MapWriter::lif>,
       .read_help = "graph and stations of a layout (1.0.0, draft of 2.0)",
       .read = read_as<parse_lif>},
      {.name = "zones",
       .endings = {".zones.json"},
       .write_help = "zones as a zone set of VDA 5050 3.0",
       .write = write_as<&MapWriter::zones>,
       .read_help = "zone set of VDA 5050 3.0",
       .read = read_as<parse_zones>},
      {.name = "rmf",
       .endings = {".rmf.yaml"},
       .write_help = "graph as a navigation graph of Open-RMF (YAML)",
       .write = write_as<&MapWriter::rmf>},
      {.name = "graphml",
       .endings = {".graphml"},
       .write_help = "the graph without loss, for graph programs",
       .write = write_as<&MapWriter::graphml>,
       .read_help = "graph; nodes need x and y",
       .read = read_as<parse_graphml>},
      {.name = "g2o",
       .endings = {".g2o"},
       .write_help = "pose graph of the stops",
       .write = write_as<&MapWriter::g2o>},
      {.name = "svg",
       .endings = {".svg"},
       .write_help = "the picture of the map",
       .write = write_as<&MapWriter::svg>},
      {.name = "png",
       .endings = {".png"},
       .write_help = "the picture of the map",
       .write = write_as<&MapWriter::png>},
      {.name = "tum",
       .endings = {".tum"},
       .write_help = "corrected pose of each scan",
       .write = write_as<&MapWriter::tum>},
      {.name = "carmen",
       .endings = {".clf.gz"},
       .write_help = "scans of the stops as a log (gzip when PATH ends in .gz)",
       .write = write_as<&MapWriter::carmen>},
      {.name = "pb",
       .endings = {".pb"},
       .write_help = "the whole map as a map file (map.pb)",
       .write = write_as<&MapWriter::pb>},
      {.name = "drawing",
       .read_help = "a world (.world.yaml), or zones and places (.yaml)",
       .read = read_own_drawing},
  };
  return kFormats;
}

template <class Condition>
std::vector<MapFormat> formats_with(const Condition& condition) {
  std::vector<MapFormat> found;
  std::ranges::copy_if(map_formats(), std::back_inserter(found), condition);
  return found;
}

}  // namespace

std::span<const MapFormat> export_formats() {
  static const std::vector<MapFormat> kWritten =
      formats_with([](const MapFormat& format) { return format.write != nullptr; });
  return kWritten;
}

std::span<const MapFormat> import_formats() {
  static const std::vector<MapFormat> kRead =
      formats_with([](const MapFormat& format) { return format.read != nullptr; });
  return kRead;
}

const MapFormat& format_named(std::span<const MapFormat> formats, std::string_view name) {
  const auto found = std::ranges::find(formats, name, &MapFormat::name);
  if (found == formats.end()) {
    throw std::invalid_argument("unknown format '" + std::string(name) + "'");
  }
  return *found;
}

}  // namespace topogeo::exchange
