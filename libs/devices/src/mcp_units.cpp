#include "topogeo/devices/mcp_units.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

namespace topogeo::devices {
namespace {

constexpr double kCountsPerUnit = 256.0;
constexpr std::int64_t kOrigin = 0x8000;

double positive(const char* name, double value) {
  if (!std::isfinite(value) || value <= 0.0) {
    throw std::invalid_argument("base calibration: " + std::string(name) + " is " +
                                std::to_string(value) + ", not a positive number");
  }
  return value;
}

/// The shorter signed change of a 16-bit register.
std::int64_t moved(std::int64_t from, std::uint16_t to) {
  return static_cast<std::int16_t>(static_cast<std::uint16_t>(to - from));
}

double measured_sign(std::uint16_t status) {
  return (status & kMcpMeasuredNegative) != 0 ? -1.0 : 1.0;
}

}  // namespace

McpUnits::McpUnits(const McpCalibration& calibration)
    : counts_per_m_(positive("counts_per_m", calibration.counts_per_m)),
      units_per_m_(calibration.position_units_per_m == 0.0
                       ? counts_per_m_ / kCountsPerUnit
                       : positive("position_units_per_m", calibration.position_units_per_m)),
      rotation_per_rad_(positive("rotation_counts_per_turn", calibration.rotation_counts_per_turn) /
                        (2.0 * std::numbers::pi)),
      forward_sign_(calibration.reversed ? -1.0 : 1.0),
      clockwise_sign_(calibration.clockwise_positive ? 1.0 : -1.0) {}

std::int64_t McpUnits::counts(double m) const {
  return std::llround(forward_sign_ * m * counts_per_m_);
}

std::int64_t McpUnits::rotation_counts(double rad) const {
  return std::llround(-clockwise_sign_ * rad * rotation_per_rad_);
}

double McpUnits::metres(std::int64_t counts) const {
  return forward_sign_ * static_cast<double>(counts) / counts_per_m_;
}

double McpUnits::radians(std::int64_t rotation_counts) const {
  return -clockwise_sign_ * static_cast<double>(rotation_counts) / rotation_per_rad_;
}

double McpUnits::linear_mps(const McpReport& report) const {
  return measured_sign(report.word(McpField::kTranslateStatus)) *
         metres(report.word(McpField::kTranslateSpeed));
}

double McpUnits::angular_radps(const McpReport& report) const {
  return measured_sign(report.word(McpField::kRotateStatus)) *
         radians(report.word(McpField::kRotateSpeed));
}

double McpUnits::position_m(std::int64_t units) const {
  return forward_sign_ * static_cast<double>(units) / units_per_m_;
}

double McpUnits::position_units(double m) const {
  return forward_sign_ * m * units_per_m_;
}

McpPoseTracker::Registers McpPoseTracker::next(const McpReport& report) const {
  const std::uint16_t x = report.word(McpField::kX);
  const std::uint16_t y = report.word(McpField::kY);
  const std::uint16_t heading = report.word(McpField::kHeading);
  if (!started_) return {x - kOrigin, y - kOrigin, heading};
  return {last_.x + moved(last_.x + kOrigin, x), last_.y + moved(last_.y + kOrigin, y), heading};
}

geometry::Pose2 McpPoseTracker::pose_of(const Registers& registers) const {
  // Heading 0 is the base's +y and +x is to its right; a base that counts counter-clockwise has its
  // +x to the left.
  return {units_.position_m(registers.y), -units_.clockwise_sign() * units_.position_m(registers.x),
          geometry::wrap_angle(units_.radians(registers.heading))};
}

geometry::Pose2 McpPoseTracker::track(const McpReport& report) {
  last_ = next(report);
  started_ = true;
  return pose_of(last_);
}

geometry::Pose2 McpPoseTracker::peek(const McpReport& report) const {
  return pose_of(next(report));
}

std::int64_t McpClock::since_last_ns(std::uint32_t ticks) const {
  return started_ ? ticks_ns(static_cast<std::int32_t>(ticks - last_)) : 0;
}

std::int64_t McpClock::follow(std::uint32_t ticks) {
  if (started_) {
    ticks_ += static_cast<std::int32_t>(ticks - last_);
  } else {
    ticks_ = 0;
  }
  last_ = ticks;
  started_ = true;
  return ticks_ns(ticks_);
}

}  // namespace topogeo::devices
