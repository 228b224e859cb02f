// The services of this project that systemd runs on this host.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace topogeo::cli {

/// A unit that should run and does not.
struct IdleUnit {
  std::string name;       ///< "topogeo-localizer"
  bool restarts = false;  ///< systemd starts it again and again; else it has failed for good
};

struct HostUnits {
  std::vector<IdleUnit> idle;  ///< by name
  std::size_t on_domain = 0;   ///< active ones that join a domain; discovery servers do not
};

/// Those that systemd knows of; none where the host is not run by systemd. Takes some 10 ms.
HostUnits host_units();

/// The same of what `systemctl show` prints: a line NAME=VALUE for each of the properties Id,
/// ActiveState, SubState and NRestarts, an empty line between units.
HostUnits host_units(std::string_view properties);

}  // namespace topogeo::cli
