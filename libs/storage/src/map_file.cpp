#include "topogeo/storage/map_file.hpp"

#include <algorithm>
#include <bit>
#include <limits>
#include <stdexcept>

#include <google/protobuf/io/coded_stream.h>

#include "topogeo/support/atomic_file.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/support/hash.hpp"

#include "file_content.hpp"
#include "map_conversions.hpp"

namespace topogeo::storage {
namespace {

constexpr std::string_view kFormat = "topogeo-map";
// Field 1 with its length: what every map file starts with.
constexpr std::string_view kStart = "\x0a\x0btopogeo-map";
constexpr std::size_t kChecksumFieldSize = 9;  // one byte of tag, eight of value
constexpr char kChecksumTag = 0x79;            // field 15, 64 bits

std::uint64_t little_endian(std::string_view bytes) {
  std::uint64_t value = 0;
  for (std::size_t i = bytes.size(); i-- > 0;) {
    value = (value << 8U) | static_cast<unsigned char>(bytes[i]);
  }
  return value;
}

/// Reads the version alone, so that a file of a newer format is called that and not damaged.
void check_start(std::string_view bytes, const std::string& name) {
  if (bytes.empty()) throw std::runtime_error(name + ": empty, expected a topogeo map");
  if (!bytes.starts_with(kStart.substr(0, bytes.size()))) {
    throw std::runtime_error(name + ": not a topogeo map (it does not start with 'topogeo-map')");
  }
  if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
    throw std::runtime_error(
        fmt::format("{}: {} bytes, expected at most 2 GB", name, bytes.size()));
  }
  bytes.remove_prefix(std::min(bytes.size(), kStart.size()));
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
  for (const auto& source : in.sources()) {
    document.sources.push_back({source.session(), source.number()});
  }
  for (const auto& edge : in.edges()) document.edges.push_back(from_proto(edge));
  check_document(document);
  return document;
}

}  // namespace

std::string map_file_bytes(const MapDocument& document) {
  try {
    check_document(document);
  } catch (const std::runtime_error& error) {
    throw std::invalid_argument(std::string("map to be written: ") + error.what());
  }
  proto::MapFile file;
  file.set_format(std::string(kFormat));
  file.set_format_version(kMapFormatVersion);
  file.set_robot_id(document.robot_id);
  file.set_seed(document.seed);
  for (const auto& map : document.local_maps) to_proto(map, file.add_local_maps());
  file.mutable_trajectory()->set_version(document.trajectory.version);
  for (const auto& stop : document.trajectory.stops) {
    to_proto(stop, file.mutable_trajectory()->add_stops());
  }
  for (const auto& closure : document.loop_closures) to_proto(closure, file.add_loop_closures());
  file.mutable_global_map()->set_version(document.global_map.version);
  for (const auto& node : document.global_map.nodes) {
    to_proto(node, file.mutable_global_map()->add_nodes());
  }
  for (const auto& branch : document.global_map.branches) {
    to_proto(branch, file.mutable_global_map()->add_branches());
  }
  if (!document.drawing.empty()) to_proto(document.drawing, file.mutable_drawing());
  file.set_map_id(document.map_id);
  for (const StopSource& source : document.sources) {
    proto::StopSource* entry = file.add_sources();
    entry->set_session(source.session);
    entry->set_number(source.number);
  }
  for (const MapEdge& edge : document.edges) to_proto(edge, file.add_edges());
  std::string bytes = deterministic_bytes(file);
  // Fields are serialized by number, so the checksum, which has the largest, is what comes last. It
  // is written by hand because Protobuf would leave out a checksum of zero.
  const std::uint64_t checksum = support::fnv1a(bytes);
  bytes += kChecksumTag;
  for (unsigned shift = 0; shift < 64; shift += 8) {
    bytes += std::bit_cast<char>(static_cast<unsigned char>((checksum >> shift) & 0xffU));
  }
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

void write_map_file(const std::filesystem::path& path, const MapDocument& document) {
  support::write_file_atomically(path, map_file_bytes(document));
}

MapDocument read_map_file(const std::filesystem::path& path) {
  return parse_map_file(file_content(path), path.string());
}

}  // namespace topogeo::storage
