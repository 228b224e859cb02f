// Names of the kinds of nodes in files, messages and commands.
#pragma once

#include <optional>
#include <string_view>

#include "topogeo/topomap/local_map.hpp"

namespace topogeo::topomap {

/// "real", "fictitious", "virtual", "door", "narrowing", "hall_corridor"; "unknown" for any other
/// number.
std::string_view name_of(NodeKind kind);
/// Empty for any other word.
std::optional<NodeKind> node_kind_of(std::string_view name);

}  // namespace topogeo::topomap
