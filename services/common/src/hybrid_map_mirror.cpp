#include "topogeo/service/hybrid_map_mirror.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>

#include "topogeo/service/hybrid_map_messages.hpp"

#include "convert.hpp"

namespace topogeo::service {

using detail::check;
using detail::check_bound;
using detail::finite;

namespace {

static_assert(msg::kNoZone == planning::kNoZone);

planning::InflationConfig inflation_of(const msg::HybridMap& summary) {
  return {summary.forbidden_cells(), summary.inflate_unknown(), summary.pocket_m2()};
}

bool is_line(const msg::HybridRule& rule) {
  return !zone_of_rule(rule.kind());
}

void check_zones_and_places(const msg::HybridMap& summary) {
  check_bound("zones", summary.zones().size(), msg::kMaxZones);
  for (const msg::HybridZone& zone : summary.zones()) finite(zone.area_m2(), "area of a zone");
  check_bound("rules", summary.rules().size(), msg::kMaxRules);
  for (const msg::HybridRule& rule : summary.rules()) {
    check(rule.kind() > 0 && rule.kind() < kRuleKinds, "kind of a rule", "1 to 7");
    const std::size_t least = is_line(rule) ? 2 : 3;
    check(rule.corners().size() >= least, "corners of a rule", "at least " + std::to_string(least));
    check_bound("corners of a rule", rule.corners().size(), msg::kMaxRuleCorners);
    finite(rule.value(), "value of a rule");
    for (const msg::Point2& corner : rule.corners()) {
      finite(corner.x_m(), "corner of a rule");
      finite(corner.y_m(), "corner of a rule");
    }
  }
  check_bound("places", summary.places().size(), msg::kMaxPlaces);
  std::set<std::string> names;
  for (const msg::HybridPlace& place : summary.places()) {
    const std::string name = place.name().to_string();
    check(!name.empty() && names.insert(name).second, "place '" + name + "'",
          "names that are not empty and not taken");
    finite(place.position().x_m(), "position of a place");
    finite(place.position().y_m(), "position of a place");
    check(std::fabs(place.heading_rad()) <= std::numbers::pi, "heading of a place", "-pi to pi");
  }
}

struct DrawnRules {
  std::vector<planning::DrawnZone> zones;
  std::vector<planning::DrawnLine> lines;
};

DrawnRules rules_of(const msg::HybridMap& summary) {
  DrawnRules rules;
  for (const msg::HybridRule& rule : summary.rules()) {
    std::vector<Eigen::Vector2d> corners_m;
    for (const msg::Point2& corner : rule.corners()) {
      corners_m.emplace_back(corner.x_m(), corner.y_m());
    }
    const std::string name = rule.name().to_string();
    if (is_line(rule)) {
      const auto kind = static_cast<planning::LineKind>(rule.kind() - kFirstLineRule);
      rules.lines.push_back({kind, std::move(corners_m), name});
    } else {
      rules.zones.push_back({name, std::move(corners_m), *zone_of_rule(rule.kind()), rule.value()});
    }
  }
  return rules;
}

void check_graph(const msg::HybridMap& summary) {
  const std::size_t zones = summary.zones().size();
  check_bound("nodes", summary.nodes().size(), msg::kMaxBorderNodes);
  for (const msg::HybridNode& node : summary.nodes()) {
    check(node.zone_a() < zones && node.zone_b() < zones, "zone of a node",
          "less than " + std::to_string(zones));
    finite(node.position().x_m(), "position of a node");
    finite(node.position().y_m(), "position of a node");
    // Infinite when the grid has no obstacle at all.
    check(node.clearance_m() >= 0.0, "clearance of a node", "a number of at least 0");
  }
  const std::size_t nodes = summary.nodes().size();
  check_bound("edges", summary.edges().size(), msg::kMaxHybridEdges);
  for (const msg::HybridEdge& edge : summary.edges()) {
    check(edge.node_a() < nodes && edge.node_b() < nodes, "node of an edge",
          "less than " + std::to_string(nodes));
    check(edge.zone() < zones, "zone of an edge", "less than " + std::to_string(zones));
    finite(edge.cost_m(), "cost of an edge");
  }
}

/// Builds the zones from their cells, which also give their extent.
planning::ZoneMap zone_map(const planning::GridFrame& frame,
                           std::vector<planning::ZoneId> zone_of_cell,
                           const msg::HybridMap& summary) {
  planning::ZoneMap map;
  map.zone_of_cell = std::move(zone_of_cell);
  for (const msg::HybridZone& entry : summary.zones()) {
    planning::Zone& zone = map.zones.emplace_back();
    zone.id = static_cast<planning::ZoneId>(map.zones.size() - 1);
    zone.name = entry.name().to_string();
    zone.room = entry.room();
  }
  for (std::size_t i = 0; i < map.zone_of_cell.size(); ++i) {
    const planning::ZoneId id = map.zone_of_cell[i];
    if (id == planning::kNoZone) continue;
    check(id < map.zones.size(), "zone of a cell", "less than " + std::to_string(map.zones.size()));
    planning::Zone& zone = map.zones[id];
    const planning::Cell cell = frame.cell_at(i);
    if (zone.cells++ == 0) zone.box = {cell, cell};
    zone.box.low = {std::min(zone.box.low.column, cell.column),
                    std::min(zone.box.low.row, cell.row)};
    zone.box.high = {std::max(zone.box.high.column, cell.column),
                     std::max(zone.box.high.row, cell.row)};
  }
  for (const planning::Zone& zone : map.zones) {
    check(zone.cells > 0, "zone " + std::to_string(zone.id), "at least one cell");
  }
  return map;
}

}  // namespace

void HybridMapMirror::put(const msg::GridTile& tile, messaging::Handle instance) {
  check(tile.tile() < msg::kMaxTiles, "tile", "less than " + std::to_string(msg::kMaxTiles));
  check(tile.states().size() == msg::kTileArea, "states", std::to_string(msg::kTileArea));
  check(tile.zones().size() == msg::kTileArea, "zones", std::to_string(msg::kTileArea));
  constexpr auto kLast = static_cast<std::uint8_t>(planning::CellState::kUnknown);
  check(std::ranges::all_of(tile.states(), [](std::uint8_t state) { return state <= kLast; }),
        "state of a cell", "0 to " + std::to_string(kLast));
  tiles_[tile.tile()] = {tile.version(), tile.states(), tile.zones()};
  keys_[instance] = tile.tile();
  changed_ = true;
}

void HybridMapMirror::put(const msg::HybridMap& summary) {
  const planning::GridFrame frame = frame_from_msg(summary);
  planning::check(inflation_of(summary));
  const std::uint32_t tiles = tile_layout(frame).count();
  check(summary.tile_versions().size() == tiles, "tile_versions", std::to_string(tiles));
  check_zones_and_places(summary);
  check_graph(summary);
  summary_ = summary;
  changed_ = true;
}

void HybridMapMirror::remove(messaging::Handle instance) {
  const auto found = keys_.find(instance);
  if (found == keys_.end()) return;
  tiles_.erase(found->second);
  keys_.erase(found);
}

void HybridMapMirror::remove_summary() {
  summary_.reset();
  map_.reset();
  version_ = 0;
}

bool HybridMapMirror::whole() const {
  if (!summary_) return false;
  const auto& versions = summary_->tile_versions();
  for (std::uint32_t i = 0; i < versions.size(); ++i) {
    const auto found = tiles_.find(i);
    if (found == tiles_.end() || found->second.version != versions[i]) return false;
  }
  return true;
}

std::shared_ptr<const planning::HybridMap> HybridMapMirror::build() const {
  const planning::GridFrame frame = frame_from_msg(*summary_);
  const TileLayout layout = tile_layout(frame);
  planning::OccupancyGrid grid(frame);
  std::vector<planning::ZoneId> zones(frame.size(), planning::kNoZone);
  for (std::size_t i = 0; i < frame.size(); ++i) {
    const planning::Cell cell = frame.cell_at(i);
    const auto column = static_cast<std::uint32_t>(cell.column);
    const auto row = static_cast<std::uint32_t>(cell.row);
    const Tile& tile = tiles_.at(row / msg::kTileCells * layout.columns + column / msg::kTileCells);
    const std::size_t at = row % msg::kTileCells * msg::kTileCells + column % msg::kTileCells;
    grid.set(cell, static_cast<planning::CellState>(tile.states[at]));
    zones[i] = tile.zones[at];
  }
  std::vector<planning::Place> places;
  for (const msg::HybridPlace& place : summary_->places()) {
    planning::Place& known = places.emplace_back();
    known.name = place.name().to_string();
    known.position_m = {place.position().x_m(), place.position().y_m()};
    if (place.is_station()) known.station_heading_rad = place.heading_rad();
  }
  const DrawnRules rules = rules_of(*summary_);
  return std::make_shared<const planning::HybridMap>(
      planning::FreeSpace(std::move(grid), inflation_of(*summary_), rules.zones, rules.lines),
      zone_map(frame, std::move(zones), *summary_), std::move(places));
}

std::shared_ptr<const planning::HybridMap> HybridMapMirror::map() {
  if (!changed_ || !whole()) return map_;
  changed_ = false;  // also when the map cannot be built: the same parts would fail again
  map_ = build();
  version_ = summary_->version();
  return map_;
}

}  // namespace topogeo::service
