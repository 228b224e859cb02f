#include "session_robots.hpp"

#include <utility>

namespace topogeo::map_store {

const std::string& SessionRobots::of(const storage::SessionState& session,
                                     const storage::MapDatabase& database) {
  const auto known = names_.find(session.id);
  if (known != names_.end()) return known->second;
  if (session.stops == 0) return robot_;
  const auto stop = database.stop({session.id, session.stops - 1});
  if (!stop) return robot_;
  return names_.emplace(session.id, stop->robot_id).first->second;
}

}  // namespace topogeo::map_store
