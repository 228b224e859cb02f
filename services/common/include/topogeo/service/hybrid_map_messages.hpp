// The hybrid map as messages: grid tiles and a summary. HybridMapMirror assembles the map from
// them.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "topogeo/msg/hybrid_map.h"
#include "topogeo/planning/hybrid_map.hpp"

namespace topogeo::service {

/// HybridRule::kind of the first kind of drawn lines.
inline constexpr std::size_t kFirstLineRule = 4;
inline constexpr std::size_t kRuleKinds = planning::kZoneKinds + planning::kLineKinds;
/// HybridRule::kind of a drawn line.
constexpr std::uint8_t rule_kind_of(planning::LineKind kind) {
  return static_cast<std::uint8_t>(kFirstLineRule + static_cast<std::size_t>(kind));
}
/// HybridRule::kind of a drawn zone. Kinds of zones that are newer than those of lines follow them,
/// so that no number changes its meaning.
constexpr std::uint8_t rule_kind_of(planning::ZoneKind kind) {
  const auto number = static_cast<std::size_t>(kind);
  return static_cast<std::uint8_t>(number < kFirstLineRule ? number
                                                           : number + planning::kLineKinds);
}
/// The zone of a HybridRule::kind; empty for a line and for unknown numbers.
constexpr std::optional<planning::ZoneKind> zone_of_rule(std::uint8_t kind) {
  for (std::size_t zone = 0; zone < planning::kZoneKinds; ++zone) {
    const auto found = static_cast<planning::ZoneKind>(zone);
    if (rule_kind_of(found) == kind) return found;
  }
  return std::nullopt;
}

/// Size of a grid in tiles.
struct TileLayout {
  std::uint32_t columns = 0;
  std::uint32_t rows = 0;

  [[nodiscard]] std::uint32_t count() const { return columns * rows; }
};
TileLayout tile_layout(const planning::GridFrame& frame);

struct HybridMapMessages {
  std::vector<msg::GridTile> tiles;  ///< by number
  msg::HybridMap summary;
};

/// Sets every version to `version` and every sequence number to 0. Throws std::invalid_argument
/// naming the field when the map has more tiles, zones, places, nodes or edges than the messages
/// hold, or a name is too long. The parts of a drawn zone, "NAME 2", ..., get a shorter NAME where
/// the whole does not fit.
HybridMapMessages to_messages(const planning::HybridMap& map, std::string_view robot_id,
                              std::int64_t stamp_ns, std::uint64_t version);

/// The frame of a summary's grid. Throws std::invalid_argument like planning::check(GridFrame).
planning::GridFrame frame_from_msg(const msg::HybridMap& summary);

}  // namespace topogeo::service
