// Header of exported files: names that only their users know, and a time.
#pragma once

#include <cstdint>
#include <string>

namespace topogeo::exchange {

struct ExportHeader {
  std::string map_id = "map";  ///< name of the map for robots and fleet managers
  std::string level = "L1";    ///< of the building
  std::string manufacturer = "topogeo";
  std::string robot_id = "robot";  ///< source of serial number and vehicle type
  std::int64_t stamp_ns = 0;       ///< time of the export since 1970, UTC
};

/// "2026-11-22T10:00:00.000Z", for times since 1970 up to the year 9999.
std::string utc_text(std::int64_t stamp_ns);

/// Replaces all except letters, digits and "_-.:" by "_": ids of VDA 5050 allow no others.
std::string plain_id(const std::string& text);

}  // namespace topogeo::exchange
