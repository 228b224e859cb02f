// The whole map of one robot, as in map.pb and the map database, and the origin of its stops.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "topogeo/planning/room_memory.hpp"
#include "topogeo/storage/loop_verdict.hpp"
#include "topogeo/storage/map_drawing.hpp"
#include "topogeo/topomap/global_map.hpp"
#include "topogeo/topomap/local_map.hpp"
#include "topogeo/topomap/trajectory.hpp"

namespace topogeo::storage {

/// A measured pose of one stop relative to another.
struct MapEdge {
  enum class Kind : std::uint8_t {
    kUnknown,     ///< not stated in the file
    kOdometry,    ///< of the base
    kSequential,  ///< a match with a stop shortly before
    kLoop,        ///< a match with a stop of an earlier visit
  };
  std::uint32_t earlier_id = 0;  ///< local map ids
  std::uint32_t later_id = 0;
  geometry::Pose2 T_earlier_later;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< in the frame of the earlier stop
  Kind kind = Kind::kUnknown;

  friend bool operator==(const MapEdge&, const MapEdge&) = default;
};

/// Two stops that do not show one place, as stated by a person who was asked whether two robots'
/// maps should be merged there. They need not be in the map.
struct RefusedMerge {
  topomap::StopId stop;
  topomap::StopId other;

  friend bool operator==(const RefusedMerge&, const RefusedMerge&) = default;
};

struct MapDocument {
  std::string robot_id;
  std::uint64_t seed = 0;
  std::vector<topomap::LocalMap> local_maps;  ///< index = local map id
  topomap::Trajectory trajectory;             ///< at most as many stops as local maps
  std::vector<topomap::LoopClosure> loop_closures;
  topomap::GlobalMap global_map;
  MapDrawing drawing;
  std::uint64_t map_id = 0;    ///< the same in all states of a map; 0: none
  std::vector<MapEdge> edges;  ///< source of the trajectory; empty: unknown
  std::vector<RefusedMerge> refused_merges = {};
  planning::RoomMemory rooms = {};  ///< keeps their numbers; empty: none given yet
  /// Evidence for the loops and against rejected ones, of the last drives; not part of the map
  /// files of a run, whose report has it.
  std::vector<LoopVerdict> loop_verdicts = {};
};

/// The document with a session for all its stops and a map id: missing ones are derived from its
/// content, so that the same file always gives the same session. Unchanged without local maps.
MapDocument identified(MapDocument document);

/// Gives each pose the stop of its local map, because files store it once.
void name_stops(MapDocument& document);

/// The id of the map that begins with a session; never 0.
std::uint64_t map_id_of(std::uint64_t first_session);

}  // namespace topogeo::storage
