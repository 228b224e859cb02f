#include "topogeo/topomap/node_kind_name.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

namespace topogeo::topomap {
namespace {

// Index: NodeKind.
constexpr std::array<std::string_view, 6> kKindNames = {"real", "fictitious", "virtual",
                                                        "door", "narrowing",  "hall_corridor"};
static_assert(kKindNames.size() == static_cast<std::size_t>(NodeKind::kHallCorridor) + 1);

}  // namespace

std::string_view name_of(NodeKind kind) {
  const auto number = static_cast<std::size_t>(kind);
  return number < kKindNames.size() ? kKindNames.at(number) : std::string_view("unknown");
}

std::optional<NodeKind> node_kind_of(std::string_view name) {
  const auto found = std::ranges::find(kKindNames, name);
  if (found == kKindNames.end()) return std::nullopt;
  return static_cast<NodeKind>(found - kKindNames.begin());
}

}  // namespace topogeo::topomap
