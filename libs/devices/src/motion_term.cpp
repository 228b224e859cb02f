#include "topogeo/devices/motion_term.hpp"

#include <algorithm>
#include <limits>

#include "topogeo/devices/mcp_units.hpp"

namespace topogeo::devices {
namespace {

/// A relative move has ended when this many successive reports show standstill, all taken after its
/// start. One is not enough, because a move that ends too soon is cut short.
constexpr unsigned kReportsAtRest = 3;
/// Writing the commands and motor lag; not measured on hardware. Too long a time only delays the
/// end of shorter moves.
constexpr std::int64_t kBegun_ns = 300'000'000;

}  // namespace

MotionTerm::MotionTerm(const BaseSettings& settings)
    : command_timeout_ns_(static_cast<std::int64_t>(settings.command_timeout_s * 1e9)),
      begun_ns_(kBegun_ns + ticks_ns(report_period_ticks(settings))) {}

void MotionTerm::clear() {
  velocity_until_ns_.reset();
  relative_.reset();
}

void MotionTerm::start_velocity(std::int64_t valid_until_ns, std::int64_t now_ns) {
  velocity_until_ns_ = std::min(valid_until_ns, now_ns + command_timeout_ns_);
}

void MotionTerm::relative_sent(std::int64_t now_ns) {
  if (relative_ && !relative_->sent_ns) relative_->sent_ns = now_ns;
}

bool MotionTerm::relative_ended(unsigned reports_standing, std::int64_t now_ns) const {
  return relative_ && relative_->sent_ns && now_ns > *relative_->sent_ns + begun_ns_ &&
         reports_standing >= kReportsAtRest;
}

std::int64_t MotionTerm::due_ns() const {
  std::int64_t due_ns = std::numeric_limits<std::int64_t>::max();
  if (velocity_until_ns_) due_ns = *velocity_until_ns_;
  if (relative_) due_ns = std::min(due_ns, relative_->until_ns);
  return due_ns;
}

}  // namespace topogeo::devices
