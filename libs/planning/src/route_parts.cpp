#include "topogeo/planning/route_parts.hpp"

#include <array>

namespace topogeo::planning {

std::string_view describe(PlannedOn on) {
  constexpr std::array<std::string_view, 4> kWords = {"grid", "branch", "virtual branch",
                                                      "off branch"};
  const auto index = static_cast<std::size_t>(on);
  return index < kWords.size() ? kWords.at(index) : "unknown part";
}

}  // namespace topogeo::planning
