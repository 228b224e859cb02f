#include "topogeo/simulation/mcp_axis.hpp"

#include <algorithm>
#include <cmath>

namespace topogeo::simulation {
namespace {

using devices::McpPhase;

/// Deceleration time of limp wheels and of brakes without power, much shorter than a motor's.
constexpr double kBrake_s = 0.2;
/// A relative move ends at the speed that this much time of acceleration gives.
constexpr double kCreep_s = 0.02;
constexpr std::uint16_t kUnknownBit = 0x0002;  // as in known reports

}  // namespace

void McpAxis::run(int direction) {
  mode_ = Mode::kRun;
  direction_ = direction;
}

void McpAxis::go(double counts) {
  mode_ = Mode::kGo;
  direction_ = counts < 0.0 ? -1 : 1;
  remaining_ = std::abs(counts);
}

void McpAxis::halt() {
  mode_ = Mode::kHalt;
}

void McpAxis::limp() {
  mode_ = Mode::kLimp;
}

void McpAxis::follow(double counts_per_s) {
  mode_ = counts_per_s == 0.0 ? Mode::kHalt : Mode::kFollow;
  followed_ = counts_per_s;
  if (counts_per_s != 0.0) direction_ = counts_per_s < 0.0 ? -1 : 1;
}

double McpAxis::aim() const {
  switch (mode_) {
    case Mode::kStop:
    case Mode::kHalt:
    case Mode::kLimp:
      return 0.0;
    case Mode::kFollow:
      return followed_;
    case Mode::kRun:
      return direction_ * static_cast<double>(velocity_);
    case Mode::kGo:
      break;
  }
  const double acceleration = acceleration_;
  const double braking =
      std::max(std::sqrt(2.0 * acceleration * remaining_), acceleration * kCreep_s);
  return direction_ * std::min(braking, static_cast<double>(velocity_));
}

void McpAxis::advance(double dt_s, bool power) {
  if (!power || mode_ == Mode::kLimp) {
    const double keep = std::max(0.0, 1.0 - dt_s / kBrake_s);
    speed_ = std::abs(speed_) * keep < 1.0 ? 0.0 : speed_ * keep;
    return;
  }
  const double most = dt_s * acceleration_;
  speed_ += std::clamp(aim() - speed_, -most, most);
}

void McpAxis::moved(double counts, double dt_s) {
  position_ += counts;
  if (dt_s > 0.0) measured_ = counts / dt_s;
  if (mode_ != Mode::kGo) return;
  remaining_ -= direction_ * counts;
  if (remaining_ > 0.0) return;
  mode_ = Mode::kStop;
  speed_ = 0.0;
}

McpPhase McpAxis::phase() const {
  if (mode_ == Mode::kLimp) return McpPhase::kLimp;
  const double wanted = aim();
  if (wanted == 0.0 && speed_ == 0.0) {
    return mode_ == Mode::kHalt ? McpPhase::kHalt : McpPhase::kStop;
  }
  if (speed_ == wanted) return McpPhase::kConstant;
  const bool faster = wanted * speed_ >= 0.0 && std::abs(wanted) > std::abs(speed_);
  return faster ? McpPhase::kAccelerate : McpPhase::kDecelerate;
}

std::uint16_t McpAxis::status() const {
  auto word = static_cast<std::uint16_t>(static_cast<unsigned>(phase()) << 13U);
  word |= kUnknownBit;
  if (measured_ < 0.0) word |= devices::kMcpMeasuredNegative;
  if (direction_ < 0) word |= devices::kMcpCommandedNegative;
  return word;
}

}  // namespace topogeo::simulation
