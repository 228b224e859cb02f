#include "topogeo/storage/map_drawing.hpp"

#include <algorithm>
#include <cmath>
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
  }
}

void to_proto(const MapDrawing& drawing, proto::Drawing* out) {
  for (const planning::Place& place : drawing.places) {
    proto::Place* entry = out->add_places();
    entry->set_name(place.name);
    entry->set_x_m(place.position_m.x());
    entry->set_y_m(place.position_m.y());
  }
  for (const planning::DrawnZone& zone : drawing.zones) {
    proto::DrawnZone* entry = out->add_zones();
    entry->set_name(zone.name);
    for (const Eigen::Vector2d& corner : zone.polygon_m) {
      entry->add_corners(corner.x());
      entry->add_corners(corner.y());
    }
  }
  if (!drawing.grid) return;
  const planning::GridFrame& frame = drawing.grid->frame();
  proto::DrawnGrid* grid = out->mutable_grid();
  grid->set_columns(static_cast<std::uint32_t>(frame.columns));
  grid->set_rows(static_cast<std::uint32_t>(frame.rows));
  grid->set_resolution_m(frame.resolution_m);
  to_proto(frame.T_map_grid, grid->mutable_t_map_grid());
  grid->set_cells(compressed(drawing.grid->cells()));
}

MapDrawing from_proto(const proto::Drawing& in) {
  MapDrawing drawing;
  for (const proto::Place& place : in.places()) {
    drawing.places.push_back({place.name(), {place.x_m(), place.y_m()}});
  }
  for (const proto::DrawnZone& zone : in.zones()) {
    require_drawing(zone.corners_size() % 2 == 0,
                    "zone '{}' with {} numbers: expected two per corner", zone.name(),
                    zone.corners_size());
    planning::DrawnZone& entry = drawing.zones.emplace_back();
    entry.name = zone.name();
    for (int i = 0; i < zone.corners_size(); i += 2) {
      entry.polygon_m.emplace_back(zone.corners(i), zone.corners(i + 1));
    }
  }
  check(drawing);
  if (in.has_grid()) drawing.grid = grid_from_proto(in.grid());
  return drawing;
}

}  // namespace topogeo::storage
