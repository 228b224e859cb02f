// Reads a log for the range that its laser reports if no echo has returned.
#pragma once

#include <filesystem>
#include <optional>

#include "topogeo/recording/survey.hpp"
#include "topogeo/scan/carmen_log_config.hpp"
#include "topogeo/scan/no_return.hpp"

namespace topogeo::recording {

/// Among the readings below options.range_max_m; empty if there is no such range, or if the options
/// do not ask for it. Throws like LogReader.
std::optional<scan::NoReturn> find_no_return(const std::filesystem::path& path,
                                             const scan::CarmenLogOptions& options,
                                             const TopicChoice& topics);

}  // namespace topogeo::recording
