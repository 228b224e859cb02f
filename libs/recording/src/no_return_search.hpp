// Reads a log for the range that its laser reports if no echo has returned.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "topogeo/scan/carmen_log_config.hpp"
#include "topogeo/scan/no_return.hpp"

#include "timeline.hpp"

namespace topogeo::recording {

/// Among the readings below options.range_max_m; empty if there is no such range, or if the options
/// do not ask for it. `drive` is that of a recording, none of a CARMEN log. Throws like LogReader.
std::optional<scan::NoReturn> find_no_return(const std::filesystem::path& path,
                                             const scan::CarmenLogOptions& options,
                                             const std::shared_ptr<const Drive>& drive);

}  // namespace topogeo::recording
