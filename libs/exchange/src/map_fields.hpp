// Field numbers of libs/storage/proto/map.proto, which never change.
#pragma once

#include <cstdint>

namespace topogeo::exchange {

struct MapFields {
  static constexpr std::uint32_t kFormat = 1;
  static constexpr std::uint32_t kVersion = 2;
  static constexpr std::uint32_t kRobot = 3;
  static constexpr std::uint32_t kSeed = 4;
  static constexpr std::uint32_t kLocalMap = 5;
  static constexpr std::uint32_t kTrajectory = 6;
  static constexpr std::uint32_t kLoop = 7;
  static constexpr std::uint32_t kGlobalMap = 8;
  static constexpr std::uint32_t kDrawing = 9;
  static constexpr std::uint32_t kMapId = 10;
  static constexpr std::uint32_t kEdge = 11;
  static constexpr std::uint32_t kRefusedMerge = 12;
  static constexpr std::uint32_t kRooms = 13;
  static constexpr std::uint32_t kChecksum = 15;

  static constexpr std::uint32_t kRobotOfLocalMap = 1;
  static constexpr std::uint32_t kIdOfLocalMap = 2;
  static constexpr std::uint32_t kFirstOfPair = 1;  // of LoopClosure and MapEdge
  static constexpr std::uint32_t kSecondOfPair = 2;
  static constexpr std::uint32_t kIdOfPose = 1;
  static constexpr std::uint32_t kStopsOfTrajectory = 2;
  static constexpr std::uint32_t kNodes = 2;  // of GlobalMap
  static constexpr std::uint32_t kBranches = 3;
  static constexpr std::uint32_t kNodeA = 2;  // of MapBranch
  static constexpr std::uint32_t kNodeB = 3;
  static constexpr std::uint32_t kPlaces = 1;  // of Drawing
  static constexpr std::uint32_t kZones = 2;
  static constexpr std::uint32_t kGrid = 3;
  static constexpr std::uint32_t kLines = 4;
  static constexpr std::uint32_t kRoom = 1;  // of Rooms
  static constexpr std::uint32_t kPlaceInRoom = 2;
  static constexpr std::uint32_t kLastRoom = 3;
  static constexpr std::uint32_t kSession = 1;  // of RefusedMerge
  static constexpr std::uint32_t kNumber = 2;
  static constexpr std::uint32_t kOtherSession = 3;
  static constexpr std::uint32_t kOtherNumber = 4;
};

}  // namespace topogeo::exchange
