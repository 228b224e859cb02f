#include "topogeo/ros_messaging/topic.hpp"

#include <algorithm>
#include <cstdint>
#include <exception>
#include <map>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string_view>

#include "topogeo/messaging/detail/type_support.hpp"
#include "topogeo/ros2/type_supports.h"

namespace topogeo::ros {
namespace {

/// First allocation for a sample of unknown size, bytes.
constexpr std::uint32_t kFirstPayload = 256;
constexpr std::size_t kLongestName = 247;

/// Whether the payload is long enough for the elements that it claims. The generated code only
/// requires one byte for each and allocates all of them, a hundred times the payload and more,
/// before it reads the first. This holds for every list, but among the messages that the bridge
/// reads only TFMessage has list elements much larger than a byte.
template <class T>
bool has_room(const messaging::Payload& /*payload*/) {
  return true;
}

template <>
bool has_room<TFMessage>(const messaging::Payload& payload) {
  /// Encapsulation and the number of transforms.
  constexpr std::size_t kStart_bytes = 8;
  /// A stamp, two empty texts, seven numbers.
  constexpr std::uint64_t kLeastTransform_bytes = 8 + 2 * 4 + 7 * 8;
  if (payload.length < kStart_bytes) return false;
  const bool little_endian = (payload.data[1] & 1U) != 0U;
  std::uint64_t transforms = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    transforms = transforms << 8U | payload.data[4 + (little_endian ? 3 - i : i)];
  }
  return transforms * kLeastTransform_bytes <= payload.length - kStart_bytes;
}

/// Data that a reader hands over: a message, or the fact that the payload held none.
template <class T>
struct Received final : public T {
  bool readable = true;
};

/// A payload that is no message of the type becomes one that find_defect refuses; otherwise the
/// middleware would read nothing behind it, and an exception of the generated code would end the
/// process.
template <class Generated>
class RosTypeSupport final : public messaging::detail::GrowingTypeSupport<Generated> {
  using Message = typename Generated::type;
  using Growing = messaging::detail::GrowingTypeSupport<Generated>;

 public:
  RosTypeSupport() : Growing(kFirstPayload) {}

 protected:
  void* make() override { return new Received<Message>; }  // NOLINT: the interface's
  void remove(void* data) override {
    delete static_cast<Received<Message>*>(data);  // NOLINT: as above
  }

  bool read(messaging::Payload& payload, void* data) override {
    auto& received = *static_cast<Received<Message>*>(data);
    received.readable = true;
    try {
      if (has_room<Message>(payload) && Growing::read(payload, static_cast<Message*>(&received))) {
        return true;
      }
    } catch (const std::exception&) {  // NOLINT(bugprone-empty-catch): as the false
    }
    received.readable = false;
    return true;
  }
};

template <class Generated>
eprosima::fastdds::dds::TopicDataType* make_ros_type() {
  return new RosTypeSupport<Generated>;  // NOLINT: the caller hands it to a dds::TypeSupport
}

template <class T>
std::optional<std::string> find_unreadable(const void* message) {
  if (static_cast<const Received<T>*>(message)->readable) return std::nullopt;
  return "the payload is not a message of its type";
}

std::optional<std::string> no_defect(const void* /*message*/) {
  return std::nullopt;
}

}  // namespace

void check_topic_name(const std::string& name) {
  const auto refuse = [&](const std::string& rule) {
    throw std::invalid_argument("topic '" + name + "': expected " + rule);
  };
  if (name.size() < 2 || name.front() != '/') refuse("a name that starts with '/'");
  if (name.size() > kLongestName) refuse("at most 247 characters");
  for (std::size_t i = 0; i < name.size(); ++i) {
    const char c = name[i];
    const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
    const bool digit = c >= '0' && c <= '9';
    if (!letter && !digit && c != '/') refuse("letters, digits, '_' and '/'");
    if (i == 0 || name[i - 1] != '/') continue;
    if (c == '/') refuse("no empty part");
    if (digit) refuse("no part that starts with a digit");
  }
  if (name.back() == '/') refuse("a name that does not end with '/'");
}

std::string role(Qos qos) {
  switch (qos) {
    case Qos::kBestEffort:
      return "ros_best_effort";
    case Qos::kLatched:
      return "ros_latched";
    case Qos::kTransforms:
      return "ros_transforms";
    case Qos::kReliable:
      break;
  }
  return "ros_reliable";
}

namespace {

struct NamedInfo {
  std::string name;
  messaging::TopicInfo info;
};

/// Keeps the topics that readers and writers point to.
const messaging::TopicInfo& keep(const std::string& key, const std::string& name,
                                 eprosima::fastdds::dds::TopicDataType* (*make_type)(),
                                 std::optional<std::string> (*find_defect)(const void*)) {
  static std::mutex mutex;
  static std::map<std::string, NamedInfo> topics;
  check_topic_name(name);
  const std::lock_guard lock(mutex);
  const auto [entry, added] = topics.try_emplace(key + name);
  if (added) {
    entry->second.name = "rt" + name;
    entry->second.info = {entry->second.name, "ros_reliable", "",     "",
                          make_type,          find_defect,    nullptr};
  }
  return entry->second.info;
}

}  // namespace

#define TOPOGEO_ROS_MESSAGE(Type, package)                                                    \
  template <>                                                                                 \
  const messaging::TopicInfo& reader_info<Type>(const std::string& name) {                    \
    return keep("read " #Type, name, make_ros_type<package::msg::dds_::Type##_PubSubType>,    \
                find_unreadable<Type>);                                                       \
  }                                                                                           \
  template <>                                                                                 \
  const messaging::TopicInfo& writer_info<Type>(const std::string& name) {                    \
    return keep("written " #Type, name, make_ros_type<package::msg::dds_::Type##_PubSubType>, \
                no_defect);                                                                   \
  }
TOPOGEO_ROS_MESSAGE(Clock, rosgraph_msgs)
TOPOGEO_ROS_MESSAGE(DiagnosticArray, diagnostic_msgs)
TOPOGEO_ROS_MESSAGE(LaserScan, sensor_msgs)
TOPOGEO_ROS_MESSAGE(MarkerArray, visualization_msgs)
TOPOGEO_ROS_MESSAGE(OccupancyGrid, nav_msgs)
TOPOGEO_ROS_MESSAGE(OccupancyGridUpdate, map_msgs)
TOPOGEO_ROS_MESSAGE(Odometry, nav_msgs)
TOPOGEO_ROS_MESSAGE(Path, nav_msgs)
TOPOGEO_ROS_MESSAGE(PoseStamped, geometry_msgs)
TOPOGEO_ROS_MESSAGE(PoseWithCovarianceStamped, geometry_msgs)
TOPOGEO_ROS_MESSAGE(TFMessage, tf2_msgs)
TOPOGEO_ROS_MESSAGE(Twist, geometry_msgs)
TOPOGEO_ROS_MESSAGE(TwistStamped, geometry_msgs)
#undef TOPOGEO_ROS_MESSAGE

}  // namespace topogeo::ros
