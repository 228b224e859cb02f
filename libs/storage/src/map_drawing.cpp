#include "topogeo/storage/map_drawing.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>

#include <nlohmann/json.hpp>
#include <zlib.h>

#include "topogeo/support/format.hpp"

#include "map_conversions.hpp"

namespace topogeo::storage {
namespace {

// Farther away double rounding shows in pictures; no building is as large.
constexpr double kMaxCoordinate_m = 1e6;
constexpr std::size_t kLeastCorners = 3;  // of an area

template <typename... Args>
void require_drawing(bool condition, fmt::format_string<Args...> format, Args&&... args) {
  if (!condition) throw std::runtime_error(fmt::format(format, std::forward<Args>(args)...));
}

bool is_printable(const std::string& text) {
  const auto is_control = [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; };
  if (std::ranges::any_of(text, is_control)) return false;
  try {
    static_cast<void>(nlohmann::json(text).dump());  // throws unless it is UTF-8
    return true;
  } catch (const nlohmann::json::exception&) {
    return false;
  }
}

void check_name(const char* what, const std::string& name, std::set<std::string>& taken) {
  require_drawing(is_printable(name), "{} with a name that is no printable UTF-8", what);
  require_drawing(!name.empty() && name.size() <= kMaxNameBytes,
                  "{} '{}': expected a name of 1 to {} bytes", what, name, kMaxNameBytes);
  require_drawing(taken.insert(name).second, "{} '{}': the name is taken", what, name);
}

void check_point(const char* what, const std::string& name, const Eigen::Vector2d& point_m) {
  for (const double value : {point_m.x(), point_m.y()}) {
    // Also false for what is not a number.
    require_drawing(std::fabs(value) <= kMaxCoordinate_m,
                    "{} '{}': coordinate {}, allowed are {} to {} m", what, name, value,
                    -kMaxCoordinate_m, kMaxCoordinate_m);
  }
}

std::string compressed(std::span<const planning::CellState> cells) {
  uLongf size = compressBound(static_cast<uLong>(cells.size()));
  std::string out(size, '\0');
  const int code = compress2(reinterpret_cast<Bytef*>(out.data()), &size,
                             reinterpret_cast<const Bytef*>(cells.data()),
                             static_cast<uLong>(cells.size()), Z_DEFAULT_COMPRESSION);
  require_drawing(code == Z_OK, "drawn grid: cannot be compressed (zlib: {})", zError(code));
  out.resize(size);
  return out;
}

std::vector<std::uint8_t> uncompressed(const std::string& bytes, std::size_t cells) {
  // The format shrinks nothing by more, so that a few bytes cannot ask for much memory.
  constexpr std::size_t kMostCellsInAByte = 1100;
  require_drawing(cells / kMostCellsInAByte <= bytes.size(),
                  "drawn grid: {} bytes, too few for {} cells", bytes.size(), cells);
  std::vector<std::uint8_t> out(cells);
  uLongf size = static_cast<uLongf>(cells);
  uLong used = static_cast<uLong>(bytes.size());
  const int code =
      uncompress2(out.data(), &size, reinterpret_cast<const Bytef*>(bytes.data()), &used);
  require_drawing(code == Z_OK && size == cells && used == bytes.size(),
                  "drawn grid: its bytes are not {} cells in the format of zlib", cells);
  return out;
}

planning::OccupancyGrid grid_from_proto(const proto::DrawnGrid& in) {
  const auto cells_along = [](std::uint32_t count) {
    constexpr std::uint32_t kTooMany = 1'000'000'000;  // refused by the check below
    return static_cast<std::int32_t>(std::min(count, kTooMany));
  };
  planning::GridFrame frame;
  frame.columns = cells_along(in.columns());
  frame.rows = cells_along(in.rows());
  frame.resolution_m = in.resolution_m();
  frame.T_map_grid = from_proto(in.t_map_grid(), "origin of the drawn grid");
  try {
    planning::check(frame);
  } catch (const std::invalid_argument& error) {
    throw std::runtime_error(std::string("drawn ") + error.what());
  }
  const std::vector<std::uint8_t> cells = uncompressed(in.cells(), frame.size());
  planning::OccupancyGrid grid(frame);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    require_drawing(cells[i] <= static_cast<std::uint8_t>(planning::CellState::kUnknown),
                    "drawn grid: cell {} is {}, expected 0 to 2", i, cells[i]);
    grid.set(frame.cell_at(i), static_cast<planning::CellState>(cells[i]));
  }
  return grid;
}

}  // namespace

void check(const MapDrawing& drawing) {
  require_drawing(drawing.places.size() <= kMaxPlaces, "{} places, allowed are {}",
                  drawing.places.size(), kMaxPlaces);
  std::set<std::string> taken;
  for (const planning::Place& place : drawing.places) {
    check_name("place", place.name, taken);
    check_point("place", place.name, place.position_m);
    const double heading_rad = place.station_heading_rad.value_or(0.0);
    require_drawing(std::fabs(heading_rad) <= std::numbers::pi,
                    "place '{}': heading {}, allowed are -pi to pi", place.name, heading_rad);
  }
  require_drawing(drawing.zones.size() <= kMaxDrawnZones, "{} zones, allowed are {}",
                  drawing.zones.size(), kMaxDrawnZones);
  taken.clear();
  for (const planning::DrawnZone& zone : drawing.zones) {
    check_name("zone", zone.name, taken);
    require_drawing(zone.polygon_m.size() >= kLeastCorners && zone.polygon_m.size() <= kMaxCorners,
                    "zone '{}': {} corners, allowed are {} to {}", zone.name, zone.polygon_m.size(),
                    kLeastCorners, kMaxCorners);
    for (const Eigen::Vector2d& corner : zone.polygon_m) check_point("zone", zone.name, corner);
    require_drawing(std::isfinite(zone.value), "zone '{}': its value is not a finite number",
                    zone.name);
  }
}

void to_proto(const planning::Place& place, proto::Place* out) {
  out->set_name(place.name);
  out->set_x_m(place.position_m.x());
  out->set_y_m(place.position_m.y());
  if (place.station_heading_rad) out->set_station_heading_rad(*place.station_heading_rad);
}

planning::Place from_proto(const proto::Place& in) {
  planning::Place place{in.name(), {in.x_m(), in.y_m()}};
  if (in.has_station_heading_rad()) place.station_heading_rad = in.station_heading_rad();
  return place;
}

void to_proto(const planning::DrawnZone& zone, proto::DrawnZone* out) {
  out->set_name(zone.name);
  for (const Eigen::Vector2d& corner : zone.polygon_m) {
    out->add_corners(corner.x());
    out->add_corners(corner.y());
  }
  out->set_kind(static_cast<proto::ZoneKind>(zone.kind));
  out->set_value(zone.value);
}

planning::DrawnZone from_proto(const proto::DrawnZone& in) {
  require_drawing(in.corners_size() % 2 == 0, "zone '{}' with {} numbers: expected two per corner",
                  in.name(), in.corners_size());
  require_drawing(in.kind() >= 0 && static_cast<std::size_t>(in.kind()) < planning::kZoneKinds,
                  "zone '{}' of kind {}: expected 0 to {}", in.name(), static_cast<int>(in.kind()),
                  planning::kZoneKinds - 1);
  planning::DrawnZone zone{in.name(), {}, static_cast<planning::ZoneKind>(in.kind()), in.value()};
  for (int i = 0; i < in.corners_size(); i += 2) {
    zone.polygon_m.emplace_back(in.corners(i), in.corners(i + 1));
  }
  return zone;
}

void to_proto(const planning::OccupancyGrid& grid, proto::DrawnGrid* out) {
  const planning::GridFrame& frame = grid.frame();
  out->set_columns(static_cast<std::uint32_t>(frame.columns));
  out->set_rows(static_cast<std::uint32_t>(frame.rows));
  out->set_resolution_m(frame.resolution_m);
  to_proto(frame.T_map_grid, out->mutable_t_map_grid());
  out->set_cells(compressed(grid.cells()));
}

planning::OccupancyGrid from_proto(const proto::DrawnGrid& in) {
  return grid_from_proto(in);
}

void to_proto(const MapDrawing& drawing, proto::Drawing* out) {
  for (const planning::Place& place : drawing.places) to_proto(place, out->add_places());
  for (const planning::DrawnZone& zone : drawing.zones) to_proto(zone, out->add_zones());
  if (drawing.grid) to_proto(*drawing.grid, out->mutable_grid());
}

MapDrawing from_proto(const proto::Drawing& in) {
  MapDrawing drawing;
  for (const proto::Place& place : in.places()) drawing.places.push_back(from_proto(place));
  for (const proto::DrawnZone& zone : in.zones()) drawing.zones.push_back(from_proto(zone));
  check(drawing);
  if (in.has_grid()) drawing.grid = from_proto(in.grid());
  return drawing;
}

}  // namespace topogeo::storage
