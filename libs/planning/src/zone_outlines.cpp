#include "topogeo/planning/zone_outlines.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <numbers>
#include <optional>

#include <Eigen/Geometry>
#include <boost/geometry/algorithms/simplify.hpp>
#include <boost/geometry/geometries/point_xy.hpp>
#include <boost/geometry/geometries/ring.hpp>
#include <boost/geometry/strategies/strategies.hpp>

#include "cell_neighbours.hpp"
#include "line_cells.hpp"

namespace topogeo::planning {
namespace {

using Points = std::vector<Eigen::Vector2d>;
using Corner = std::pair<std::int32_t, std::int32_t>;  // of cells: column, row of its lower left

constexpr double kBeyond_m = 0.5;      // extension of a line beyond its ends
constexpr std::uint32_t kOutside = 0;  // number outside of all parts; others count from 1

/// Whether a cell belongs to the zones, or has no zone and lies beside one of their cells.
std::vector<bool> cells_of(const GridFrame& frame, const ZoneMap& zones,
                           std::span<const ZoneId> ids) {
  constexpr double kToWalls_m = 0.3;
  std::vector<bool> in(frame.size(), false);
  std::vector<bool> wanted(zones.zones.size(), false);
  for (const ZoneId id : ids) {
    if (id < wanted.size()) wanted[id] = true;
  }
  std::vector<std::size_t> front;
  for (std::size_t i = 0; i < in.size(); ++i) {
    const ZoneId zone = zones.zone_of_cell[i];
    if (zone == kNoZone || zone >= wanted.size() || !wanted[zone]) continue;
    in[i] = true;
    front.push_back(i);
  }
  const int steps = static_cast<int>(kToWalls_m / frame.resolution_m);
  for (int step = 0; step < steps; ++step) {
    std::vector<std::size_t> next;
    for (const std::size_t i : front) {
      visit_neighbours(frame, i, [&](std::size_t j) {
        if (in[j] || zones.zone_of_cell[j] != kNoZone) return;
        in[j] = true;
        next.push_back(j);
      });
    }
    front.swap(next);
  }
  return in;
}

/// Numbers the cells of one part, starting from a first cell. Returns their count.
std::size_t flood(const GridFrame& frame, std::size_t first, std::uint32_t number,
                  const std::vector<bool>& in, std::vector<std::uint32_t>& part_of) {
  std::vector<std::size_t> open{first};
  part_of[first] = number;
  for (std::size_t done = 0; done < open.size(); ++done) {
    visit_neighbours(frame, open[done], [&](std::size_t j) {
      if (!in[j] || part_of[j] != kOutside) return;
      part_of[j] = number;
      open.push_back(j);
    });
  }
  return open.size();
}

/// Gives the cells of the cut to the nearest part, counted in steps.
void give_back(const GridFrame& frame, const std::vector<std::size_t>& taken,
               std::vector<std::uint32_t>& part_of) {
  for (bool changed = true; changed;) {
    changed = false;
    std::vector<std::pair<std::size_t, std::uint32_t>> given;
    for (const std::size_t i : taken) {
      if (part_of[i] != kOutside) continue;
      std::uint32_t part = kOutside;
      visit_neighbours(frame, i, [&](std::size_t j) { part = std::max(part, part_of[j]); });
      if (part != kOutside) given.emplace_back(i, part);
    }
    for (const auto& [i, part] : given) part_of[i] = part;
    changed = !given.empty();
  }
}

/// The start of the next zone on the way from a point, which may pass a gap, but no wall.
std::optional<Eigen::Vector2d> next_zone(const GridFrame& frame, const ZoneMap& zones,
                                         std::span<const ZoneId> ids, const Eigen::Vector2d& from_m,
                                         const Eigen::Vector2d& along) {
  constexpr double kDeepest_m = 1.5;
  constexpr double kThickest_m = 0.3;  // of floor without a zone; walls also have their clearance
  const double step_m = 0.5 * frame.resolution_m;
  double outside_m = 0.0;
  for (double ahead_m = 0.0; ahead_m <= kDeepest_m; ahead_m += step_m) {
    const Eigen::Vector2d at_m = from_m + ahead_m * along;
    const std::optional<Cell> cell = frame.cell_of(at_m);
    if (!cell) return std::nullopt;
    const ZoneId zone = zones.zone_of_cell[frame.index(*cell)];
    if (zone != kNoZone && std::ranges::find(ids, zone) == ids.end()) return at_m;
    outside_m = zone == kNoZone ? outside_m + step_m : 0.0;
    if (outside_m > kThickest_m) return std::nullopt;
  }
  return std::nullopt;
}

/// The cells of a line extended to gaps. Zones reach through a gap up to some line between its
/// walls, so an end before it is extended to the next zone, straight or with the least turn.
std::vector<Cell> cells_to_gaps(const GridFrame& frame, const ZoneMap& zones,
                                std::span<const ZoneId> ids, const Eigen::Vector2d& from_m,
                                const Eigen::Vector2d& to_m) {
  constexpr std::array kTurns_deg = {0, 15, -15, 30, -30, 45, -45, 60, -60, 75, -75};
  std::vector<Cell> cut = cells_across(frame, from_m, to_m, kBeyond_m);
  const Eigen::Vector2d along = (to_m - from_m).normalized();
  for (const auto& [end_m, ahead] : {std::pair(from_m, (-along).eval()), std::pair(to_m, along)}) {
    for (const int turn_deg : kTurns_deg) {
      const Eigen::Rotation2Dd turn(turn_deg * std::numbers::pi / 180.0);
      const auto zone_m = next_zone(frame, zones, ids, end_m, turn * ahead);
      if (!zone_m || *zone_m == end_m) continue;
      std::ranges::copy(cells_across(frame, end_m, *zone_m, kBeyond_m), std::back_inserter(cut));
      break;
    }
  }
  return cut;
}

struct Parts {
  std::vector<std::uint32_t> part_of;  // number of each cell's part
  std::vector<std::uint32_t> large;    // numbers of parts that are not left out
};

/// The connected parts after a line is cut out, whose cells are returned at the end.
Parts parts_of(const GridFrame& frame, std::vector<bool> in, const std::vector<Cell>& cut) {
  constexpr std::size_t kLeastCells = 4;
  std::vector<std::size_t> taken;
  for (const Cell& cell : cut) {
    const std::size_t i = frame.index(cell);
    if (in[i]) taken.push_back(i);
    in[i] = false;
  }
  Parts parts{std::vector<std::uint32_t>(frame.size(), kOutside), {}};
  std::uint32_t number = kOutside;
  for (std::size_t i = 0; i < in.size(); ++i) {
    if (!in[i] || parts.part_of[i] != kOutside) continue;
    if (flood(frame, i, ++number, in, parts.part_of) >= kLeastCells) parts.large.push_back(number);
  }
  give_back(frame, taken, parts.part_of);
  return parts;
}

/// Twice the area inside of a closed line; positive if counter-clockwise.
double twice_area(const std::vector<Corner>& loop) {
  double sum = 0.0;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const auto& [x, y] = loop[i];
    const auto& [next_x, next_y] = loop[(i + 1) % loop.size()];
    sum += static_cast<double>(x) * next_y - static_cast<double>(next_x) * y;
  }
  return sum;
}

/// The outer outline of a part along the sides of its cells, with the part on its left.
std::vector<Corner> outer_loop(const GridFrame& frame, std::uint32_t number,
                               const std::vector<std::uint32_t>& part_of) {
  const auto is_in = [&](const Cell& cell) {
    return frame.contains(cell) && part_of[frame.index(cell)] == number;
  };
  std::multimap<Corner, Corner> sides;  // between neighbouring corners
  for (std::size_t i = 0; i < part_of.size(); ++i) {
    if (part_of[i] != number) continue;
    const auto [x, y] = frame.cell_at(i);
    if (!is_in({x, y - 1})) sides.insert({{x, y}, {x + 1, y}});
    if (!is_in({x + 1, y})) sides.insert({{x + 1, y}, {x + 1, y + 1}});
    if (!is_in({x, y + 1})) sides.insert({{x + 1, y + 1}, {x, y + 1}});
    if (!is_in({x - 1, y})) sides.insert({{x, y + 1}, {x, y}});
  }
  std::vector<Corner> best;
  while (!sides.empty()) {
    std::vector<Corner> loop;
    Corner at = sides.begin()->first;
    std::array<std::int32_t, 2> along{};
    while (true) {
      auto [side, end] = sides.equal_range(at);
      if (side == end) break;
      // If two cells touch only at a corner, the line turns left to stay with its cell.
      for (auto other = std::next(side); other != end; ++other) {
        const auto turn = [&](const Corner& to) {
          return along[0] * (to.second - at.second) - along[1] * (to.first - at.first);
        };
        if (turn(other->second) > turn(side->second)) side = other;
      }
      loop.push_back(at);
      along = {side->second.first - at.first, side->second.second - at.second};
      at = side->second;
      sides.erase(side);
    }
    if (twice_area(loop) > twice_area(best)) best = std::move(loop);
  }
  return best;
}

Points straightened(const GridFrame& frame, const std::vector<Corner>& loop) {
  constexpr std::size_t kMostCorners = 256;
  constexpr double kFirst_cells = 0.75;
  namespace bg = boost::geometry;
  using Ring = bg::model::ring<bg::model::d2::point_xy<double>, false>;
  Ring ring;
  for (const auto& [x, y] : loop) ring.push_back({static_cast<double>(x), static_cast<double>(y)});
  ring.push_back(ring.front());
  Ring simple;
  for (double tolerance = kFirst_cells; simple.empty() || simple.size() > kMostCorners + 1;
       tolerance *= 2.0) {
    simple.clear();
    bg::simplify(ring, simple, tolerance);
    if (simple.size() < 4) {
      simple = ring;
      break;
    }
  }
  Points points_m;
  for (std::size_t i = 0; i + 1 < simple.size(); ++i) {
    points_m.push_back(frame.T_map_grid * Eigen::Vector2d(frame.resolution_m * simple[i].x(),
                                                          frame.resolution_m * simple[i].y()));
  }
  return points_m;
}

}  // namespace

std::vector<Points> outlines_of(
    const GridFrame& frame, const ZoneMap& zones, std::span<const ZoneId> ids,
    const std::optional<std::pair<Eigen::Vector2d, Eigen::Vector2d>>& cut_m) {
  const std::vector<bool> in = cells_of(frame, zones, ids);
  Parts parts = parts_of(frame, in, {});
  if (cut_m && cut_m->first != cut_m->second) {
    const auto& [from_m, to_m] = *cut_m;
    const std::size_t whole = parts.large.size();
    parts = parts_of(frame, in, cells_across(frame, from_m, to_m, kBeyond_m));
    if (parts.large.size() <= whole) {
      parts = parts_of(frame, in, cells_to_gaps(frame, zones, ids, from_m, to_m));
    }
  }
  std::vector<Points> outlines;
  outlines.reserve(parts.large.size());
  for (const std::uint32_t part : parts.large) {
    outlines.push_back(straightened(frame, outer_loop(frame, part, parts.part_of)));
  }
  return outlines;
}

}  // namespace topogeo::planning
