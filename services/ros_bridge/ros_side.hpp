// The bridge as ROS nodes see it: a participant of its own, beside that of the service.
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

#include "recent_complaint.hpp"
#include "settings.hpp"

namespace topogeo::ros_bridge {

class RosSide {
 public:
  /// `domain`: DDS domain of ROS. Throws like messaging::Participant.
  RosSide(service::Service& service, Settings settings, std::uint32_t domain);

  [[nodiscard]] service::Service& service() const { return service_; }
  [[nodiscard]] const Settings& settings() const { return settings_; }

  template <ros::Message T>
  messaging::Writer<T> advertise(const std::string& name, ros::Qos qos) {
    messaging::Writer<T> writer(participant_, ros::Topic{name, qos});
    service_.loop().add(writer);
    return writer;
  }

  /// Calls handler(message, info). std::invalid_argument from the handler means that the message is
  /// unusable: see complain().
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

  /// Sends; a reader that is too slow counts as a fault.
  template <ros::Message T>
  void send(messaging::Writer<T>& writer, const T& message) {
    if (!writer.write(message)) {
      service_.status().fault("ROS reader is slow", writer.core()->topic());
    }
  }

  /// Counts an unusable input among the drops of the status, and logs the first one for each reason
  /// (a fixed text, up to 48 bytes).
  void complain(const std::string& reason, const std::string& detail);
  /// Same as complain(), for inputs counted elsewhere.
  void set_complaints(const std::string& reason, std::uint64_t count, const std::string& detail);
  /// The last complaint, for people; empty: none lately.
  [[nodiscard]] std::string recent_complaint() const;

  /// The newest stamp of the sensors, which is the current time for ROS; 0 before the first.
  [[nodiscard]] std::int64_t now_ns() const { return now_ns_; }
  void set_now(std::int64_t stamp_ns) { now_ns_ = ros::usable_stamp_ns(stamp_ns); }

 private:
  void say_once(const std::string& reason, const std::string& detail);

  service::Service& service_;
  Settings settings_;
  messaging::Participant participant_;
  std::set<std::string> said_;
  RecentComplaint complaint_;
  std::int64_t now_ns_ = 0;
};

/// Selects one writer of a topic that should have only one: the first, until it is silent for a
/// second.
class SoleWriter {
 public:
  /// False for messages of other writers. Times are of a steady clock.
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

}  // namespace topogeo::ros_bridge
