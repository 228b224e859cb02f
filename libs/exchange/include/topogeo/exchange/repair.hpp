// What can be saved of a damaged map (docs/exchange.md, "Damaged maps").
//
// Elements are read one by one: a local map, a pose, a loop that cannot be read costs itself alone.
// Where lengths are damaged too, reading goes on at the next place from which the rest fits
// together. What is missing then follows from what is there: poses from scan tracking, nodes and
// branches from the stops. A changed digit within an element that can be read is not noticed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "topogeo/exchange/output_file.hpp"
#include "topogeo/storage/map_document.hpp"
#include "topogeo/topomap/global_map_config.hpp"

namespace topogeo::exchange {

/// Elements of a map as they were stored: Protobuf messages of proto/map.proto, perhaps damaged.
struct StoredPieces {
  struct StoredStop {
    std::uint32_t id = 0;                ///< in the map
    std::string local_map;               ///< LocalMap
    std::optional<bool> starts_drive{};  ///< where it is stored beside
  };
  std::string robot_id;
  std::uint64_t seed = 0;
  std::uint64_t map_id = 0;
  std::uint64_t trajectory_version = 0;
  std::uint64_t map_version = 0;
  std::vector<StoredStop> stops;
  std::vector<std::string> poses;           ///< StopPose
  std::vector<std::string> loops;           ///< LoopClosure
  std::vector<std::string> edges;           ///< MapEdge
  std::vector<std::string> nodes;           ///< MapNode
  std::vector<std::string> branches;        ///< MapBranch
  std::vector<std::string> places;          ///< Place
  std::vector<std::string> zones;           ///< DrawnZone
  std::vector<std::string> lines;           ///< DrawnLine
  std::string grid;                         ///< DrawnGrid; "": none
  std::vector<std::string> refused_merges;  ///< RefusedMerge
  std::vector<std::string> rooms;           ///< Room
  std::vector<std::string> room_places;     ///< PlaceInRoom
  std::uint64_t last_room = 0;
  bool graph_incomplete = false;  ///< nodes or branches are among what was lost
  Notes damage;                   ///< what was lost already
};

/// The elements of a map file, as far as their lengths can be followed. Throws std::runtime_error
/// naming `name` when nothing in it is like a map file.
StoredPieces pieces_of_map_file(std::string_view bytes, const std::string& name);

/// The elements of a map database. Throws std::runtime_error naming the file when not even its
/// tables are known.
StoredPieces pieces_of_database(const std::filesystem::path& path);

struct RepairedMap {
  storage::MapDocument document;
  Notes lost;  ///< empty: nothing
};

/// A document that can be written. Throws std::runtime_error naming `name` when no local map and
/// nothing that was drawn is left.
RepairedMap assemble(const StoredPieces& pieces, const topomap::GlobalMapConfig& config,
                     const std::string& name);

}  // namespace topogeo::exchange
