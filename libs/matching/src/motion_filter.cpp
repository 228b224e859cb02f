#include "motion_filter.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

namespace topogeo::localization {

using geometry::Pose2;

namespace {

// A velocity about which nothing is known: people walk at 1.4 m/s, robots and drones indoors are
// hardly faster than 2 m/s, and a hand turns a laser by 90 degrees in a second.
constexpr double kSigma_m_s = 1.0;
constexpr double kSigma_rad_s = 1.2;
// A walker or robot keeps its course along a bare corridor, but can change it within a second.
// Over scans farther apart in time less of the velocity remains.
constexpr double kChange_s = 1.0;
constexpr double kMemory_s = 10.0;

// The usual speed of this laser is learned from its moving steps, of which the last so many count.
// A slow robot with a scan each few seconds is nowhere near as far as a walker would be.
constexpr double kUnlearned = 10.0;  // steps that count as such velocities at the beginning
constexpr double kFading = 1.0 - 1.0 / 200.0;
// Deviation of a step, over the usual one; no less than the refinement of a match reaches.
constexpr double kBeyond2 = 2.0 * 2.0;
constexpr double kReach_m2 = 0.3 * 0.3;
constexpr double kReach_rad_rad = 0.2 * 0.2;
// A turn can begin at once: at 10 Hz a hand turns by 9 degrees from scan to scan.
constexpr double kAtOnce_rad_rad = 0.05 * 0.05;
constexpr double kMoves_m_s = 0.05;
constexpr double kTurns_rad_s = 0.05;

// The displacement of a motion with constant velocity, in the frame of half its turn.
Eigen::Vector3d halfway(const Pose2& step) {
  const Pose2 back{0.0, 0.0, -0.5 * step.theta_rad};
  const Eigen::Vector2d moved = back * step.position_m();
  return {moved.x(), moved.y(), step.theta_rad};
}

}  // namespace

void MotionFilter::MeanSquare::add(double squared) {
  weighted_ = kFading * weighted_ + squared;
  weight_ = kFading * weight_ + 1.0;
}

MotionFilter::MotionFilter()
    : speed2_(kUnlearned * kSigma_m_s * kSigma_m_s, kUnlearned),
      turn_rate2_(kUnlearned * kSigma_rad_s * kSigma_rad_s, kUnlearned),
      step2_m2_(kUnlearned, kUnlearned),
      turn2_rad2_(kUnlearned, kUnlearned) {
  velocity_.covariance = usual();
}

Eigen::Matrix3d MotionFilter::usual() const {
  return Eigen::Vector3d(speed2_.mean(), speed2_.mean(), turn_rate2_.mean()).asDiagonal();
}

double MotionFilter::usual_speed() const {
  return std::sqrt(speed2_.mean());
}

MotionFilter::Velocity MotionFilter::after(double dt_s) const {
  const double kept = std::exp(-std::max(0.0, dt_s - kChange_s) / kMemory_s);
  const double changed = std::min(1.0, dt_s / kChange_s);
  return {kept * velocity_.mean, (1.0 - changed) * velocity_.covariance + changed * usual()};
}

UncertainPose MotionFilter::predict(double dt_s, int scans) const {
  const Velocity velocity = after(dt_s);
  const Eigen::Vector3d moved = dt_s * velocity.mean;
  const Pose2 half_turn{0.0, 0.0, 0.5 * moved.z()};
  const Eigen::Vector2d position_m = half_turn * Eigen::Vector2d(moved.head<2>());
  Eigen::Matrix3d covariance = dt_s * dt_s * velocity.covariance;
  const double most_m2 = scans * std::max(kReach_m2, kBeyond2 * step2_m2_.mean());
  const double most_rad2 = scans * std::max(kReach_rad_rad, kBeyond2 * turn2_rad2_.mean());
  const double position =
      std::sqrt(std::min(1.0, most_m2 / std::max(covariance(0, 0), covariance(1, 1))));
  const double heading = std::sqrt(std::min(1.0, most_rad2 / covariance(2, 2)));
  const Eigen::Vector3d scale(position, position, heading);
  covariance = scale.asDiagonal() * covariance * scale.asDiagonal();
  covariance(2, 2) += kAtOnce_rad_rad;
  return {{position_m.x(), position_m.y(), geometry::wrap_angle(moved.z())}, covariance};
}

void MotionFilter::update(double dt_s, const UncertainPose& measured) {
  const Velocity before = after(dt_s);
  const Eigen::Vector3d seen = halfway(measured.T_a_b) / dt_s;
  const Eigen::Matrix3d noise = measured.covariance / (dt_s * dt_s);
  const Eigen::Matrix3d gain = before.covariance * (before.covariance + noise).inverse();
  velocity_.mean = before.mean + gain * (seen - before.mean);
  velocity_.covariance = (Eigen::Matrix3d::Identity() - gain) * before.covariance;
  step2_m2_.add(measured.T_a_b.position_m().squaredNorm());
  turn2_rad2_.add(measured.T_a_b.theta_rad * measured.T_a_b.theta_rad);
  const double speed_m_per_s = velocity_.mean.head<2>().norm();
  if (speed_m_per_s >= kMoves_m_s) speed2_.add(speed_m_per_s * speed_m_per_s);
  const double turn_rad_per_s = std::fabs(velocity_.mean.z());
  if (turn_rad_per_s >= kTurns_rad_s) turn_rate2_.add(turn_rad_per_s * turn_rad_per_s);
}

}  // namespace topogeo::localization
