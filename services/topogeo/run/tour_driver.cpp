#include "run/tour_driver.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/messaging/message.hpp"
#include "topogeo/service/conversions.hpp"

namespace topogeo::cli {
namespace {

/// Same as the navigator: 20 commands a second, each valid until ten later ones are lost.
constexpr double kCommandPeriod_s = 0.05;
constexpr double kValid_s = 0.5;
/// After this time without a scan the robot stops: a gateway or a laser is restarting.
constexpr double kBlind_s = 1.0;
/// Approximate delay from a command until the base obeys it: network, line, and time to reach the
/// speed. Commands are computed for the robot's pose after this delay.
constexpr double kDelay_s = 0.2;

geometry::Pose2 ahead_of(const msg::GroundTruth& truth) {
  const geometry::Pose2 T_world_robot = service::from_msg(truth.T_world_robot());
  const double turn_rad = truth.angular_radps() * kDelay_s;
  return T_world_robot * geometry::Pose2{0.0, 0.0, turn_rad / 2.0} *
         geometry::Pose2{truth.linear_mps() * kDelay_s, 0.0, turn_rad / 2.0};
}

}  // namespace

TourDriver::TourDriver(const messaging::Participant& participant, messaging::EventLoop& loop,
                       std::string robot_id, const std::vector<Eigen::Vector2d>& tour_m,
                       const simulation::DriveOptions& options)
    : robot_id_(std::move(robot_id)),
      follower_(tour_m, options),
      tour_m_(follower_.rest_m()),
      limit_s_(10.0 + 20.0 * tour_m_ / options.speed_m_per_s),
      commands_(participant),
      scans_(participant),
      truth_(participant, loop, robot_id_,
             [this](const msg::GroundTruth& truth, double step_s) { on_truth(truth, step_s); }) {
  loop.add(commands_);
  loop.add<msg::Scan>(scans_, [this](const msg::Scan& scan, const messaging::SampleInfo&) {
    if (scan.robot_id() == robot_id_.c_str()) scan_came_s_ = truth_.last().time_s();
  });
}

double TourDriver::share() const {
  return tour_m_ > 0.0 ? std::clamp(1.0 - follower_.rest_m() / tour_m_, 0.0, 1.0) : 1.0;
}

void TourDriver::on_truth(const msg::GroundTruth& truth, double step_s) {
  if (!started_ || arrived_) return;
  driven_s_ += step_s;
  if (at_end_) {
    constexpr double kStill = 0.01;  // m/s and rad/s
    constexpr double kEnough_s = 0.5;
    const bool still =
        std::fabs(truth.linear_mps()) < kStill && std::fabs(truth.angular_radps()) < kStill;
    standing_s_ = still ? standing_s_ + step_s : 0.0;
    arrived_ = standing_s_ > kEnough_s && truth.time_s() - scan_came_s_ < standing_s_;
  }
  if (truth.time_s() < command_due_s_) return;
  command_due_s_ = truth.time_s() + kCommandPeriod_s - 1e-3;
  if (truth.time_s() - scan_came_s_ > kBlind_s) {
    command(simulation::Velocity{});
    return;
  }
  const double free_m = truth.free_ahead_m() - std::max(truth.linear_mps(), 0.0) * kDelay_s;
  const std::optional<simulation::Velocity> velocity =
      at_end_ ? std::nullopt : follower_.next(ahead_of(truth), kCommandPeriod_s, free_m);
  at_end_ = !velocity;
  command(velocity.value_or(simulation::Velocity{}));
}

void TourDriver::command(const simulation::Velocity& velocity) {
  msg::MotionCommand command;
  messaging::set_header(command, robot_id_, truth_.last().stamp_ns(), commands_sent_);
  command.linear_mps(velocity.linear_m_per_s);
  command.angular_radps(velocity.angular_rad_per_s);
  command.valid_for_s(kValid_s);
  // The next command makes up for a lost one.
  if (commands_.write(command)) ++commands_sent_;
}

}  // namespace topogeo::cli
