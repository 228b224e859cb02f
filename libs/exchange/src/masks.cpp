#include "topogeo/exchange/masks.hpp"

#include <algorithm>
#include <cmath>

#include "topogeo/exchange/grid_image.hpp"
#include "topogeo/support/format.hpp"

#include "segments.hpp"
#include "text.hpp"

namespace topogeo::exchange {
namespace {

using planning::Cell;
using planning::DrawnZone;
using planning::GridFrame;
using planning::ZoneKind;

bool zone_touches(const DrawnZone& zone, const GridFrame& frame, const Cell& cell) {
  const Eigen::Vector2d middle = frame.center_m(cell);
  const double half_m = 0.5 * frame.resolution_m;
  const auto corner = [&](double x, double y) -> Eigen::Vector2d {
    return middle + half_m * Eigen::Vector2d(x, y);
  };
  // True for a zone within the cell, or one that meets an edge or a diagonal of the cell.
  return segment_touches(zone.polygon_m, corner(-1, -1), corner(1, 1)) ||
         segment_touches(zone.polygon_m, corner(-1, 1), corner(1, -1)) ||
         segment_touches(zone.polygon_m, corner(-1, -1), corner(1, -1)) ||
         segment_touches(zone.polygon_m, corner(1, -1), corner(1, 1)) ||
         segment_touches(zone.polygon_m, corner(1, 1), corner(-1, 1)) ||
         segment_touches(zone.polygon_m, corner(-1, 1), corner(-1, -1)) ||
         ((zone.polygon_m.front() - middle).cwiseAbs().maxCoeff() <= half_m);
}

/// Calls `use` with the index of each cell that the zone touches.
template <typename Use>
void for_cells_of(const DrawnZone& zone, const GridFrame& frame, const Use& use) {
  Eigen::Vector2d low = frame.in_cells(zone.polygon_m.front());
  Eigen::Vector2d high = low;
  for (const Eigen::Vector2d& corner : zone.polygon_m) {
    low = low.cwiseMin(frame.in_cells(corner));
    high = high.cwiseMax(frame.in_cells(corner));
  }
  const auto cell = [](double along, std::int32_t count) {
    return static_cast<std::int32_t>(std::floor(std::clamp(along, 0.0, count - 1.0)));
  };
  for (std::int32_t row = cell(low.y(), frame.rows); row <= cell(high.y(), frame.rows); ++row) {
    for (std::int32_t column = cell(low.x(), frame.columns);
         column <= cell(high.x(), frame.columns); ++column) {
      if (zone_touches(zone, frame, {column, row})) use(frame.index({column, row}));
    }
  }
}

bool reaches_out(const DrawnZone& zone, const GridFrame& frame) {
  return std::ranges::any_of(zone.polygon_m, [&](const Eigen::Vector2d& corner) {
    return !frame.cell_of(corner).has_value();
  });
}

std::filesystem::path with_suffix(std::filesystem::path path, const char* suffix) {
  if (path.extension() == ".yaml" || path.extension() == ".pgm") path.replace_extension();
  path += suffix;
  return path;
}

}  // namespace

MaskFiles mask_files(const std::filesystem::path& path, const GridFrame& turned,
                     std::span<const DrawnZone> zones) {
  const GridFrame frame = without_turn(planning::OccupancyGrid(turned)).frame();
  MaskFiles out;
  double fastest_mps = 1.0;
  for (const DrawnZone& zone : zones) {
    if (zone.kind == ZoneKind::kSlow) fastest_mps = std::max(fastest_mps, zone.value);
    if (zone.kind == ZoneKind::kNoGo || zone.kind == ZoneKind::kSlow) {
      if (reaches_out(zone, frame)) {
        out.notes.push_back(
            fmt::format("zone '{}' reaches beyond the grid and is clipped", zone.name));
      }
    } else if (zone.kind == ZoneKind::kOneWay) {
      out.notes.push_back(fmt::format("zone '{}': masks have no directions", zone.name));
    } else if (zone.kind == ZoneKind::kPreferred) {
      out.notes.push_back(fmt::format("zone '{}': masks have no preferred lanes", zone.name));
    }
  }
  // A value is a whole number of up to 100: steps of 1 cm/s up to 1 m/s, else of 1 % of the
  // fastest.
  const double step_mps = fastest_mps / 100.0;
  std::vector<std::uint8_t> keepout(frame.size(), 0);
  std::vector<std::uint8_t> speed(frame.size(), 0);
  for (const DrawnZone& zone : zones) {
    if (zone.kind == ZoneKind::kNoGo) {
      for_cells_of(zone, frame, [&](std::size_t i) { keepout[i] = 100; });
    }
    if (zone.kind != ZoneKind::kSlow) continue;
    // Rounded down, but 0 would mean no limit. The margin is for 0.29 / 0.01.
    const double steps = std::clamp(std::floor(zone.value / step_mps + 1e-9), 1.0, 100.0);
    const auto value = static_cast<std::uint8_t>(steps);
    for_cells_of(zone, frame, [&](std::size_t i) {
      speed[i] = speed[i] == 0 ? value : std::min(speed[i], value);
    });
  }
  for (OutputFile& file :
       raw_files(with_suffix(path, "_keepout"), frame, keepout,
                 "# CostmapFilterInfo: type 0 (keepout), base 0.0, multiplier 1.0\n")) {
    out.files.push_back(std::move(file));
  }
  for (OutputFile& file : raw_files(
           with_suffix(path, "_speed"), frame, speed,
           fmt::format("# CostmapFilterInfo: type 2 (speed in m/s), base 0.0, multiplier {}\n",
                       number_text(step_mps)))) {
    out.files.push_back(std::move(file));
  }
  return out;
}

}  // namespace topogeo::exchange
