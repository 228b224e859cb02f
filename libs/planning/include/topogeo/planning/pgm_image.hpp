// Grey images in the portable formats P2 (text) and P5 (bytes).
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace topogeo::planning {

struct PgmImage {
  std::int32_t width = 0;
  std::int32_t height = 0;
  int depth = 255;                   ///< value of white, [1, 255]
  std::vector<std::uint8_t> pixels;  ///< row by row from the top
};

/// Throws std::runtime_error naming `source` and the fault.
PgmImage parse_pgm(std::string_view bytes, const std::string& source);

std::string pgm_bytes(const PgmImage& image, bool as_text);

}  // namespace topogeo::planning
