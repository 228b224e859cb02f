// The map file map.pb: Protobuf as in proto/map.proto, the same bytes for the same map on every
// machine.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "topogeo/storage/map_document.hpp"

namespace topogeo::storage {

inline constexpr std::uint32_t kMapFormatVersion = 1;

/// Writes the file whole or not at all. Throws std::runtime_error naming the path if it cannot be
/// written, std::invalid_argument if the map contradicts itself (as in read_map_file).
void write_map_file(const std::filesystem::path& path, const MapDocument& document);

/// Throws std::runtime_error naming the path and the cause: not a map file, a newer format,
/// truncated or damaged, or contradictory content (a number that is not finite, an end of a branch
/// or a stop that does not exist, ids out of order).
MapDocument read_map_file(const std::filesystem::path& path);

/// The bytes of the file, and the reverse; messages name `name` as the file. They throw as above.
std::string map_file_bytes(const MapDocument& document);
MapDocument parse_map_file(std::string_view bytes, const std::string& name);

/// Local maps only, as a map store sends those of a session (proto/map.proto, LocalMaps), and the
/// reverse. Throws std::runtime_error naming `name` and the damage.
std::string local_maps_bytes(std::span<const topomap::LocalMap> maps);
std::vector<topomap::LocalMap> parse_local_maps(std::string_view bytes, const std::string& name);

}  // namespace topogeo::storage
