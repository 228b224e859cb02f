// The side of the bridge that nodes of ROS see: a participant of its own, beside that of the
// service.
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>

#include "topogeo/messaging/participant.hpp"
#include "topogeo/ros_conversions/geometry.hpp"
#include "topogeo/ros_messaging/topic.hpp"
#include "topogeo/service/service.hpp"

#include "settings.hpp"

namespace topogeo::ros_bridge {

class RosSide {
 public:
  /// `domain`: of ROS. Throws like messaging::Participant.
  RosSide(service::Service& service, Settings settings, std::uint32_t domain);

  [[nodiscard]] service::Service& service() const { return service_; }
  [[nodiscard]] const Settings& settings() const { return settings_; }

  template <ros::Message T>
  messaging::Writer<T> advertise(const std::string& name, ros::Qos qos) {
    messaging::Writer<T> writer(participant_, ros::Topic{name, qos});
    service_.loop().add(writer);
    return writer;
  }

  /// Calls handler(message, info). std::invalid_argument from the handler is something in the
  /// message that cannot be used: see complain().
  template <ros::Message T, class Handler>
  void subscribe(const std::string& name, ros::Qos qos, Handler handler) {
    const messaging::Reader<T> reader(participant_, ros::Topic{name, qos});
    service_.loop().add<T>(reader, [this, name, handler = std::move(handler)](
                                       const T& message, const messaging::SampleInfo& info) {
      try {
        handler(message, info);
      } catch (const std::invalid_argument& error) {
        complain("unusable message of " + name, error.what());
      }
    });
  }

  /// Sends; counted as a fault when a reader is too slow.
  template <ros::Message T>
  void send(messaging::Writer<T>& writer, const T& message) {
    if (!writer.write(message)) {
      service_.status().fault("ROS reader is slow", writer.core()->topic());
    }
  }

  /// Counts something that cannot be used among the drops of the status, and logs the first of its
  /// reason (up to 48 bytes, a fixed text).
  void complain(const std::string& reason, const std::string& detail);
  /// As complain() for what is counted elsewhere.
  void set_complaints(const std::string& reason, std::uint64_t count, const std::string& detail);
  /// What was complained of last, for people; empty: nothing.
  [[nodiscard]] const std::string& last_complaint() const { return last_complaint_; }

  /// The newest stamp of the sensors, which is the time that ROS has; 0 before the first.
  [[nodiscard]] std::int64_t now_ns() const { return now_ns_; }
  void set_now(std::int64_t stamp_ns) { now_ns_ = ros::usable_stamp_ns(stamp_ns); }

 private:
  void say_once(const std::string& reason, const std::string& detail);

  service::Service& service_;
  Settings settings_;
  messaging::Participant participant_;
  std::set<std::string> said_;
  std::string last_complaint_;
  std::int64_t now_ns_ = 0;
};

/// One of several writers of a topic that only one should write: the first, until it is silent for
/// a second.
class SoleWriter {
 public:
  /// False for those of another writer. Times are of a steady clock.
  bool accept(const messaging::Handle& writer, std::int64_t steady_ns) {
    constexpr std::int64_t kSilence_ns = 1'000'000'000;
    if (writer_ && *writer_ != writer && steady_ns - last_ns_ < kSilence_ns) return false;
    writer_ = writer;
    last_ns_ = steady_ns;
    return true;
  }

 private:
  std::optional<messaging::Handle> writer_;
  std::int64_t last_ns_ = 0;
};

/// Of a steady clock.
std::int64_t steady_now_ns();

}  // namespace topogeo::ros_bridge
