#include "topogeo/exchange/map_export.hpp"

#include <map>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "topogeo/exchange/carmen.hpp"
#include "topogeo/exchange/g2o.hpp"
#include "topogeo/exchange/geojson.hpp"
#include "topogeo/exchange/graphml.hpp"
#include "topogeo/exchange/grid_image.hpp"
#include "topogeo/exchange/lif.hpp"
#include "topogeo/exchange/masks.hpp"
#include "topogeo/exchange/rmf.hpp"
#include "topogeo/exchange/zone_set.hpp"
#include "topogeo/pipeline/hybrid_map_source.hpp"
#include "topogeo/results/outputs.hpp"
#include "topogeo/scan/carmen_log_writer.hpp"
#include "topogeo/storage/map_file.hpp"
#include "topogeo/storage/tum.hpp"
#include "topogeo/support/file_content.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/support/temporary_folder.hpp"
#include "topogeo/topomap/trajectory.hpp"

namespace topogeo::exchange {
namespace {

namespace fs = std::filesystem;

/// The map, and its derived data, made when a format needs them.
class MapExport {
 public:
  MapExport(const storage::MapDocument& map, const fs::path& path, const ExportSettings& settings)
      : map_(map), path_(path), settings_(settings) {
    const pipeline::HybridMapConfig& grid = settings.hybrid_map;
    network_.robot_radius_m =
        settings.robot_radius_m.value_or(grid.inflation.forbidden_cells * grid.grid.resolution_m);
    header_.robot_id = map.robot_id;
  }

  void grid() { out_.files = grid_files(path_, hybrid_map().space().seen()); }
  void masks() {
    MaskFiles masks = mask_files(path_, hybrid_map().frame(), map_.drawing.zones);
    note(masks.notes);
    out_.files = std::move(masks.files);
  }
  void geojson() { put(geojson_text(map_.global_map, map_.drawing, network())); }
  void graphml() { put(graphml_text(map_.global_map, map_.drawing.places)); }
  void lif() {
    LifText lif = lif_text(map_.global_map, map_.drawing, network_, header_);
    note(lif.notes);
    put(std::move(lif.text));
  }
  void zones() { put(zone_set_text(map_.drawing.zones, header_)); }
  void rmf() { put(rmf_text(network(), map_.drawing.places, header_.map_id, header_.level)); }
  void svg() { put(results::map_svg(map_, settings_.title)); }
  void png() { put(results::map_png(map_, settings_.title)); }
  void g2o() { put(g2o_text(map_)); }
  void tum() {
    put(storage::trajectory_tum(topomap::expand_trajectory(map_.trajectory, map_.local_maps)));
  }
  void pb() { put(storage::map_file_bytes(map_)); }
  void carmen();

  ExportedMap take() { return std::move(out_); }

 private:
  [[nodiscard]] planning::HybridMap hybrid_map() const {
    return pipeline::make_hybrid_map(pipeline::parts_of(map_), settings_.hybrid_map);
  }
  RouteNetwork network() {
    std::optional<planning::HybridMap> map;
    if (pipeline::has_grid(pipeline::parts_of(map_))) map = hybrid_map();
    RouteNetwork network =
        route_network(map_.global_map, map_.drawing, map ? &map->space() : nullptr, network_);
    note(network.notes);
    return network;
  }
  void put(std::string bytes) { out_.files = {{path_, std::move(bytes)}}; }
  void note(const Notes& notes) { out_.notes.insert(out_.notes.end(), notes.begin(), notes.end()); }

  const storage::MapDocument& map_;
  fs::path path_;
  const ExportSettings& settings_;
  NetworkSettings network_ = settings_.network;
  ExportHeader header_ = settings_.header;
  ExportedMap out_;
};

// Only the log writer can write and compress logs, and only into a file.
void MapExport::carmen() {
  const StopScans log = stop_scans(map_);
  const support::TemporaryFolder folder("export");
  const fs::path file = folder.path() / path_.filename();
  scan::CarmenLogWriter writer(file, log.T_robot_laser);
  for (const scan::Scan& scan : log.scans) writer.write(scan);
  writer.close();
  put(support::file_content(file));
  note(
      {fmt::format("beams are up to {:.3f} degrees from the points of the map, {} points "
                   "share a beam with a nearer one",
                   log.angle_error_rad * 180.0 / std::numbers::pi, log.lost_points)});
}

using Form = void (MapExport::*)();
const std::map<std::string_view, Form>& forms() {
  static const std::map<std::string_view, Form> forms = {
      {"pgm", &MapExport::grid},        {"masks", &MapExport::masks},
      {"geojson", &MapExport::geojson}, {"lif", &MapExport::lif},
      {"zones", &MapExport::zones},     {"rmf", &MapExport::rmf},
      {"graphml", &MapExport::graphml}, {"g2o", &MapExport::g2o},
      {"svg", &MapExport::svg},         {"png", &MapExport::png},
      {"tum", &MapExport::tum},         {"carmen", &MapExport::carmen},
      {"pb", &MapExport::pb},
  };
  return forms;
}

}  // namespace

std::span<const ExportFormat> export_formats() {
  static const std::vector<ExportFormat> formats = {
      {"pgm", {".pgm", ".yaml"}},
      {"masks", {"_keepout.pgm", "_keepout.yaml", "_speed.pgm", "_speed.yaml"}},
      {"geojson", {".geojson"}},
      {"lif", {".lif.json"}},
      {"zones", {".zones.json"}},
      {"rmf", {".rmf.yaml"}},
      {"graphml", {".graphml"}},
      {"g2o", {".g2o"}},
      {"svg", {".svg"}},
      {"png", {".png"}},
      {"tum", {".tum"}},
      {"carmen", {".clf.gz"}},
      {"pb", {".pb"}},
  };
  return formats;
}

ExportedMap export_map(const storage::MapDocument& map, std::string_view format,
                       const fs::path& path, const ExportSettings& settings) {
  const auto form = forms().find(format);
  if (form == forms().end()) {
    throw std::invalid_argument("unknown format '" + std::string(format) + "'");
  }
  MapExport maker(map, path, settings);
  (maker.*form->second)();
  return maker.take();
}

}  // namespace topogeo::exchange
