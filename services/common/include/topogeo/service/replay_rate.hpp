// The replay speed of a log, as given on a command line.
#pragma once

#include <optional>
#include <string>

namespace topogeo::service {

/// Speed of a replay: log time over real time, > 0; empty: as fast as the readers take the scans.
using ReplayRate = std::optional<double>;

/// "realtime", "lossless" or a factor from 0.01 to 1000. Throws std::invalid_argument otherwise.
ReplayRate parse_rate(const std::string& text);

}  // namespace topogeo::service
