#include "velocity_bridge.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

#include "topogeo/messaging/message.hpp"
#include "topogeo/ros_conversions/geometry.hpp"
#include "topogeo/service/runtime_file.hpp"
#include "topogeo/support/host.hpp"
#include "topogeo/support/log.hpp"

#include "orders.hpp"
#include "outputs.hpp"

namespace topogeo::ros_bridge {
namespace {

constexpr std::chrono::milliseconds kLastVelocity{200};  // time for the base to get the last one
constexpr std::chrono::milliseconds kEarlierPeriod{50};
constexpr int kEarlierZeros = 20;  // a best-effort reader may lose some
constexpr std::uint64_t kVelocityFormat =
    0x314C455647475054;  // "TPGGVEL1": the layout of the record

}  // namespace

VelocityBridge::VelocityBridge(RosSide& ros)
    : ros_(ros), clock_(support::wall_clock_ns() - support::monotonic_ns()) {
  ros.service().status().set_counter("velocities", 0.0);
  if (ros.settings().directions.velocity == Direction::kOut) give();
  if (ros.settings().directions.velocity == Direction::kIn) take();
}

VelocityBridge::~VelocityBridge() {
  try {
    stop();
  } catch (const std::exception& error) {
    spdlog::error("the last velocity was not sent: {}", error.what());
  }
}

void VelocityBridge::stop() {
  ros_.service().loop().cancel_timer(timer_);
  ros_.service().loop().cancel_timer(earlier_timer_);
  if (!moving_) return;
  send(0.0, 0.0);
  if (stamped_) static_cast<void>(stamped_->wait_for_acknowledgments(kLastVelocity));
  if (twists_) static_cast<void>(twists_->wait_for_acknowledgments(kLastVelocity));
}

void VelocityBridge::give() {
  const Settings& settings = ros_.settings();
  if (settings.stamped_velocity) {
    stamped_ = ros_.advertise<ros::TwistStamped>(settings.topics.velocity, settings.qos.velocity);
  } else {
    twists_ = ros_.advertise<ros::Twist>(settings.topics.velocity, settings.qos.velocity);
  }
  ros_.service().subscribe<msg::MotionCommand>(
      [this](const msg::MotionCommand& command) { on_command(command); });
  memory_.emplace(service::own_runtime_file(ros_.service().setup(), ".moving",
                                            "a killed bridge leaves its last velocity to the base"),
                  kVelocityFormat);
  remembered_ = memory_->load().value_or(0) != 0;
  if (remembered_) end_earlier();
}

void VelocityBridge::end_earlier() {
  ros_.complain("velocity of a killed bridge", "the base is stopped");
  zeros_left_ = kEarlierZeros;
  earlier_timer_ = ros_.service().loop().add_timer(kEarlierPeriod, [this] {
    const int readers = matched();
    // The base may be the one that has just come: the others only record, for example.
    if (readers > readers_) zeros_left_ = kEarlierZeros;
    readers_ = readers;
    if (readers == 0) return;
    zeros_left_ = moving_ ? 0 : zeros_left_ - 1;
    if (!moving_) send(0.0, 0.0);
    if (zeros_left_ == 0) ros_.service().loop().cancel_timer(earlier_timer_);
  });
}

int VelocityBridge::matched() const {
  return (stamped_ ? stamped_->matched() : 0) + (twists_ ? twists_->matched() : 0);
}

void VelocityBridge::take() {
  const Settings& settings = ros_.settings();
  commands_ = ros_.service().advertise<msg::MotionCommand>();
  ros_.service().subscribe<msg::Odometry>([this](const msg::Odometry& odometry) {
    clock_.observe(odometry.stamp_ns(), support::monotonic_ns());
  });
  if (settings.stamped_velocity) {
    ros_.subscribe<ros::TwistStamped>(
        settings.topics.velocity, settings.qos.velocity,
        [this](const ros::TwistStamped& message, const messaging::SampleInfo& info) {
          on_twist(message.twist_(), info);
        });
  } else {
    ros_.subscribe<ros::Twist>(
        settings.topics.velocity, settings.qos.velocity,
        [this](const ros::Twist& message, const messaging::SampleInfo& info) {
          on_twist(message, info);
        });
  }
}

void VelocityBridge::on_command(const msg::MotionCommand& command) {
  const double valid_s = std::min(command.valid_for_s(), kLongestVelocity_s);
  if (!std::isfinite(command.linear_mps()) || !std::isfinite(command.angular_radps()) ||
      !(valid_s > 0.0)) {
    throw std::invalid_argument("expected finite speeds for a time over 0");
  }
  send(command.linear_mps(), command.angular_radps());
  messaging::EventLoop& loop = ros_.service().loop();
  loop.cancel_timer(timer_);
  if (!moving_) return;
  timer_ = loop.call_after(std::chrono::nanoseconds(std::llround(valid_s * 1e9)), [this] {
    ros_.complain("velocity without a successor", "the base is stopped");
    send(0.0, 0.0);
  });
}

void VelocityBridge::send(double linear_mps, double angular_radps) {
  const ros::Twist twist = to_ros(linear_mps, angular_radps);
  moving_ = linear_mps != 0.0 || angular_radps != 0.0;
  if (moving_) remember(true);  // before the base has it
  if (stamped_) {
    ros::TwistStamped message;
    const std::string& robot = ros_.settings().frames.robot;
    message.header_(ros::header_of(robot.empty() ? "base_link" : robot, ros_.now_ns()));
    message.twist_(twist);
    ros_.send(*stamped_, message);
  } else if (twists_) {
    ros_.send(*twists_, twist);
  }
  if (!moving_ && zeros_left_ == 0) remember(false);
  ros_.service().status().set_counter("velocities", static_cast<double>(++sent_));
}

void VelocityBridge::remember(bool moving) {
  if (!memory_ || remembered_ == moving) return;
  remembered_ = moving;
  static_cast<void>(memory_->store(std::uint64_t{moving}));
}

bool VelocityBridge::is_of_the_moment(const messaging::SampleInfo& info) {
  if (info.stamp_ns <= 0) return true;  // this implementation of DDS sends no time
  const auto age_ns =
      ages_.age_ns(info.writer, info.stamp_ns, support::monotonic_ns(), support::wall_clock_ns());
  if (age_ns && *age_ns <= service::CommandAges::kOldest_ns) return true;
  ros_.complain(age_ns ? "old velocity" : "velocity of unknown age",
                age_ns ? "the base does not move by it"
                       : "the clocks of the hosts differ; a velocity repeated for 0.3 s is obeyed");
  return false;
}

void VelocityBridge::on_twist(const ros::Twist& twist, const messaging::SampleInfo& info) {
  msg::MotionCommand command = to_motion(twist);
  const bool of_the_moment = is_of_the_moment(info);
  // An order to stand is always obeyed.
  const bool stands = command.linear_mps() == 0.0 && command.angular_radps() == 0.0;
  if (!of_the_moment && !stands) return;
  // Stamped when made, not with the last sensor time: the gateway rejects old commands.
  messaging::set_header(command, ros_.service().robot_id(), clock_.now_ns(support::monotonic_ns()),
                        sent_);
  if (!commands_->write(command)) {
    ros_.service().status().fault("send blocked", "motion command");
    return;
  }
  ros_.service().status().set_counter("velocities", static_cast<double>(++sent_));
}

}  // namespace topogeo::ros_bridge
