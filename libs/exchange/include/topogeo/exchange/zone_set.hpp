// Converts drawn zones to and from the message `zoneSet` of VDA 5050 3.0 (docs/exchange.md, "Zone
// sets").
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "topogeo/exchange/export_header.hpp"
#include "topogeo/exchange/output_file.hpp"
#include "topogeo/planning/zones.hpp"

namespace topogeo::exchange {

/// no_go becomes BLOCKED, slow SPEED_LIMIT, one_way DIRECTED, a room an ACTION zone without
/// actions. Corners go round counter-clockwise. The id of the set is derived from its content.
/// Throws std::invalid_argument naming the zone: edges that cross each other, or overlapping
/// one-way zones, which VDA 5050 forbids.
std::string zone_set_text(std::span<const planning::DrawnZone> zones, const ExportHeader& header);

struct ZoneSet {
  std::vector<planning::DrawnZone> zones;
  Notes notes;
};

/// Zones of other types have no equivalent here and are left out with a note. Throws
/// std::runtime_error naming the file, the field and the expectation.
ZoneSet parse_zone_set(std::string_view text, const std::string& name);

}  // namespace topogeo::exchange
