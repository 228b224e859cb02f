#include "pose_text.hpp"

#include <cmath>
#include <exception>

namespace topogeo::pipeline {

std::optional<std::array<double, 3>> parse_three_numbers(const std::string& text) {
  std::array<double, 3> values{};
  std::size_t begin = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::size_t end = i + 1 < values.size() ? text.find(',', begin) : text.size();
    if (end == std::string::npos || end <= begin) return std::nullopt;
    std::size_t used = 0;
    try {
      values.at(i) = std::stod(text.substr(begin, end - begin), &used);
    } catch (const std::exception&) {
      return std::nullopt;
    }
    if (used != end - begin || !std::isfinite(values.at(i))) return std::nullopt;
    begin = end + 1;
  }
  return values;
}

}  // namespace topogeo::pipeline
