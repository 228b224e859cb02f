#include "sensor_input.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "topogeo/messaging/message.hpp"
#include "topogeo/pipeline/scan_feed.hpp"
#include "topogeo/ros_conversions/geometry.hpp"
#include "topogeo/service/conversions.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/support/host.hpp"
#include "topogeo/support/log.hpp"
#include "topogeo/support/random.hpp"

#include "odometry_samples.hpp"

namespace topogeo::ros_bridge {
namespace {

constexpr std::chrono::milliseconds kStatePeriod{500};
constexpr std::chrono::milliseconds kLastDelivery{2000};
/// A faster sideways motion is no measurement error.
constexpr double kSidewaysMps = 0.05;

IntakeOptions intake_options(const RosSide& ros) {
  const Settings& settings = ros.settings();
  IntakeOptions options;
  options.T_robot_laser = ros.service().setup().config.config.local_mapper.T_robot_laser;
  options.mounting_from_tf = settings.mounting_from_tf;
  options.odometry_wait_ns = std::llround(settings.odometry_wait_s * 1e9);
  options.longest_extrapolation_ns = std::llround(settings.longest_extrapolation_s * 1e9);
  options.most_beams = msg::kMaxBeams;
  options.sweep = settings.sweep;
  options.without_odometry = settings.odometry_source == OdometrySource::kLaser;
  options.range_limit_m = ros.service().setup().config.config.log.range_max_m;
  options.detect_no_return = ros.service().setup().config.config.log.detect_no_return;
  return options;
}

}  // namespace

SensorInput::SensorInput(RosSide& ros)
    : ros_(ros),
      intake_(intake_options(ros)),
      epoch_salt_(support::unrepeatable_u64()),
      robot_frame_(ros.settings().frames.robot),
      scans_(ros.service().advertise<msg::Scan>()),
      odometry_(ros.service().advertise<msg::Odometry>()),
      stream_end_(ros.service().advertise<msg::StreamEnd>()) {
  const Settings& settings = ros.settings();
  if (robot_frame_.empty() && settings.odometry_source == OdometrySource::kTransforms) {
    robot_frame_ = "base_link";
  }
  intake_.set_robot_frame(robot_frame_);
  using messaging::SampleInfo;
  if (settings.odometry_source == OdometrySource::kTopic) {
    ros.subscribe<ros::Odometry>(settings.topics.odometry, settings.qos.odometry,
                                 [this](const ros::Odometry& message, const SampleInfo& info) {
                                   on_odometry(message, info);
                                 });
  }
  ros.subscribe<ros::TFMessage>(settings.topics.tf_static, ros::Qos::kLatched,
                                [this](const ros::TFMessage& message, const SampleInfo& info) {
                                  on_transforms(message, info, true);
                                });
  ros.subscribe<ros::TFMessage>(settings.topics.tf, ros::Qos::kTransforms,
                                [this](const ros::TFMessage& message, const SampleInfo& info) {
                                  on_transforms(message, info, false);
                                });
  ros.subscribe<ros::LaserScan>(
      settings.topics.scan, settings.qos.scan,
      [this](const ros::LaserScan& message, const SampleInfo& info) { on_scan(message, info); });
  for (const char* counter : {"scans_sent", "odometry_sent"}) {
    ros.service().status().set_counter(counter, 0.0);
  }
  ros.service().status().wait_for(is_from_scans() ? "scans of ROS" : "odometry and scans of ROS");
  state_timer_ = ros.service().loop().add_timer(kStatePeriod, [this] { publish_state(); });
}

SensorInput::~SensorInput() {
  ros_.service().loop().cancel_timer(state_timer_);
  ros_.service().loop().cancel_timer(release_timer_);
}

void SensorInput::on_odometry(const ros::Odometry& message, const messaging::SampleInfo& info) {
  if (!odometry_writer_.accept(info.writer, support::monotonic_ns())) {
    ros_.complain("second publisher of odometry", ros_.settings().topics.odometry);
    return;
  }
  const std::string child = ros::frame_name(message.child_frame_id_());
  if (robot_frame_.empty()) {
    if (child.empty()) throw std::invalid_argument("child_frame_id: expected a name");
    robot_frame_ = child;
    intake_.set_robot_frame(child);
    spdlog::info("the frame of the robot is {}", child);
  } else if (child != robot_frame_) {
    ros_.complain("odometry of another frame", child + ", expected " + robot_frame_);
    return;
  }
  const auto sample = to_sample(message);
  if (!sample) {
    intake_.count(IntakeDrop::kInvalidOdometry, "implausible pose or speed");
    return;
  }
  if (std::fabs(message.twist_().twist_().linear_().y_()) > kSidewaysMps) {
    ros_.complain("sideways motion is left out", "the robot moves along its y axis");
  }
  add(*sample);
}

void SensorInput::on_transforms(const ros::TFMessage& message, const messaging::SampleInfo& info,
                                bool are_static) {
  const Settings::Frames& frames = ros_.settings().frames;
  for (const ros::TransformStamped& transform : message.transforms_()) {
    const std::string parent = ros::frame_name(transform.header_().frame_id_());
    const std::string child = ros::frame_name(transform.child_frame_id_());
    if (const std::size_t longest = std::max(parent.size(), child.size());
        longest > ros::kLongestFrameName) {
      ros_.complain("frame with a long name", std::to_string(longest) + " bytes");
      continue;
    }
    if (!are_static && (child == frames.odom || parent == frames.map)) {
      if (on_foreign_transform) {
        on_foreign_transform(parent, child, ros::stamp_ns_of(transform.header_().stamp_()));
      }
      continue;
    }
    if (!are_static && parent == frames.odom) {
      if (child == robot_frame_) on_odometry_transform(transform, info);
      continue;
    }
    const auto T_parent_child = ros::isometry_of(transform.transform_());
    if (!T_parent_child) {
      ros_.complain("invalid transform", fmt::format("{} -> {}", parent, child));
    } else if (!intake_.frames().put(parent, child, *T_parent_child)) {
      ros_.complain("frame with two parents", fmt::format("{} of {}", child, parent));
    }
  }
}

void SensorInput::on_odometry_transform(const ros::TransformStamped& message,
                                        const messaging::SampleInfo& info) {
  if (ros_.settings().odometry_source != OdometrySource::kTransforms) return;
  if (!odometry_writer_.accept(info.writer, support::monotonic_ns())) {
    ros_.complain("second publisher of odometry", "odom -> " + robot_frame_);
    return;
  }
  const auto sample = to_sample(message, last_transform_);
  if (!sample) {
    intake_.count(IntakeDrop::kInvalidOdometry, "implausible transform");
    return;
  }
  last_transform_ = sample;
  add(*sample);
}

void SensorInput::add(const geometry::OdometrySample& sample) {
  const std::uint64_t before = intake_.dropped(IntakeDrop::kOldOdometry);
  if (const std::string why = intake_.add(sample); !why.empty()) {
    ros_.complain("another odometry begins", why);
    ros_.set_now(sample.stamp_ns);
  }
  if (intake_.dropped(IntakeDrop::kOldOdometry) != before) return;
  if (on_reading) on_reading(sample.stamp_ns, epoch(), sample.T_odom_robot);
  if (odometry_.write(to_msg(sample, ros_.service().robot_id(), epoch(), odometry_sent_))) {
    ++odometry_sent_;
  } else {
    ros_.service().status().fault("send blocked", "odometry");
  }
  ros_.set_now(std::max(ros_.now_ns(), sample.stamp_ns));
  release(support::monotonic_ns());
}

void SensorInput::on_scan(const ros::LaserScan& message, const messaging::SampleInfo& info) {
  const std::int64_t now_ns = support::monotonic_ns();
  if (!scan_writer_.accept(info.writer, now_ns)) {
    ros_.complain("second publisher of scans", ros_.settings().topics.scan);
    return;
  }
  ros_.service().status().count_input("scan");
  intake_.add(message, now_ns);
  release(now_ns);
}

void SensorInput::release(std::int64_t now_ns) {
  const bool known = intake_.no_return().has_value();
  for (ScanIntake::Leaving& leaving : intake_.take(now_ns)) {
    is_from_scans() ? follow(std::move(leaving)) : publish(leaving);
  }
  if (!known && intake_.no_return()) spdlog::info("{}", text_of(*intake_.no_return()));
  messaging::EventLoop& loop = ros_.service().loop();
  loop.cancel_timer(release_timer_);
  if (intake_.due_ns() == std::numeric_limits<std::int64_t>::max()) return;
  release_timer_ = loop.call_after(
      std::chrono::nanoseconds(std::max<std::int64_t>(0, intake_.due_ns() - now_ns)),
      [this] { release(support::monotonic_ns()); });
}

bool SensorInput::is_from_scans() const {
  return ros_.settings().odometry_source == OdometrySource::kLaser;
}

std::uint64_t SensorInput::epoch_of(const scan::Scan& scan) const {
  if (!is_from_scans()) return epoch();
  return epoch_salt_ + intake_epochs_ + laser_epochs_ + scan.odometry_epoch;
}

std::uint64_t SensorInput::numbered() const {
  return is_from_scans() ? scans_placed_ : intake_.scans();
}

void SensorInput::follow(ScanIntake::Leaving leaving) {
  if (!laser_odometry_ || intake_epochs_ != leaving.scan.odometry_epoch) {
    const pipeline::Config& config = ros_.service().setup().config.config;
    if (laser_odometry_) laser_epochs_ += laser_odometry_->counts().breaks;
    laser_odometry_.emplace(pipeline::laser_odometry(config.local_mapper));
    intake_epochs_ = leaving.scan.odometry_epoch;
  }
  laser_odometry_->add(std::move(leaving.scan));
  for (scan::Scan& scan : laser_odometry_->take()) {
    scans_placed_ = scan.sequence + 1;
    publish({std::move(scan), leaving.arrival_ns});
  }
}

void SensorInput::publish(const ScanIntake::Leaving& leaving) {
  const scan::Scan& scan = leaving.scan;
  if (on_reading) on_reading(scan.stamp_ns, epoch_of(scan), scan.T_odom_robot);
  msg::Scan message = service::to_msg(scan, ros_.service().robot_id());
  message.odometry_epoch(epoch_of(scan));
  if (!scans_.write(message)) {
    ros_.service().status().fault("send blocked", "scan " + std::to_string(scan.sequence));
    return;
  }
  ++scans_sent_;
  last_scan_ns_ = scan.stamp_ns;
  latency_ns_ = support::monotonic_ns() - leaving.arrival_ns;
  ros_.set_now(std::max(ros_.now_ns(), scan.stamp_ns));
}

void SensorInput::publish_state() {
  messaging::StatusPublisher& status = ros_.service().status();
  status.set_counter("scans_sent", static_cast<double>(scans_sent_));
  status.set_counter("odometry_sent", static_cast<double>(odometry_sent_));
  status.set_counter("scans_adapted", static_cast<double>(intake_.adapted()));
  status.set_counter("scan_latency_ms", static_cast<double>(latency_ns_) * 1e-6);
  if (laser_odometry_) {
    ros_.set_complaints("scan that matches no others", laser_odometry_->counts().unplaced, "");
    ros_.set_complaints("scan between bare walls for too long", laser_odometry_->counts().unseen,
                        "");
  }
  for (std::size_t i = 0; i < kIntakeDrops; ++i) {
    const auto drop = static_cast<IntakeDrop>(i);
    ros_.set_complaints(std::string(describe(drop)), intake_.dropped(drop), intake_.detail(drop));
  }
  const bool flows = scans_sent_ > scans_at_state_;
  scans_at_state_ = scans_sent_;
  std::string missing;
  if (odometry_sent_ == 0 && !is_from_scans()) missing = "odometry of ROS";
  if (!flows) missing += missing.empty() ? "scans of ROS" : " and scans of ROS";
  const msg::ServiceState state = missing.empty() ? msg::kServiceRunning : msg::kServiceWaiting;
  const std::string text = ros_.recent_complaint();
  std::string published = fmt::format("{}; {}", text, missing);
  if (published == published_ && state == status.state()) return;
  published_ = std::move(published);
  status.set_state(state, text.substr(0, 255));
  status.set_waits_for(missing);
}

void SensorInput::finish() {
  if (!scans_.wait_for_acknowledgments(kLastDelivery)) {
    ros_.service().status().fault("readers missed scans", "at the end");
  }
  msg::StreamEnd end;
  messaging::set_header(end, ros_.service().robot_id(), last_scan_ns_, 0);
  end.stage(msg::kStageGateway);
  end.count(numbered());
  end.last_id(numbered() == 0 ? 0 : numbered() - 1);
  if (!stream_end_.write(end) || !stream_end_.wait_for_acknowledgments(kLastDelivery)) {
    ros_.service().status().fault("readers missed the stream end", "at the end");
  }
  spdlog::info("{} scans published", scans_sent_);
}

}  // namespace topogeo::ros_bridge
