#include "topogeo/devices/base_motion.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "topogeo/devices/base_limits.hpp"

namespace topogeo::devices {
namespace {

constexpr BaseAxisCommands kTranslation{
    McpCommand::kTranslateVelocity, McpCommand::kTranslateAcceleration,
    McpCommand::kTranslateHalt,     McpCommand::kTranslatePlus,
    McpCommand::kTranslateMinus,    McpCommand::kTranslateForward,
    McpCommand::kTranslateBackward};
constexpr BaseAxisCommands kRotation{McpCommand::kRotateVelocity, McpCommand::kRotateAcceleration,
                                     McpCommand::kRotateHalt,     McpCommand::kRotatePlus,
                                     McpCommand::kRotateMinus,    McpCommand::kRotatePositive,
                                     McpCommand::kRotateNegative};

// Arguments of velocities and accelerations have 16 bits, those of relative moves 32.
constexpr std::int64_t kLargest16 = 0xFFFF;
constexpr std::int64_t kLargest32 = 0xFFFFFFFF;

std::uint32_t magnitude16(std::int64_t value) {
  return static_cast<std::uint32_t>(std::min<std::int64_t>(std::abs(value), kLargest16));
}

}  // namespace

void BaseAxis::want_speed(std::int64_t counts_per_s) {
  speed_ = magnitude16(counts_per_s);
  wanted_ = counts_per_s == 0 ? Run::kHalt : (counts_per_s > 0 ? Run::kPlus : Run::kMinus);
}

void BaseAxis::want_distance(std::int64_t counts, std::int64_t counts_per_s) {
  distance_ = std::clamp(counts, -kLargest32, kLargest32);
  speed_ = std::max(1U, magnitude16(counts_per_s));
  wanted_ = counts == 0 ? Run::kHalt : Run::kRelative;
  if (sent_ == Run::kRelative) sent_ = Run::kUnknown;
}

void BaseAxis::want_acceleration(std::int64_t counts_per_s2) {
  acceleration_ = std::max(1U, magnitude16(counts_per_s2));
}

void BaseAxis::forget() {
  sent_ = Run::kUnknown;
  sent_speed_.reset();
  sent_acceleration_.reset();
}

std::optional<McpOrder> BaseAxis::next_halt() {
  if (wanted_ != Run::kHalt || sent_ == Run::kHalt) return std::nullopt;
  sent_ = Run::kHalt;
  return McpOrder{commands_.halt};
}

McpOrder BaseAxis::acceleration() const {
  return {commands_.acceleration, acceleration_};
}

std::optional<McpOrder> BaseAxis::next() {
  if (sent_acceleration_ != acceleration_) {
    sent_acceleration_ = acceleration_;
    return acceleration();
  }
  if (wanted_ == Run::kHalt) return next_halt();
  if (sent_speed_ != speed_) {
    sent_speed_ = speed_;
    return McpOrder{commands_.velocity, speed_};
  }
  if (sent_ == wanted_) return std::nullopt;
  sent_ = wanted_;
  if (wanted_ == Run::kPlus) return McpOrder{commands_.plus};
  if (wanted_ == Run::kMinus) return McpOrder{commands_.minus};
  return McpOrder{distance_ > 0 ? commands_.relative_plus : commands_.relative_minus,
                  static_cast<std::uint32_t>(std::abs(distance_))};
}

BaseMotion::BaseMotion(const McpUnits& units, const BaseLimits& limits)
    : units_(units), translation_(kTranslation), rotation_(kRotation) {
  set_limits(limits);
}

void BaseMotion::set_limits(const BaseLimits& limits) {
  limits_ = limits;
  translation_.want_acceleration(units_.counts(limits.linear_mps2));
  rotation_.want_acceleration(units_.rotation_counts(limits.angular_radps2));
}

void BaseMotion::want_velocity(const BaseVelocity& velocity) {
  aim_ = within(velocity, limits_);
  translation_.want_speed(units_.counts(aim_.linear_mps));
  rotation_.want_speed(units_.rotation_counts(aim_.angular_radps));
}

void BaseMotion::want_distance(double distance_m) {
  aim_ = {std::copysign(limits_.linear_mps, distance_m), 0.0};
  translation_.want_distance(units_.counts(distance_m), units_.counts(limits_.linear_mps));
  rotation_.want_speed(0);
}

void BaseMotion::want_turn(double angle_rad) {
  aim_ = {0.0, std::copysign(limits_.angular_radps, angle_rad)};
  translation_.want_speed(0);
  rotation_.want_distance(units_.rotation_counts(angle_rad),
                          units_.rotation_counts(limits_.angular_radps));
}

void BaseMotion::forget() {
  translation_.forget();
  rotation_.forget();
}

void BaseMotion::forget_run() {
  translation_.forget_run();
  rotation_.forget_run();
}

std::optional<McpOrder> BaseMotion::next_halt() {
  if (auto order = translation_.next_halt()) return order;
  return rotation_.next_halt();
}

std::optional<McpOrder> BaseMotion::next() {
  if (auto order = next_halt()) return order;
  if (auto order = translation_.next()) return order;
  return rotation_.next();
}

McpOrder BaseMotion::repeat_acceleration() {
  repeat_rotation_ = !repeat_rotation_;
  return (repeat_rotation_ ? rotation_ : translation_).acceleration();
}

bool BaseMotion::relative_sent() const {
  return (!translation_.moves() || translation_.distance_sent()) &&
         (!rotation_.moves() || rotation_.distance_sent()) && moves();
}

}  // namespace topogeo::devices
