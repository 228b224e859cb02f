#include "map_writer.hpp"

#include <numbers>
#include <optional>
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

MapWriter::MapWriter(const storage::MapDocument& map, const std::filesystem::path& path,
                     const ExportSettings& settings)
    : map_(map), path_(path), settings_(settings) {
  const pipeline::HybridMapConfig& grid = settings.hybrid_map;
  network_.robot_radius_m =
      settings.robot_radius_m.value_or(grid.inflation.forbidden_cells * grid.grid.resolution_m);
  header_.robot_id = map.robot_id;
}

void MapWriter::grid() {
  out_.files = grid_files(path_, hybrid_map().space().seen());
}

void MapWriter::masks() {
  MaskFiles masks = mask_files(path_, hybrid_map().frame(), map_.drawing.zones);
  note(masks.notes);
  out_.files = std::move(masks.files);
}

void MapWriter::geojson() {
  put(geojson_text(map_.global_map, map_.drawing, network()));
}

void MapWriter::lif() {
  LifText lif = lif_text(map_.global_map, map_.drawing, network_, header_);
  note(lif.notes);
  put(std::move(lif.text));
}

void MapWriter::zones() {
  put(zone_set_text(map_.drawing.zones, header_));
}

void MapWriter::rmf() {
  put(rmf_text(network(), map_.drawing.places, header_.map_id, header_.level));
}

void MapWriter::graphml() {
  put(graphml_text(map_.global_map, map_.drawing.places));
}

void MapWriter::g2o() {
  put(g2o_text(map_));
}

void MapWriter::svg() {
  put(results::map_svg(map_, settings_.title, {settings_.odometry, settings_.loops}));
}

void MapWriter::png() {
  put(results::map_png(map_, settings_.title, {settings_.odometry, settings_.loops}));
}

void MapWriter::tum() {
  put(storage::trajectory_tum(topomap::expand_trajectory(map_.trajectory, map_.local_maps)));
}

// Only the log writer can write and compress logs, and only into a file.
void MapWriter::carmen() {
  const StopScans log = stop_scans(map_);
  const support::TemporaryFolder folder("export");
  const std::filesystem::path file = folder.path() / path_.filename();
  scan::CarmenLogWriter writer(file, log.T_robot_laser);
  for (const scan::Scan& scan : log.scans) writer.write(scan);
  writer.close();
  put(support::file_content(file));
  note(
      {fmt::format("beams are up to {:.3f} degrees from the points of the map, {} points "
                   "share a beam with a nearer one",
                   log.angle_error_rad * 180.0 / std::numbers::pi, log.lost_points)});
}

// The same map gives the same bytes, whether its evidence is known or not.
void MapWriter::pb() {
  if (map_.loop_verdicts.empty()) return put(storage::map_file_bytes(map_));
  storage::MapDocument map = map_;
  map.loop_verdicts.clear();
  put(storage::map_file_bytes(map));
}

planning::HybridMap MapWriter::hybrid_map() const {
  return pipeline::make_hybrid_map(pipeline::parts_of(map_), settings_.hybrid_map);
}

RouteNetwork MapWriter::network() {
  std::optional<planning::HybridMap> map;
  if (pipeline::has_grid(pipeline::parts_of(map_))) map = hybrid_map();
  RouteNetwork network =
      route_network(map_.global_map, map_.drawing, map ? &map->space() : nullptr, network_);
  note(network.notes);
  return network;
}

void MapWriter::put(std::string bytes) {
  out_.files = {{path_, std::move(bytes)}};
}

void MapWriter::note(const Notes& notes) {
  out_.notes.insert(out_.notes.end(), notes.begin(), notes.end());
}

}  // namespace topogeo::exchange
