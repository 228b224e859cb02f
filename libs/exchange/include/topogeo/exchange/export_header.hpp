// What files state beside the map: names that only those who use them know, and a time.
#pragma once

#include <cstdint>
#include <string>

namespace topogeo::exchange {

struct ExportHeader {
  std::string map_id = "map";  ///< how robots and fleet managers call the map
  std::string level = "L1";    ///< of the building
  std::string manufacturer = "topogeo";
  std::string robot_id = "robot";  ///< serial number and vehicle type are made of it
  std::int64_t stamp_ns = 0;       ///< time of the export since 1970, UTC
};

/// "2026-11-22T10:00:00.000Z", since 1970 and up to the year 9999.
std::string utc_text(std::int64_t stamp_ns);

/// Letters, digits and "_-.:" stay, all else becomes "_": ids of VDA 5050 have no others.
std::string plain_id(const std::string& text);

}  // namespace topogeo::exchange
