// Settings that only SICK lasers on a network have.
#pragma once

#include <cstdint>

namespace topogeo::devices {

enum class ColaChoice : std::uint8_t {
  kDetect,  ///< the one that the laser answers
  kText,    ///< CoLa A
  kBinary   ///< CoLa B
};

struct ColaSettings {
  ColaChoice dialect = ColaChoice::kDetect;
  /// Time from the zero index, which stamps the scan, to the first beam. No document states where
  /// the index is.
  std::int64_t zero_to_first_ns = 0;
};

}  // namespace topogeo::devices
