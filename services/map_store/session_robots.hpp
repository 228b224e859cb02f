// Finds the robot of a session by the session's stops, when several robots share a map.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>

#include "topogeo/storage/map_database.hpp"

namespace topogeo::map_store {

class SessionRobots {
 public:
  /// `robot`: robot of the map, used for sessions without any stop.
  explicit SessionRobots(std::string robot) : robot_(std::move(robot)) {}

  /// Records that a stop of the session came from that robot.
  void name(std::uint64_t session, const std::string& robot) { names_.try_emplace(session, robot); }
  /// Robot of a stored session; read from one of its stored stops when none was recorded.
  [[nodiscard]] const std::string& of(const storage::SessionState& session,
                                      const storage::MapDatabase& database);

 private:
  std::string robot_;
  std::map<std::uint64_t, std::string> names_;
};

}  // namespace topogeo::map_store
