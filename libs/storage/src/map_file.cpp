#include "topogeo/storage/map_file.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include <google/protobuf/io/coded_stream.h>

#include "topogeo/support/atomic_file.hpp"
#include "topogeo/support/file_content.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/support/hash.hpp"

#include "map_conversions.hpp"
#include "map_file_format.hpp"
#include "map_file_writer.hpp"

namespace topogeo::storage {
namespace {

std::uint64_t little_endian(std::string_view bytes) {
  std::uint64_t value = 0;
  for (std::size_t i = bytes.size(); i-- > 0;) {
    value = (value << 8U) | static_cast<unsigned char>(bytes[i]);
  }
  return value;
}

/// Reads the version alone, so that a file of a newer format is reported as such and not as
/// damaged.
void check_start(std::string_view bytes, const std::string& name) {
  if (bytes.empty()) throw std::runtime_error(name + ": empty, expected a topogeo map");
  if (!bytes.starts_with(kMapFileStart.substr(0, bytes.size()))) {
    throw std::runtime_error(name + ": not a topogeo map (it does not start with 'topogeo-map')");
  }
  if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
    throw std::runtime_error(
        fmt::format("{}: {} bytes, expected at most 2 GB", name, bytes.size()));
  }
  bytes.remove_prefix(std::min(bytes.size(), kMapFileStart.size()));
  google::protobuf::io::CodedInputStream in(reinterpret_cast<const std::uint8_t*>(bytes.data()),
                                            static_cast<int>(bytes.size()));
  constexpr std::uint32_t kVersionTag = 2U << 3U;
  std::uint32_t version = 0;
  if (in.ReadTag() != kVersionTag || !in.ReadVarint32(&version)) {
    throw std::runtime_error(name + ": cut short or damaged (no format version)");
  }
  if (version == 0 || version > kMapFormatVersion) {
    throw std::runtime_error(fmt::format("{}: map format version {}, this program reads up to {}",
                                         name, version, kMapFormatVersion));
  }
}

void check_checksum(std::string_view bytes, const std::string& name) {
  const bool has_field =
      bytes.size() > kChecksumFieldSize && bytes[bytes.size() - kChecksumFieldSize] == kChecksumTag;
  if (!has_field || little_endian(bytes.substr(bytes.size() - 8)) !=
                        support::fnv1a(bytes.substr(0, bytes.size() - kChecksumFieldSize))) {
    throw std::runtime_error(fmt::format(
        "{}: cut short or damaged (the checksum of its {} bytes is wrong)", name, bytes.size()));
  }
}

MapDocument document_from_proto(const proto::MapFile& in) {
  MapDocument document;
  document.robot_id = in.robot_id();
  document.seed = in.seed();
  for (const auto& map : in.local_maps()) document.local_maps.push_back(from_proto(map));
  document.trajectory.version = in.trajectory().version();
  document.trajectory.numbered_since = in.trajectory().numbered_since();
  for (const auto& stop : in.trajectory().stops()) {
    document.trajectory.stops.push_back(from_proto(stop));
  }
  for (const auto& closure : in.loop_closures()) {
    document.loop_closures.push_back(from_proto(closure));
  }
  document.global_map.version = in.global_map().version();
  for (const auto& node : in.global_map().nodes()) {
    document.global_map.nodes.push_back(from_proto(node));
  }
  for (const auto& branch : in.global_map().branches()) {
    document.global_map.branches.push_back(from_proto(branch));
  }
  if (in.has_drawing()) document.drawing = from_proto(in.drawing());
  document.map_id = in.map_id();
  for (const auto& edge : in.edges()) document.edges.push_back(from_proto(edge));
  for (const auto& refused : in.refused_merges()) {
    document.refused_merges.push_back(from_proto(refused));
  }
  if (in.has_rooms()) document.rooms = from_proto(in.rooms());
  for (const auto& verdict : in.loop_verdicts()) {
    document.loop_verdicts.push_back(from_proto(verdict));
  }
  check_document(document);
  name_stops(document);
  return document;
}

}  // namespace

std::string map_file_bytes(const MapDocument& document) {
  try {
    check_document(document);
  } catch (const std::runtime_error& error) {
    throw std::invalid_argument(std::string("map to be written: ") + error.what());
  }
  std::string bytes;
  MapFileWriter writer([&](std::string_view piece) { bytes += piece; }, document.robot_id,
                       document.seed);
  for (const topomap::LocalMap& map : document.local_maps) writer.add(map);
  writer.finish(document);
  return bytes;
}

MapDocument parse_map_file(std::string_view bytes, const std::string& name) {
  check_start(bytes, name);
  check_checksum(bytes, name);
  proto::MapFile file;
  if (!file.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) {
    throw std::runtime_error(name + ": damaged (not a valid Protobuf message)");
  }
  try {
    return document_from_proto(file);
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(name + ": " + error.what());
  }
}

std::string local_maps_bytes(std::span<const topomap::LocalMap> maps) {
  proto::LocalMaps message;
  for (const topomap::LocalMap& map : maps) to_proto(map, message.add_local_maps());
  return deterministic_bytes(message);
}

std::vector<topomap::LocalMap> parse_local_maps(std::string_view bytes, const std::string& name) {
  proto::LocalMaps message;
  if (!message.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) {
    throw std::runtime_error(name + ": damaged (not a valid Protobuf message)");
  }
  try {
    std::vector<topomap::LocalMap> maps;
    for (const proto::LocalMap& map : message.local_maps()) maps.push_back(from_proto(map));
    return maps;
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(name + ": " + error.what());
  }
}

void write_map_file(const std::filesystem::path& path, const MapDocument& document) {
  support::write_file_atomically(path, map_file_bytes(document));
}

MapDocument read_map_file(const std::filesystem::path& path) {
  return parse_map_file(support::file_content(path), path.string());
}

}  // namespace topogeo::storage
