// One time axis for the scans and the odometry of a recording, whatever happens to the clocks of
// their stamps. Recordings with one sound clock keep their stamps.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "clock_runs.hpp"

namespace topogeo::recording {

struct RepairedStamps {
  /// Time of each message; empty if it is left out, because its stamp is odd or it came before.
  std::vector<std::optional<std::int64_t>> scans_ns;
  std::vector<std::optional<std::int64_t>> odometry_ns;
  std::vector<bool> scans_repeated;  ///< whether an equal message came before
  std::vector<std::string> notes;    ///< for people, on what is not as it was
};

/// Messages of each topic in the order of arrival.
/// - Topics without stamps get the times of recording.
/// - If the clock is set while recording, times go on in that of the first tenth of the messages,
///   as the times of recording do, for scans and odometry alike.
/// - Messages of other clocks amid a run are left out, and so are repeated ones.
/// - Different messages with equal stamps get times from their order.
/// - If scans and odometry have no time in common, the times of recording join them.
RepairedStamps repair_stamps(std::span<const StampedMessage> scans,
                             std::span<const StampedMessage> odometry);

}  // namespace topogeo::recording
