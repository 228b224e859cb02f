// Settings that only Hokuyo lasers have.
#pragma once

#include <cstdint>

#include "topogeo/devices/scip_protocol.hpp"

namespace topogeo::devices {

/// Moment of a scan's time stamp. Sources differ.
enum class ScipStamp : std::uint8_t {
  kStepZero,  ///< step 0: the protocol specification
  kRear       ///< the beam straight behind, before step 0: the ROS driver urg_node
};

struct ScipSettings {
  ScipScanKind kind = ScipScanKind::kThreeCharacters;
  /// Readings of less intensity are no return; used with kIntensities.
  std::uint32_t least_intensity = 0;
  ScipStamp stamp = ScipStamp::kStepZero;
};

}  // namespace topogeo::devices
