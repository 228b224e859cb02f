// Converts between the project's types and the Protobuf messages of proto/map.proto.
//
// Reading checks every guarantee of the types, so that a damaged blob cannot become an index out of
// range later on: each from_proto throws std::runtime_error naming the field and the cause.
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "topogeo/storage/map_document.hpp"

#include "proto/map.pb.h"

namespace topogeo::storage {

void to_proto(const topomap::LocalMap& map, proto::LocalMap* out);
void to_proto(const topomap::StopPose& stop, proto::StopPose* out);
void to_proto(const topomap::LoopClosure& closure, proto::LoopClosure* out);
void to_proto(const MapEdge& edge, proto::MapEdge* out);
void to_proto(const topomap::MapNode& node, proto::MapNode* out);
void to_proto(const topomap::MapBranch& branch, proto::MapBranch* out);
void to_proto(const geometry::Pose2& pose, proto::Pose2* out);
void to_proto(const planning::Place& place, proto::Place* out);
void to_proto(const planning::DrawnZone& zone, proto::DrawnZone* out);
void to_proto(const planning::DrawnLine& line, proto::DrawnLine* out);
void to_proto(const planning::OccupancyGrid& grid, proto::DrawnGrid* out);
/// The drawing must have passed check(MapDrawing).
void to_proto(const MapDrawing& drawing, proto::Drawing* out);
void to_proto(const RefusedMerge& refused, proto::RefusedMerge* out);
void to_proto(const planning::RememberedRoom& room, proto::Room* out);
void to_proto(const planning::RememberedPlace& place, proto::PlaceInRoom* out);
void to_proto(const planning::RoomMemory& rooms, proto::Rooms* out);
void to_proto(const LoopVerdict& verdict, proto::LoopVerdict* out);

topomap::LocalMap from_proto(const proto::LocalMap& in);
topomap::StopPose from_proto(const proto::StopPose& in);
topomap::LoopClosure from_proto(const proto::LoopClosure& in);
MapEdge from_proto(const proto::MapEdge& in);
RefusedMerge from_proto(const proto::RefusedMerge& in);
topomap::MapNode from_proto(const proto::MapNode& in);
topomap::MapBranch from_proto(const proto::MapBranch& in);
geometry::Pose2 from_proto(const proto::Pose2& in, const char* what);
planning::Place from_proto(const proto::Place& in);
planning::DrawnZone from_proto(const proto::DrawnZone& in);
planning::DrawnLine from_proto(const proto::DrawnLine& in);
planning::OccupancyGrid from_proto(const proto::DrawnGrid& in);
planning::RememberedRoom from_proto(const proto::Room& in);
planning::RememberedPlace from_proto(const proto::PlaceInRoom& in);
planning::RoomMemory from_proto(const proto::Rooms& in);  ///< checked with check_rooms()
LoopVerdict from_proto(const proto::LoopVerdict& in);
MapDrawing from_proto(const proto::Drawing& in);  ///< checked with check(MapDrawing)

/// Throws std::runtime_error unless ids, robot ids and references between the parts are consistent.
void check_document(const MapDocument& document);
void check_global_map(const topomap::GlobalMap& map);
void check_rooms(const planning::RoomMemory& rooms);
void check_edges(const std::vector<MapEdge>& edges, std::size_t map_count);
void check_verdicts(const std::vector<LoopVerdict>& verdicts, std::size_t map_count);

/// Turns the std::runtime_error of a check into a std::invalid_argument that names the file.
template <typename Check>
void require_valid(const std::string& file, const char* what, const Check& check) {
  try {
    check();
  } catch (const std::runtime_error& error) {
    throw std::invalid_argument(file + ": " + what + error.what());
  }
}

/// The same bytes for the same message on every machine. Throws std::runtime_error above 2 GB.
std::string deterministic_bytes(const google::protobuf::MessageLite& message);

template <typename Message, typename Value>
std::string to_blob(const Value& value) {
  Message message;
  to_proto(value, &message);
  return deterministic_bytes(message);
}

}  // namespace topogeo::storage
