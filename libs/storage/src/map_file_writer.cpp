#include "map_file_writer.hpp"

#include <bit>
#include <utility>

#include "topogeo/storage/map_file.hpp"

#include "map_file_format.hpp"

namespace topogeo::storage {

MapFileWriter::MapFileWriter(Sink sink, const std::string& robot_id, std::uint64_t seed)
    : sink_(std::move(sink)) {
  proto::MapFile fields;
  fields.set_format(std::string(kMapFormat));
  fields.set_format_version(kMapFormatVersion);
  fields.set_robot_id(robot_id);
  fields.set_seed(seed);
  write(fields);
}

void MapFileWriter::write(const proto::MapFile& fields) {
  const std::string bytes = deterministic_bytes(fields);
  hash_.add(bytes);
  sink_(bytes);
}

void MapFileWriter::add(const topomap::LocalMap& map) {
  proto::MapFile fields;
  to_proto(map, fields.add_local_maps());
  write(fields);
}

void MapFileWriter::finish(const MapDocument& rest) {
  proto::MapFile fields;
  fields.mutable_trajectory()->set_version(rest.trajectory.version);
  fields.mutable_trajectory()->set_numbered_since(rest.trajectory.numbered_since);
  for (const auto& stop : rest.trajectory.stops) {
    to_proto(stop, fields.mutable_trajectory()->add_stops());
  }
  for (const auto& closure : rest.loop_closures) to_proto(closure, fields.add_loop_closures());
  fields.mutable_global_map()->set_version(rest.global_map.version);
  for (const auto& node : rest.global_map.nodes) {
    to_proto(node, fields.mutable_global_map()->add_nodes());
  }
  for (const auto& branch : rest.global_map.branches) {
    to_proto(branch, fields.mutable_global_map()->add_branches());
  }
  if (!rest.drawing.empty()) to_proto(rest.drawing, fields.mutable_drawing());
  fields.set_map_id(rest.map_id);
  for (const MapEdge& edge : rest.edges) to_proto(edge, fields.add_edges());
  for (const RefusedMerge& refused : rest.refused_merges) {
    to_proto(refused, fields.add_refused_merges());
  }
  if (!rest.rooms.empty()) to_proto(rest.rooms, fields.mutable_rooms());
  for (const LoopVerdict& verdict : rest.loop_verdicts) {
    to_proto(verdict, fields.add_loop_verdicts());
  }
  write(fields);
  // The checksum has the largest number, so it comes last. It is written by hand because Protobuf
  // would leave out a checksum of zero.
  std::string end(1, kChecksumTag);
  const std::uint64_t checksum = hash_.value();
  for (unsigned shift = 0; shift < 64; shift += 8) {
    end += std::bit_cast<char>(static_cast<unsigned char>((checksum >> shift) & 0xffU));
  }
  sink_(end);
}

}  // namespace topogeo::storage
