// The services of this project that systemd runs on this host.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace topogeo::cli {

/// A unit that should run but does not.
struct IdleUnit {
  std::string name;       ///< "topogeo-localizer"
  bool restarts = false;  ///< systemd keeps restarting it; else it has failed for good
};

struct HostUnits {
  std::vector<IdleUnit> idle;  ///< by name
  std::size_t on_domain = 0;   ///< active units that join a domain; discovery servers do not
};

/// The units that systemd knows; none when systemd does not run the host. Takes some 10 ms.
HostUnits host_units();

/// The same from the output of `systemctl show`: a line NAME=VALUE for each of the properties Id,
/// ActiveState, SubState and NRestarts, an empty line between units.
HostUnits host_units(std::string_view properties);

}  // namespace topogeo::cli
