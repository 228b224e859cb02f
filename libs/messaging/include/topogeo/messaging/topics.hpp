// The topics of topogeo: their names, types and roles, as the table in topics.def declares them.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace eprosima::fastdds::dds {
class TopicDataType;
}

namespace topogeo::msg {
// NOLINTNEXTLINE(bugprone-macro-parentheses): a declaration
#define TOPOGEO_TOPIC(Type, name, role, replay_role, addressee) class Type;
#include "topogeo/messaging/topics.def"
}  // namespace topogeo::msg

namespace topogeo::messaging {

/// Role of the sensor topics during the replay of a log: a slow reader slows the writer. Writer and
/// readers of a run must agree on it.
inline constexpr std::string_view kReplayRole = "sensor_replay";

// The names: kScan, kOdometry, ...
#define TOPOGEO_TOPIC(Type, name, role, replay_role, addressee) \
  inline constexpr std::string_view k##Type = TOPOGEO_TOPIC_PREFIX name;
#include "topogeo/messaging/topics.def"

/// A topic and its type.
struct TopicInfo {
  std::string_view name;
  std::string_view role;         ///< profiles in normal operation
  std::string_view replay_role;  ///< profiles while a log is replayed; empty: same as `role`
  /// Field that names the receiver of a message: the first one after the common header fields.
  /// Empty: messages are for every reader.
  std::string_view addressee;

  /// Makes the type support; the caller owns it.
  eprosima::fastdds::dds::TopicDataType* (*make_type)();
  /// The reason why a message of this type must not travel: another schema version or a sequence
  /// over its bound. The generated code checks neither.
  std::optional<std::string> (*find_defect)(const void* message);
  /// The robot_id of a message of this type, valid until the message changes. Null: the type has
  /// none.
  std::string_view (*robot_of)(const void* message) = nullptr;
};

/// TopicTraits<T>::info() for each message type that has a topic.
template <class T>
struct TopicTraits {
  static const TopicInfo& info();
};

#define TOPOGEO_TOPIC(Type, name, role, replay_role, addressee) \
  template <>                                                   \
  const TopicInfo& TopicTraits<msg::Type>::info();
#include "topogeo/messaging/topics.def"

/// Name without prefix and version: "local_map".
std::string_view short_name(const TopicInfo& topic);

/// All topics, ascending by name.
std::span<const TopicInfo* const> all_topics();

}  // namespace topogeo::messaging
