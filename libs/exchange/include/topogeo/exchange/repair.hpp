// Saves the readable parts of a damaged map (docs/exchange.md, "Damaged maps").
//
// Elements are read one by one, so an unreadable local map, pose or loop costs only itself. After
// damaged lengths, reading continues at the next place from which the rest is consistent. Missing
// parts are derived from the others: poses from scan tracking, nodes and branches from the stops. A
// changed digit within a readable element is not detected.
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

/// Elements of a map as stored: Protobuf messages of proto/map.proto, possibly damaged.
struct StoredPieces {
  struct StoredStop {
    std::uint32_t id = 0;                ///< in the map
    std::string local_map;               ///< LocalMap
    std::optional<bool> starts_drive{};  ///< if stored separately
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
  bool graph_incomplete = false;  ///< nodes or branches were lost
  Notes damage;                   ///< parts that are already lost
};

/// The elements of a map file, as far as their lengths can be followed. Throws std::runtime_error
/// naming `name` if nothing in it resembles a map file.
StoredPieces pieces_of_map_file(std::string_view bytes, const std::string& name);

/// The elements of a map database. Throws std::runtime_error naming the file if not even its tables
/// can be read.
StoredPieces pieces_of_database(const std::filesystem::path& path);

struct RepairedMap {
  storage::MapDocument document;
  Notes lost;  ///< empty: nothing is lost
};

/// Makes a document that can be written. Throws std::runtime_error naming `name` if neither a local
/// map nor a part of the drawing is left.
RepairedMap assemble(const StoredPieces& pieces, const topomap::GlobalMapConfig& config,
                     const std::string& name);

}  // namespace topogeo::exchange
