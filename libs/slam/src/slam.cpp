#include "topogeo/slam/slam.hpp"

#include <stdexcept>
#include <string>

namespace topogeo::localization {

void check_next(const topomap::LocalMap& map, std::size_t next_id, const topomap::LocalMap* first) {
  if (map.id != next_id) {
    throw std::invalid_argument("localizer: got local map " + std::to_string(map.id) +
                                ", expected " + std::to_string(next_id));
  }
  if (first != nullptr) check_robot(map, *first);
}

void check_robot(const topomap::LocalMap& map, const topomap::LocalMap& first) {
  if (map.robot_id == first.robot_id) return;
  throw std::invalid_argument("localizer: local map " + std::to_string(map.id) + " is of robot '" +
                              map.robot_id + "', expected '" + first.robot_id + "'");
}

void check_follows(const topomap::StopId& stop, const topomap::StopId& last) {
  if (stop == last.next()) return;
  throw std::invalid_argument("localizer: got stop " + std::to_string(stop.number) + ", expected " +
                              std::to_string(last.next().number));
}

}  // namespace topogeo::localization
