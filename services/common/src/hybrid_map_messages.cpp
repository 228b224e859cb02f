#include "topogeo/service/hybrid_map_messages.hpp"

#include <algorithm>
#include <string>
#include <string_view>
#include <type_traits>

#include "topogeo/messaging/message.hpp"
#include "topogeo/pipeline/hybrid_map_source.hpp"
#include "topogeo/service/conversions.hpp"

#include "convert.hpp"

namespace topogeo::service {

using detail::check_bound;
using detail::to_point;

namespace {

static_assert(msg::kTileCells == pipeline::kTileCells);

constexpr auto kUnknown = static_cast<std::uint8_t>(planning::CellState::kUnknown);

msg::GridTile tile_of(const planning::HybridMap& map, std::uint32_t number,
                      const TileLayout& layout) {
  constexpr auto kSide = static_cast<std::int32_t>(msg::kTileCells);
  const planning::Cell corner{static_cast<std::int32_t>(number % layout.columns) * kSide,
                              static_cast<std::int32_t>(number / layout.columns) * kSide};
  msg::GridTile tile;
  tile.tile(number);
  tile.states().assign(msg::kTileArea, kUnknown);
  tile.zones().assign(msg::kTileArea, msg::kNoZone);
  const planning::GridFrame& frame = map.frame();
  std::size_t at = 0;
  for (std::int32_t row = corner.row; row < corner.row + kSide; ++row) {
    for (std::int32_t column = corner.column; column < corner.column + kSide; ++column, ++at) {
      const planning::Cell cell{column, row};
      if (!frame.contains(cell)) continue;
      tile.states()[at] = static_cast<std::uint8_t>(map.space().seen().at(cell));
      tile.zones()[at] = map.zone_of(cell);
    }
  }
  return tile;
}

/// The parts of a drawn zone are named by its name and a number. When both together are too long,
/// the name is cut at a UTF-8 character. Other names stay unchanged.
std::string fitting(const std::string& name, std::size_t most) {
  const std::size_t number = name.rfind(' ');
  if (name.size() <= most || number == std::string::npos) return name;
  const std::string_view digits = std::string_view(name).substr(number + 1);
  const bool counts = !digits.empty() && std::ranges::all_of(digits, [](char character) {
    return character >= '0' && character <= '9';
  });
  if (!counts || digits.size() + 1 >= most) return name;
  std::size_t kept = most - digits.size() - 1;
  while (kept > 0 && (static_cast<unsigned char>(name[kept]) & 0xC0U) == 0x80U) --kept;
  return name.substr(0, kept) + name.substr(number);
}

void add_rule(const std::string& name, std::uint8_t kind, double value,
              const std::vector<Eigen::Vector2d>& corners_m, msg::HybridMap& out) {
  msg::HybridRule& entry = out.rules().emplace_back();
  messaging::set_text(entry.name(), name, "rule");
  entry.kind(kind);
  entry.value(value);
  check_bound("corners of a rule", corners_m.size(), msg::kMaxRuleCorners);
  for (const Eigen::Vector2d& corner_m : corners_m) entry.corners().push_back(to_point(corner_m));
}

void add_zones_and_places(const planning::HybridMap& map, msg::HybridMap& out) {
  const double cell_m2 = map.frame().resolution_m * map.frame().resolution_m;
  check_bound("zones", map.zones().zones.size(), msg::kMaxZones);
  for (const planning::Zone& zone : map.zones().zones) {
    msg::HybridZone& entry = out.zones().emplace_back();
    constexpr auto kMost = std::remove_cvref_t<decltype(entry.name())>::max_size;
    messaging::set_text(entry.name(), fitting(zone.name, kMost), "zone");
    entry.area_m2(static_cast<double>(zone.cells) * cell_m2);
    entry.room(zone.room);
  }
  const planning::DrivingRules& rules = map.space().rules();
  check_bound("rules", rules.zones().size() + rules.lines().size(), msg::kMaxRules);
  for (const planning::DrawnZone& zone : rules.zones()) {
    add_rule(zone.name, rule_kind_of(zone.kind), zone.value, zone.polygon_m, out);
  }
  for (const planning::DrawnLine& line : rules.lines()) {
    add_rule(line.name, rule_kind_of(line.kind), 0.0, line.points_m, out);
  }
  check_bound("places", map.places().size(), msg::kMaxPlaces);
  for (const planning::Place& place : map.places()) {
    msg::HybridPlace& entry = out.places().emplace_back();
    messaging::set_text(entry.name(), place.name, "place");
    entry.position(to_point(place.position_m));
    entry.is_station(place.station_heading_rad.has_value());
    entry.heading_rad(place.station_heading_rad.value_or(0.0));
  }
}

void add_graph(const planning::HybridMap& map, msg::HybridMap& out) {
  check_bound("nodes", map.nodes().size(), msg::kMaxBorderNodes);
  for (const planning::BorderNode& node : map.nodes()) {
    msg::HybridNode& entry = out.nodes().emplace_back();
    entry.position(to_point(node.position_m));
    entry.zone_a(node.zones[0]);
    entry.zone_b(node.zones[1]);
    entry.clearance_m(node.clearance_m);
  }
  check_bound("edges", map.edges().size(), msg::kMaxHybridEdges);
  for (const planning::HybridEdge& edge : map.edges()) {
    msg::HybridEdge& entry = out.edges().emplace_back();
    entry.node_a(edge.node_a);
    entry.node_b(edge.node_b);
    entry.zone(edge.zone);
    entry.cost_m(edge.cost_m);
  }
}

}  // namespace

TileLayout tile_layout(const planning::GridFrame& frame) {
  const auto tiles = [](std::int32_t cells) {
    return (static_cast<std::uint32_t>(cells) + msg::kTileCells - 1) / msg::kTileCells;
  };
  return {tiles(frame.columns), tiles(frame.rows)};
}

HybridMapMessages to_messages(const planning::HybridMap& map, std::string_view robot_id,
                              std::int64_t stamp_ns, std::uint64_t version) {
  const TileLayout layout = tile_layout(map.frame());
  check_bound("tiles", layout.count(), msg::kMaxTiles);
  HybridMapMessages out;
  out.tiles.reserve(layout.count());
  for (std::uint32_t number = 0; number < layout.count(); ++number) {
    msg::GridTile& tile = out.tiles.emplace_back(tile_of(map, number, layout));
    messaging::set_header(tile, robot_id, stamp_ns, 0);
    tile.version(version);
  }
  msg::HybridMap& summary = out.summary;
  messaging::set_header(summary, robot_id, stamp_ns, 0);
  summary.version(version);
  summary.columns(static_cast<std::uint32_t>(map.frame().columns));
  summary.rows(static_cast<std::uint32_t>(map.frame().rows));
  summary.resolution_m(map.frame().resolution_m);
  summary.T_map_grid(to_msg(map.frame().T_map_grid));
  summary.forbidden_cells(map.space().inflation().forbidden_cells);
  summary.inflate_unknown(map.space().inflation().inflate_unknown);
  summary.pocket_m2(map.space().inflation().min_pocket_m2);
  summary.tile_versions().assign(layout.count(), version);
  add_zones_and_places(map, summary);
  add_graph(map, summary);
  return out;
}

planning::GridFrame frame_from_msg(const msg::HybridMap& summary) {
  // Clamped so that an excessive count stays excessive in a signed number.
  const auto cells = [](std::uint32_t count) {
    constexpr std::uint32_t kTooMany = 1'000'000'000;
    return static_cast<std::int32_t>(std::min(count, kTooMany));
  };
  planning::GridFrame frame;
  frame.columns = cells(summary.columns());
  frame.rows = cells(summary.rows());
  frame.resolution_m = summary.resolution_m();
  frame.T_map_grid = from_msg(summary.T_map_grid());
  planning::check(frame);
  return frame;
}

}  // namespace topogeo::service
