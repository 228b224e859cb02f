#include "topogeo/storage/map_drawing.hpp"

#include <algorithm>
#include <array>
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
#include "topogeo/support/printable.hpp"

#include "map_conversions.hpp"

namespace topogeo::storage {
namespace {

// Farther away rounding of doubles shows in pictures; no building is as large.
constexpr double kMaxCoordinate_m = 1e6;
constexpr std::size_t kLeastCorners = 3;  // of a zone
constexpr std::size_t kLeastPoints = 2;   // of a line

template <typename... Args>
void require_drawing(bool condition, fmt::format_string<Args...> format, Args&&... args) {
  if (!condition) throw std::runtime_error(fmt::format(format, std::forward<Args>(args)...));
}

bool is_printable(const std::string& text) {
  if (std::ranges::any_of(text, support::is_control)) return false;
  try {
    static_cast<void>(nlohmann::json(text).dump());  // throws unless it is UTF-8
    return true;
  } catch (const nlohmann::json::exception&) {
    return false;
  }
}

void check_name(const char* what, const std::string& name, std::set<std::string>& taken) {
  require_drawing(is_printable(name), "{}: expected a name in printable UTF-8", what);
  require_drawing(!name.empty() && name.size() <= kMaxNameBytes,
                  "{} '{}': expected a name of 1 to {} bytes", what, name, kMaxNameBytes);
  require_drawing(taken.insert(name).second, "{} '{}': the name is taken", what, name);
}

void check_point(const char* what, const std::string& name, const Eigen::Vector2d& point_m) {
  for (const double value : {point_m.x(), point_m.y()}) {
    // Also false for NaN.
    require_drawing(std::fabs(value) <= kMaxCoordinate_m,
                    "{} '{}': coordinate {}, expected {} to {} m", what, name, value,
                    -kMaxCoordinate_m, kMaxCoordinate_m);
  }
}

void check_place(const planning::Place& place, std::set<std::string>& taken) {
  check_name("place", place.name, taken);
  check_point("place", place.name, place.position_m);
  const double heading_rad = place.station_heading_rad.value_or(0.0);
  require_drawing(std::fabs(heading_rad) <= std::numbers::pi,
                  "place '{}': heading {}, expected -pi to pi", place.name, heading_rad);
}

void check_zone(const planning::DrawnZone& zone, std::set<std::string>& taken) {
  check_name("zone", zone.name, taken);
  require_drawing(zone.polygon_m.size() >= kLeastCorners && zone.polygon_m.size() <= kMaxCorners,
                  "zone '{}': {} corners, expected {} to {}", zone.name, zone.polygon_m.size(),
                  kLeastCorners, kMaxCorners);
  for (const Eigen::Vector2d& corner : zone.polygon_m) check_point("zone", zone.name, corner);
  require_drawing(std::isfinite(zone.value), "zone '{}': its value is not a finite number",
                  zone.name);
}

void check_line(const planning::DrawnLine& line, std::set<std::string>& taken) {
  constexpr std::array<const char*, planning::kLineKinds> kWords{"wall", "opening", "door"};
  const char* const what = kWords.at(static_cast<std::size_t>(line.kind));
  if (line.kind == planning::LineKind::kDoor || !line.name.empty()) {
    check_name(what, line.name, taken);
  }
  const std::vector<Eigen::Vector2d>& points_m = line.points_m;
  for (const Eigen::Vector2d& point_m : points_m) check_point(what, line.name, point_m);
  if (line.kind == planning::LineKind::kWall) {
    require_drawing(points_m.size() >= kLeastPoints && points_m.size() <= kMaxCorners,
                    "wall '{}': {} points, expected {} to {}", line.name, points_m.size(),
                    kLeastPoints, kMaxCorners);
    return;
  }
  require_drawing(points_m.size() == kLeastPoints && points_m[0] != points_m[1],
                  "{} '{}': expected two points that differ", what, line.name);
}

/// Adds the position of the entry to the error of a check.
template <typename Check>
void of_entry(const char* list, std::size_t index, const Check& check_entry) {
  try {
    check_entry();
  } catch (const std::runtime_error& error) {
    throw DrawingError(list, index, error.what());
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
  // Limit of the format's compression, so that a few bytes cannot request much memory.
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
  require_drawing(drawing.places.size() <= kMaxPlaces, "{} places, expected at most {}",
                  drawing.places.size(), kMaxPlaces);
  require_drawing(drawing.zones.size() <= kMaxDrawnZones, "{} zones, expected at most {}",
                  drawing.zones.size(), kMaxDrawnZones);
  require_drawing(drawing.lines.size() <= kMaxDrawnLines,
                  "{} walls, openings and doors, expected at most {}", drawing.lines.size(),
                  kMaxDrawnLines);
  std::set<std::string> taken;
  for (std::size_t i = 0; i < drawing.places.size(); ++i) {
    of_entry("places", i, [&] { check_place(drawing.places[i], taken); });
  }
  taken.clear();
  for (std::size_t i = 0; i < drawing.zones.size(); ++i) {
    of_entry("zones", i, [&] { check_zone(drawing.zones[i], taken); });
  }
  taken.clear();
  std::array<std::size_t, planning::kLineKinds> counts{};
  for (const planning::DrawnLine& line : drawing.lines) {
    const std::size_t index = counts.at(static_cast<std::size_t>(line.kind))++;
    of_entry(list_of(line.kind), index, [&] { check_line(line, taken); });
  }
}

std::string located(const DrawingError& error) {
  return fmt::format("{}[{}]: {}", error.list(), error.index(), error.what());
}

const char* list_of(planning::LineKind kind) {
  constexpr std::array<const char*, planning::kLineKinds> kLists{"walls", "openings", "doors"};
  return kLists.at(static_cast<std::size_t>(kind));
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

void to_proto(const planning::DrawnLine& line, proto::DrawnLine* out) {
  out->set_kind(static_cast<proto::LineKind>(line.kind));
  for (const Eigen::Vector2d& point : line.points_m) {
    out->add_points(point.x());
    out->add_points(point.y());
  }
  out->set_name(line.name);
}

planning::DrawnLine from_proto(const proto::DrawnLine& in) {
  require_drawing(in.points_size() % 2 == 0, "line '{}' with {} numbers: expected two per point",
                  in.name(), in.points_size());
  require_drawing(in.kind() >= 0 && static_cast<std::size_t>(in.kind()) < planning::kLineKinds,
                  "line '{}' of kind {}: expected 0 to {}", in.name(), static_cast<int>(in.kind()),
                  planning::kLineKinds - 1);
  planning::DrawnLine line{static_cast<planning::LineKind>(in.kind()), {}, in.name()};
  for (int i = 0; i < in.points_size(); i += 2) {
    line.points_m.emplace_back(in.points(i), in.points(i + 1));
  }
  return line;
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
  for (const planning::DrawnLine& line : drawing.lines) to_proto(line, out->add_lines());
  if (drawing.grid) to_proto(*drawing.grid, out->mutable_grid());
  out->set_version(drawing.version);
}

MapDrawing from_proto(const proto::Drawing& in) {
  MapDrawing drawing;
  for (const proto::Place& place : in.places()) drawing.places.push_back(from_proto(place));
  for (const proto::DrawnZone& zone : in.zones()) drawing.zones.push_back(from_proto(zone));
  for (const proto::DrawnLine& line : in.lines()) drawing.lines.push_back(from_proto(line));
  check(drawing);
  if (in.has_grid()) drawing.grid = from_proto(in.grid());
  drawing.version = in.version();
  return drawing;
}

}  // namespace topogeo::storage
