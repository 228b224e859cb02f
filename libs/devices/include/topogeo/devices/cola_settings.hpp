// Settings of SICK lasers on a network, besides those of all lasers that turn.
#pragma once

#include <cstdint>

namespace topogeo::devices {

enum class ColaChoice : std::uint8_t {
  kDetect,  ///< whichever the laser answers
  kText,    ///< CoLa A
  kBinary   ///< CoLa B
};

struct ColaSettings {
  ColaChoice dialect = ColaChoice::kDetect;
  /// Time of the first beam after the zero index, whose time a scan carries. No document states the
  /// place of the index.
  std::int64_t zero_to_first_ns = 0;
};

}  // namespace topogeo::devices
