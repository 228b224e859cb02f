// The formats of maps on the command line of `topogeo store`.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "topogeo/exchange/map_formats.hpp"

namespace topogeo::cli {

/// The permitted values of an option.
std::vector<std::string> names_of(std::span<const exchange::MapFormat> formats);

/// A line for each format: its name and its text `help`.
std::string help_of(std::span<const exchange::MapFormat> formats,
                    std::string_view exchange::MapFormat::*help);

}  // namespace topogeo::cli
