// Whose a session is, where several robots share a map: its stops say.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>

#include "topogeo/storage/map_database.hpp"

namespace topogeo::map_store {

class SessionRobots {
 public:
  /// `robot`: of the map; that of sessions without any stop.
  explicit SessionRobots(std::string robot) : robot_(std::move(robot)) {}

  /// A stop of the session came from there.
  void name(std::uint64_t session, const std::string& robot) { names_.try_emplace(session, robot); }
  /// Of a stored session, by one of its stops when none came.
  [[nodiscard]] const std::string& of(const storage::SessionState& session,
                                      const storage::MapDatabase& database);

 private:
  std::string robot_;
  std::map<std::uint64_t, std::string> names_;
};

}  // namespace topogeo::map_store
