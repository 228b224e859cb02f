#include "topogeo/simulation/mcp_drive.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace topogeo::simulation {
namespace {

using devices::McpCommand;
using devices::McpField;
using devices::McpOrder;

// Values after power-on from MIRO's base driver, which quotes the B21 User's Guide of RWI.
constexpr std::uint32_t kTranslateVelocity = 0x0800;
constexpr std::uint32_t kTranslateAcceleration = 0x4000;
constexpr std::uint32_t kRotateVelocity = 0x0080;
constexpr std::uint32_t kRotateAcceleration = 0x0400;

// Initial values of the position and rotation registers, from the same guide.
constexpr double kPlaceOrigin = 0x8000;
constexpr std::uint32_t kRotateOrigin = 0x80000000U;

std::uint32_t wrapped(double value) {
  return static_cast<std::uint32_t>(std::llround(value) & 0xFFFF);
}

std::uint32_t magnitude(double speed) {
  return static_cast<std::uint32_t>(std::min(std::round(std::abs(speed)), 65535.0));
}

}  // namespace

McpDrive::McpDrive(const devices::McpCalibration& calibration)
    : units_(calibration),
      translation_(kTranslateVelocity, kTranslateAcceleration),
      rotation_(kRotateVelocity, kRotateAcceleration) {}

void McpDrive::reset() {
  translation_ = McpAxis(kTranslateVelocity, kTranslateAcceleration);
  rotation_ = McpAxis(kRotateVelocity, kRotateAcceleration);
  T_base_robot_ = {};
  heading_rad_ = 0.0;
}

void McpDrive::halt() {
  translation_.halt();
  rotation_.halt();
}

void McpDrive::limp() {
  translation_.limp();
  rotation_.limp();
}

void McpDrive::follow(const geometry::Velocity& velocity) {
  translation_.follow(velocity.linear_m_per_s / units_.metres(1));
  rotation_.follow(velocity.angular_rad_per_s / units_.radians(1));
}

void McpDrive::advance(std::int64_t now_ns) {
  const double dt_s = 1e-9 * static_cast<double>(now_ns - advanced_ns_);
  advanced_ns_ = now_ns;
  translation_.advance(dt_s, power_);
  rotation_.advance(dt_s, power_);
}

void McpDrive::moved(double forward_m, double turn_rad, double time_s) {
  translation_.moved(forward_m / units_.metres(1), time_s);
  rotation_.moved(turn_rad / units_.radians(1), time_s);
  const geometry::Pose2 half_turn{0.0, 0.0, 0.5 * turn_rad};
  const geometry::Pose2 step = half_turn * geometry::Pose2{forward_m, 0.0, 0.0} * half_turn;
  T_base_robot_ = T_base_robot_ * step;
  heading_rad_ += turn_rad;
  T_start_robot_ = T_start_robot_ * step;
}

geometry::Velocity McpDrive::commanded_velocity() const {
  return {units_.metres(1) * translation_.speed(), units_.radians(1) * rotation_.speed()};
}

std::uint32_t McpDrive::translate_register() const {
  return static_cast<std::uint32_t>(std::llround(translation_.position()));
}

std::uint32_t McpDrive::rotate_register() const {
  return kRotateOrigin + static_cast<std::uint32_t>(std::llround(rotation_.position()));
}

void McpDrive::fill(devices::McpReport& report) const {
  const auto set = [&report](McpField field, std::uint32_t value) {
    if (report.has(field)) report.fields[static_cast<std::size_t>(field)] = value;
  };
  set(McpField::kX,
      wrapped(kPlaceOrigin - units_.clockwise_sign() * units_.position_units(T_base_robot_.y_m)));
  set(McpField::kY, wrapped(kPlaceOrigin + units_.position_units(T_base_robot_.x_m)));
  set(McpField::kHeading, wrapped(heading_rad_ / units_.radians(1)));
  set(McpField::kTranslateSpeed, magnitude(translation_.measured()));
  set(McpField::kTranslateStatus, translation_.status());
  set(McpField::kRotateSpeed, magnitude(rotation_.measured()));
  set(McpField::kRotateStatus, rotation_.status());
}

bool McpDrive::execute(const McpOrder& order) {
  if (order.command == McpCommand::kKill || order.command == McpCommand::kShutdown) {
    limp();
    return true;
  }
  return execute_translation(order) || execute_rotation(order);
}

bool McpDrive::execute_translation(const McpOrder& order) {
  const double counts = order.argument;
  switch (order.command) {
    case McpCommand::kTranslateVelocity:
      translation_.set_velocity(order.argument);
      return true;
    case McpCommand::kTranslateAcceleration:
      translation_.set_acceleration(order.argument);
      return true;
    case McpCommand::kTranslateHalt:
      translation_.halt();
      return true;
    case McpCommand::kTranslateLimp:
      translation_.limp();
      return true;
    case McpCommand::kTranslateForward:
      translation_.go(counts);
      return true;
    case McpCommand::kTranslateBackward:
      translation_.go(-counts);
      return true;
    case McpCommand::kTranslatePlus:
      translation_.run(1);
      return true;
    case McpCommand::kTranslateMinus:
      translation_.run(-1);
      return true;
    case McpCommand::kTranslateTo:
      translation_.go(static_cast<std::int32_t>(order.argument) - translation_.position());
      return true;
    default:
      return false;
  }
}

bool McpDrive::execute_rotation(const McpOrder& order) {
  const double counts = order.argument;
  switch (order.command) {
    case McpCommand::kRotateVelocity:
      rotation_.set_velocity(order.argument);
      return true;
    case McpCommand::kRotateAcceleration:
      rotation_.set_acceleration(order.argument);
      return true;
    case McpCommand::kRotateHalt:
      rotation_.halt();
      return true;
    case McpCommand::kRotateLimp:
      rotation_.limp();
      return true;
    case McpCommand::kRotatePositive:
      rotation_.go(counts);
      return true;
    case McpCommand::kRotateNegative:
      rotation_.go(-counts);
      return true;
    case McpCommand::kRotatePlus:
      rotation_.run(1);
      return true;
    case McpCommand::kRotateMinus:
      rotation_.run(-1);
      return true;
    case McpCommand::kRotateTo:
      rotation_.go(static_cast<std::int32_t>(order.argument - kRotateOrigin) -
                   rotation_.position());
      return true;
    default:
      return false;
  }
}

}  // namespace topogeo::simulation
