// The services of this project that systemd runs on this host.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace topogeo::cli {

/// A unit that should run and does not.
struct IdleUnit {
  std::string name;       ///< "topogeo-localizer"
  bool restarts = false;  ///< systemd starts it again soon; else it has failed for good
};

/// Those that systemd knows of, by name; none where the host is not run by systemd. Takes some
/// 10 ms.
std::vector<IdleUnit> idle_units();

/// The same of what `systemctl list-units --plain --no-legend` prints: unit, whether it is loaded,
/// state and part of the state in a line.
std::vector<IdleUnit> idle_units(std::string_view listing);

}  // namespace topogeo::cli
