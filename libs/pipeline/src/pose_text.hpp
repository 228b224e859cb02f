// Poses in flags of commands and services.
#pragma once

#include <array>
#include <optional>
#include <string>

namespace topogeo::pipeline {

/// The numbers of "a,b,c"; empty unless the text consists of exactly three finite ones.
std::optional<std::array<double, 3>> parse_three_numbers(const std::string& text);

}  // namespace topogeo::pipeline
