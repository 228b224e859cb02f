// Readers and writers of ROS 2 topics, for the participants of plain_participant.hpp and the event
// loop of messaging.
//
// On DDS, a ROS topic has the prefix "rt" and its own type name (ROS 2 design, "Topic and Service
// name mapping to DDS"). Strings and sequences are unbounded there; a payload that cannot be read
// becomes the event kInvalidSample.
#pragma once

#include <chrono>
#include <concepts>
#include <cstddef>
#include <functional>
#include <memory>
#include <string>

#include "topogeo/messaging/reader.hpp"
#include "topogeo/messaging/writer.hpp"
#include "topogeo/ros_conversions/messages.hpp"

namespace topogeo::ros {

template <class T, class... Types>
concept OneOf = (std::same_as<T, Types> || ...);

/// The messages that have topics of their own.
template <class T>
concept Message =
    OneOf<T, Clock, DiagnosticArray, LaserScan, MarkerArray, OccupancyGrid, OccupancyGridUpdate,
          Odometry, Path, PoseStamped, PoseWithCovarianceStamped, TFMessage, Twist, TwistStamped>;

/// Names the profiles of deploy/dds_profiles.xml.
enum class Qos {
  kBestEffort,  ///< lost samples are not sent again
  kReliable,    ///< lost packets are sent again
  kLatched,     ///< reliable, and late readers get the last message
  kTransforms   ///< reliable, deep enough for the many writers of /tf
};

struct Topic {
  std::string name;  ///< in ROS notation: "/scan"
  Qos qos = Qos::kReliable;
};

/// Throws std::invalid_argument naming the rule that `name` breaks: it starts with '/', has
/// letters, digits, '_' and '/', no part that is empty or starts with a digit, and at most 247
/// characters.
void check_topic_name(const std::string& name);

/// The topic of type T for readers, and below for writers; lives as long as the process. Throws
/// like check_topic_name.
template <Message T>
const messaging::TopicInfo& reader_info(const std::string& name);
template <Message T>
const messaging::TopicInfo& writer_info(const std::string& name);

/// Name of the profiles.
std::string role(Qos qos);

}  // namespace topogeo::ros

namespace topogeo::messaging {

/// Like the Reader of our own topics, but without disposals.
template <class T>
requires ros::Message<T>
class Reader<T> {
 public:
  Reader(const Participant& participant, const ros::Topic& topic)
      : core_(std::make_shared<detail::ReaderCore>(participant, ros::reader_info<T>(topic.name),
                                                   ros::role(topic.qos), std::string())) {}

  [[nodiscard]] int matched() const { return core_->matched(); }
  [[nodiscard]] const std::shared_ptr<detail::ReaderCore>& core() const { return core_; }

 private:
  std::shared_ptr<detail::ReaderCore> core_;
};

/// Like the Writer of our own topics.
template <class T>
requires ros::Message<T>
class Writer<T> {
 public:
  Writer(const Participant& participant, const ros::Topic& topic)
      : core_(std::make_shared<detail::WriterCore>(participant, ros::writer_info<T>(topic.name),
                                                   ros::role(topic.qos))) {}

  /// Returns false if a slow reader prevents sending. Throws std::runtime_error when the middleware
  /// fails.
  [[nodiscard]] bool write(const T& message) { return core_->write(&message); }
  [[nodiscard]] int matched() const { return core_->matched(); }
  /// True as soon as every connected reader has all written messages, false after `timeout`.
  [[nodiscard]] bool wait_for_acknowledgments(std::chrono::nanoseconds timeout) {
    return core_->wait_for_acknowledgments(timeout);
  }
  [[nodiscard]] const std::shared_ptr<detail::WriterCore>& core() const { return core_; }

 private:
  std::shared_ptr<detail::WriterCore> core_;
};

}  // namespace topogeo::messaging
