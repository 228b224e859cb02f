// A service that gets nothing of its main input although another service sends it.
#pragma once

#include <span>
#include <string>

#include "topogeo/msg/status.h"

namespace topogeo::cli {

/// Why `service` is deaf: "deaf: none of the 5.1 scan/s of sensor_gateway arrives". Empty: it is
/// not, or its status does not show it. By what the two report alone, so that neither a robot that
/// stands nor a machine that is slow or frozen makes a service deaf: nothing of the topic of its
/// main input has arrived for 5 s, none waits to be handled, and the only sender has sent one a
/// second or more in that time. `all`: those of its domain and partition that publish their status
/// now. Where two of them do the same for the robot, whom each of them should hear is not known.
[[nodiscard]] std::string deafness(const msg::ServiceStatus& service,
                                   std::span<const msg::ServiceStatus* const> all);

}  // namespace topogeo::cli
