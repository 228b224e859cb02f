// Acknowledges stored data to its senders: a message for each robot that shares the map, after each
// transaction that changed the robot's part.
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/store.h"
#include "topogeo/service/service.hpp"
#include "topogeo/storage/map_database.hpp"

#include "session_robots.hpp"

namespace topogeo::map_store {

class StoredChannel {
 public:
  explicit StoredChannel(service::Service& service);

  /// Records that the stops of a session come from that robot.
  void name_session(std::uint64_t session, const std::string& robot) {
    robots_.name(session, robot);
  }
  /// Publishes the state of the database where it has changed.
  void publish(const storage::MapDatabase& database);
  /// Announces that another map replaces this one: users of this map start over.
  void withdraw();

 private:
  /// The last message, and the number of messages sent.
  struct Sent {
    msg::StoredMap message;
    std::uint64_t count = 0;
  };
  void publish(const storage::MapDatabase& database, const std::string& robot, Sent& sent);

  service::Service& service_;
  messaging::Writer<msg::StoredMap> writer_;
  SessionRobots robots_;
  std::map<std::string, Sent> sent_;  // by robot
};

}  // namespace topogeo::map_store
