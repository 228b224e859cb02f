#include "topogeo/pipeline/hybrid_map_source.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "topogeo/pipeline/world_grid.hpp"
#include "topogeo/planning/drawn_and_found_rooms.hpp"
#include "topogeo/planning/grid_file.hpp"
#include "topogeo/storage/read_map.hpp"

namespace topogeo::pipeline {

namespace {

planning::OccupancyGrid make_grid(const HybridMapParts& parts, const HybridMapConfig& config) {
  if (parts.drawing != nullptr && parts.drawing->grid) {
    return planning::grid_of_both(*parts.drawing->grid, parts.local_maps, parts.stops, config.grid);
  }
  return planning::grid_from_scans(parts.local_maps, parts.stops, config.grid);
}

planning::ZoneMap make_zones(const planning::FreeSpace& space, const HybridMapParts& parts,
                             const planning::ZoneConfig& config) {
  std::vector<planning::DrawnZone> rooms;
  if (parts.drawing != nullptr) rooms = parts.drawing->zones;
  std::erase_if(rooms, [](const auto& zone) { return zone.kind != planning::ZoneKind::kRoom; });
  std::vector<planning::Passage> passages;
  if (parts.global_map != nullptr) passages = planning::passages_of(*parts.global_map);
  return planning::zones_of_drawn_and_found_rooms(space, rooms, passages, config);
}

/// A hybrid map without the route searches through its zones.
struct Rooms {
  planning::FreeSpace space;
  planning::ZoneMap zones;
  std::vector<planning::Place> places;
};

Rooms find_rooms(const HybridMapParts& parts, const HybridMapConfig& config,
                 planning::RoomNumbers& numbers) {
  check(config);
  const storage::MapDrawing nothing;
  const storage::MapDrawing& drawing = parts.drawing != nullptr ? *parts.drawing : nothing;
  planning::FreeSpace space(make_grid(parts, config), config.inflation, drawing.zones,
                            drawing.lines);
  planning::ZoneMap zones = make_zones(space, parts, config.zones);
  std::vector<planning::Place> places = drawing.places;
  const bool drawn_grid = drawing.grid.has_value();
  numbers.assign(space, drawn_grid ? std::span<const topomap::StopPose>{} : parts.stops, zones,
                 places);
  return {std::move(space), std::move(zones), std::move(places)};
}

planning::RoomNumbers numbers_of(const HybridMapParts& parts) {
  return planning::RoomNumbers(parts.rooms != nullptr ? *parts.rooms : planning::RoomMemory{});
}

/// The same cells at another pose.
planning::OccupancyGrid moved(const planning::OccupancyGrid& grid, const geometry::Pose2& T) {
  planning::GridFrame frame = grid.frame();
  frame.T_map_grid = T * frame.T_map_grid;
  planning::OccupancyGrid out(frame);
  for (std::size_t i = 0; i < frame.size(); ++i) out.set(frame.cell_at(i), grid.cells()[i]);
  return out;
}

bool is_world(const std::filesystem::path& file) {
  return file.filename().string().ends_with(".world.yaml");
}

template <typename Named>
void replace_or_add(std::vector<Named>& entries, std::vector<Named> added) {
  for (Named& entry : added) {
    const auto same = std::ranges::find(entries, entry.name, &Named::name);
    if (same == entries.end()) {
      entries.push_back(std::move(entry));
    } else {
      *same = std::move(entry);
    }
  }
}

void check_drawing(const std::filesystem::path& file, const storage::MapDrawing& drawing) {
  try {
    storage::check(drawing);
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(file.string() + ": " + error.what());
  }
}

storage::MapDrawing drawing_of_file(const std::filesystem::path& file, double resolution_m) {
  storage::MapDrawing drawing;
  if (!is_world(file)) {
    drawing.grid = planning::read_grid(file);
    return drawing;
  }
  const world::World world = world::load_world(file);
  try {
    drawing.grid = planning::grid_of(drawing_of(world), resolution_m);
  } catch (const std::invalid_argument& error) {
    throw std::runtime_error(file.string() + ": " + error.what());
  }
  for (const world::NamedPlace& place : world.places) {
    drawing.places.push_back({place.name, place.position_m, place.station_heading_rad});
  }
  return drawing;
}

}  // namespace

void check(const HybridMapConfig& config) {
  planning::check(config.grid);
  planning::check(config.inflation);
  planning::check(config.zones);
}

HybridMapParts parts_of(const storage::MapDocument& document) {
  return {document.local_maps, document.trajectory.stops, &document.global_map, &document.drawing,
          &document.rooms};
}

bool has_grid(const HybridMapParts& parts) {
  if (parts.drawing != nullptr && parts.drawing->grid) return true;
  for (std::size_t i = 0; i < std::min(parts.stops.size(), parts.local_maps.size()); ++i) {
    if (parts.stops[i].located && !parts.local_maps[i].points.empty()) return true;
  }
  return false;
}

planning::HybridMap make_hybrid_map(const HybridMapParts& parts, const HybridMapConfig& config,
                                    planning::RoomNumbers* rooms) {
  planning::RoomNumbers numbers = numbers_of(parts);
  Rooms found = find_rooms(parts, config, rooms != nullptr ? *rooms : numbers);
  return {std::move(found.space), std::move(found.zones), std::move(found.places)};
}

void remember_rooms(storage::MapDocument& document, const HybridMapConfig& config) {
  const HybridMapParts parts = parts_of(document);
  if (!has_grid(parts)) return;
  planning::RoomNumbers rooms = numbers_of(parts);
  try {
    static_cast<void>(find_rooms(parts, config, rooms));
  } catch (const std::invalid_argument&) {  // for instance if the floor is too large
    return;
  }
  document.rooms = rooms.memory();
}

void move(storage::MapDrawing& drawing, const geometry::Pose2& T) {
  if (T == geometry::Pose2{}) return;  // keeps every bit
  for (planning::Place& place : drawing.places) place = planning::moved(place, T);
  for (planning::DrawnZone& zone : drawing.zones) {
    for (Eigen::Vector2d& corner : zone.polygon_m) corner = T * corner;
    if (zone.kind == planning::ZoneKind::kOneWay) {
      zone.value = geometry::wrap_angle(zone.value + T.theta_rad);
    }
  }
  for (planning::DrawnLine& line : drawing.lines) {
    for (Eigen::Vector2d& point : line.points_m) point = T * point;
  }
  if (drawing.grid) drawing.grid = moved(*drawing.grid, T);
}

storage::MapDrawing read_drawing(const std::filesystem::path& file,
                                 const std::optional<std::filesystem::path>& zones,
                                 double resolution_m, const geometry::Pose2& T_map_drawing) {
  storage::MapDrawing drawing = drawing_of_file(file, resolution_m);
  if (zones) lay_over(drawing, read_zones_and_places(*zones));
  try {
    move(drawing, T_map_drawing);
  } catch (const std::invalid_argument& error) {
    throw std::runtime_error(file.string() + ": " + error.what());
  }
  check_drawing(file, drawing);
  return drawing;
}

storage::MapDrawing read_zones_and_places(const std::filesystem::path& file) {
  planning::ZoneDrawing read = planning::read_zone_drawing(file);
  storage::MapDrawing drawing;
  drawing.places = std::move(read.places);
  drawing.zones = std::move(read.zones);
  drawing.lines = std::move(read.lines);
  check_drawing(file, drawing);
  return drawing;
}

void lay_over(storage::MapDrawing& drawing, storage::MapDrawing added) {
  if (added.grid) drawing.grid = std::move(added.grid);
  replace_or_add(drawing.places, std::move(added.places));
  replace_or_add(drawing.zones, std::move(added.zones));
  for (planning::DrawnLine& line : added.lines) {
    if (std::ranges::find(drawing.lines, line) == drawing.lines.end()) {
      drawing.lines.push_back(std::move(line));
    }
  }
}

storage::MapDocument read_floor(const std::filesystem::path& file,
                                const std::optional<std::filesystem::path>& zones,
                                double resolution_m) {
  storage::MapDocument document;
  if (is_world(file) || file.extension() == ".yaml") {
    document.drawing = read_drawing(file, zones, resolution_m);
    return document;
  }
  document = storage::read_map(file);
  if (zones) lay_over(document.drawing, read_zones_and_places(*zones));
  return document;
}

}  // namespace topogeo::pipeline
