// Settings that only the ROBOTIS LDS-01 and the laser of the Neato XV-11 have.
#pragma once

#include <cstdint>

namespace topogeo::devices {

/// Treatment of packets with a wrong checksum.
enum class LdsChecksum : std::uint8_t {
  kModel,  ///< kDrop of an XV-11; kLearn of an LDS-01, whose rule one source alone states
  kLearn,  ///< kDrop after eight packets in a row with the right one; kWarn after 64 without
  kDrop,   ///< they are dropped
  kWarn    ///< they are counted, and used if the next packet follows them
};

struct LdsSettings {
  LdsChecksum checksum = LdsChecksum::kModel;
};

}  // namespace topogeo::devices
