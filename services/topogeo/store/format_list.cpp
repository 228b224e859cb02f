#include "store/format_list.hpp"

#include <algorithm>
#include <cstddef>

#include "topogeo/support/format.hpp"

namespace topogeo::cli {

std::vector<std::string> names_of(std::span<const exchange::MapFormat> formats) {
  std::vector<std::string> names;
  for (const exchange::MapFormat& format : formats) names.emplace_back(format.name);
  return names;
}

std::string help_of(std::span<const exchange::MapFormat> formats,
                    std::string_view exchange::MapFormat::*help) {
  std::size_t width = 0;
  for (const exchange::MapFormat& format : formats) width = std::max(width, format.name.size());
  std::string text;
  for (const exchange::MapFormat& format : formats) {
    text += fmt::format("{:<{}}  {}\n", format.name, width, format.*help);
  }
  return text;
}

}  // namespace topogeo::cli
