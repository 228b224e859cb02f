#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <fastdds/dds/topic/TypeSupport.hpp>

#include "topogeo/ros_conversions/geometry.hpp"
#include "topogeo/ros_messaging/topic.hpp"

#include "checks.hpp"
#include "payload.hpp"
#include "ros_bridge_check.hpp"

namespace topogeo::fuzz {
namespace {

// Handling of a payload in the middleware.

/// A reader's message, which decodes each payload over the previous one.
template <class Message>
class Slot {
 public:
  explicit Slot(const messaging::TopicInfo& topic)
      : topic_(topic), type_(topic.make_type()), data_(type_.create_data()) {}
  Slot(const Slot&) = delete;
  Slot& operator=(const Slot&) = delete;
  ~Slot() { type_.delete_data(data_); }

  /// Whether the reader delivers it.
  bool read(std::string_view bytes) {
    Arrived input(bytes);
    require(messaging::detail::read_payload(type_, input.payload, data_),
            "a reader is never left with a sample");
    return !topic_.find_defect(data_);
  }
  [[nodiscard]] const Message& message() const { return *static_cast<const Message*>(data_); }
  std::string write() { return written_payload(message(), type_); }

 private:
  const messaging::TopicInfo& topic_;
  eprosima::fastdds::dds::TypeSupport type_;
  void* data_;
};

/// Memory of the lists of a message in bytes, even when decoding stopped early.
template <class Message>
std::size_t taken_bytes(const Message& /*message*/) {
  return 0;
}
std::size_t taken_bytes(const ros::LaserScan& message) {
  return (message.ranges_().capacity() + message.intensities_().capacity()) * sizeof(float);
}
std::size_t taken_bytes(const ros::TFMessage& message) {
  return message.transforms_().capacity() * sizeof(ros::TransformStamped);
}

template <class Message>
std::string sample_of();

template <class Message>
std::size_t check_payload(std::string_view bytes) {
  const messaging::TopicInfo& topic = ros::reader_info<Message>("/fuzz");
  Slot<Message> fresh(topic);
  const bool readable = fresh.read(bytes);
  constexpr std::size_t kMostTimesAsMuch = 8;
  require(taken_bytes(fresh.message()) <= kMostTimesAsMuch * bytes.size(),
          "a message takes memory by the length of its payload, not by what that claims");
  Slot<Message> used(topic);
  require(used.read(sample_of<Message>()), "a sample can be read");
  require(used.read(bytes) == readable, "what was read before does not matter");
  if (!readable) return 0;
  const std::string sent = fresh.write();
  require(used.write() == sent, "nothing is left of what was read before");
  Slot<Message> again(topic);
  require(again.read(sent), "what was sent can be read");
  require(again.write() == sent, "sending what was read changes nothing");
  try {
    return receive_in_bridge(fresh.message()) ? 2 : 1;
  } catch (const std::invalid_argument&) {
    return 1;
  }
}

// A sample of each type that the bridge accepts.

void fill(ros::LaserScan& message) {
  message = scan_at(kRosNow_ns);
  message.intensities_(message.ranges_());
}

void fill(ros::Odometry& message) {
  message.header_(header_at("odom", kRosNow_ns));
  message.child_frame_id_("base_link");
  message.pose_().pose_(ros::pose_of({0.01, 0.02, 0.03}));
  message.twist_().twist_().linear_().x_(0.4);
  message.twist_().twist_().angular_().z_(-0.2);
}

void fill(ros::TFMessage& message) {
  message.transforms_().push_back(ros::transform_of("base_link", "mast", kRosMounting, kRosNow_ns));
  message.transforms_().push_back(
      ros::transform_of("mast", "scanner", {}, kRosNow_ns + 100'000'000));
}

void fill(ros::PoseStamped& message) {
  message.header_(header_at("odom", kRosNow_ns));
  message.pose_(ros::pose_of({1.0, 2.0, 0.3}));
}

void fill(ros::PoseWithCovarianceStamped& message) {
  message = ros::pose_of("map", kRosNow_ns, {1.0, 2.0, 0.3}, Eigen::Matrix3d::Identity());
}

void fill(ros::Twist& message) {
  message.linear_().x_(0.4);
  message.angular_().z_(-0.2);
}

void fill(ros::TwistStamped& message) {
  message.header_(header_at("base_link", kRosNow_ns));
  fill(message.twist_());
}

template <class Message>
std::string sample_of() {
  static const std::string sample = [] {
    Message message;
    fill(message);
    eprosima::fastdds::dds::TypeSupport type(ros::writer_info<Message>("/fuzz").make_type());
    return written_payload(message, type);
  }();
  return sample;
}

template <class Message>
constexpr MessageKind ros_type(std::string_view name) {
  return {name, check_payload<Message>, sample_of<Message>};
}

constexpr MessageKind kTypes[] = {
    ros_type<ros::LaserScan>("LaserScan"),
    ros_type<ros::Odometry>("Odometry"),
    ros_type<ros::TFMessage>("TFMessage"),
    ros_type<ros::PoseStamped>("PoseStamped"),
    ros_type<ros::PoseWithCovarianceStamped>("PoseWithCovarianceStamped"),
    ros_type<ros::Twist>("Twist"),
    ros_type<ros::TwistStamped>("TwistStamped")};

}  // namespace

std::size_t check_ros_message(std::string_view bytes) {
  return check_named(kTypes, bytes);
}

std::vector<std::string> sample_ros_messages() {
  return sample_inputs(kTypes);
}

}  // namespace topogeo::fuzz
