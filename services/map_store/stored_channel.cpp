#include "stored_channel.hpp"

#include <algorithm>
#include <chrono>
#include <optional>
#include <vector>

#include "topogeo/messaging/message.hpp"
#include "topogeo/service/conversions.hpp"

namespace topogeo::map_store {

StoredChannel::StoredChannel(service::Service& service)
    : service_(service), writer_(service.advertise<msg::StoredMap>()), robots_(service.robot_id()) {
  sent_[service.robot_id()];
  for (const std::string& robot : service.setup().options.other_robots) sent_[robot];
}

void StoredChannel::publish(const storage::MapDatabase& database) {
  for (auto& [robot, sent] : sent_) publish(database, robot, sent);
}

void StoredChannel::withdraw() {
  constexpr std::chrono::milliseconds kPatience{500};
  for (const auto& [robot, sent] : sent_) writer_.dispose(sent.message);
  static_cast<void>(writer_.wait_for_acknowledgments(kPatience));
}

void StoredChannel::publish(const storage::MapDatabase& database, const std::string& robot,
                            Sent& sent) {
  const std::vector<storage::SessionState> sessions = database.sessions();
  const auto newest =
      std::find_if(sessions.rbegin(), sessions.rend(), [&](const storage::SessionState& session) {
        return !session.is_over && robots_.of(session, database) == robot;
      });
  const storage::SessionState none;
  const storage::SessionState& session = newest == sessions.rend() ? none : *newest;
  msg::StoredMap message = sent.message;
  message.map_id(database.map_id());
  message.stops(database.local_map_count());
  message.earlier_stops(database.local_map_count() - session.joined);
  if (session.id != sent.message.session() || session.stops != sent.message.session_stops()) {
    message.session(session.id);
    message.session_stops(session.stops);
    const auto last =
        session.stops > 0 ? database.stop({session.id, session.stops - 1}) : std::nullopt;
    const topomap::LocalMap stop = last.value_or(topomap::LocalMap{});
    message.stamp_ns(stop.stamp_ns);
    message.content_hash(last ? topomap::content_hash(stop) : 0);
    message.T_odom_robot(service::to_msg(stop.T_odom_robot));
    message.odometry_epoch(stop.odometry_epoch);
  }
  if (sent.count > 0 && message == sent.message) return;
  messaging::set_header(message, robot, message.stamp_ns(), sent.count);
  if (!writer_.write(message)) {
    service_.status().fault("acknowledgement not sent", std::to_string(message.session_stops()));
    return;
  }
  ++sent.count;
  sent.message = message;
}

}  // namespace topogeo::map_store
