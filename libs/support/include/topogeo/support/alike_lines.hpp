// Shortens lists of lines that say the same about many things.
#pragma once

#include <span>
#include <string>
#include <vector>

namespace topogeo::support {

/// Largest number of alike lines that are printed one by one.
inline constexpr std::size_t kMostAlikeLines = 5;

/// The lines in their order, where more than kMostAlikeLines that differ only in digits and in
/// names between single quotes are one: the first, with "(and N more like this)".
[[nodiscard]] std::vector<std::string> merge_alike_lines(std::span<const std::string> lines);

}  // namespace topogeo::support
