// Tells senders what is stored: a message for each robot that shares the map, after each
// transaction that has changed something of it.
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

  /// Stops of the session come from that robot.
  void name_session(std::uint64_t session, const std::string& robot) {
    robots_.name(session, robot);
  }
  /// What the database has now, as far as it was not sent.
  void publish(const storage::MapDatabase& database);
  /// Another map takes the place of this one: who has made something of it begins anew.
  void withdraw();

 private:
  /// What was sent last, and how many messages were.
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
