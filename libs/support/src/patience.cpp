#include "topogeo/support/patience.hpp"

#include <algorithm>
#include <utility>

#include "topogeo/support/format.hpp"

namespace topogeo::support {
namespace {

/// Many turns of the scheduler, but short compared with any patience.
constexpr double kMeasure_s = 0.2;
/// A wait that took this many times its counted time was prolonged by the machine.
constexpr double kProlonged = 2.0;

}  // namespace

double PatienceClock::advance(double now_s, double rate) {
  const double span_s = now_s - std::exchange(last_call_s_, now_s);
  time_s_ += rate * std::clamp(span_s, 0.0, longest_span_s_);
  return time_s_;
}

std::optional<double> PatienceWindow::over_before(double now_s, double rate) {
  const double begin_s = clock_.advance(now_s, rate) - patience_s_;
  calls_.push_back({now_s, clock_.time_s()});
  while (calls_[1].time_s <= begin_s) calls_.pop_front();
  if (calls_.front().time_s > begin_s) return std::nullopt;
  return calls_.front().now_s;
}

Patience::Patience(double patience_s, double now_s, CpuMeter meter)
    : patience_s_(patience_s),
      start_s_(now_s),
      now_s_(now_s),
      measured_s_(now_s),
      clock_(now_s),
      meter_(std::move(meter)) {
  static_cast<void>(meter_.take(now_s));
}

bool Patience::is_over(double now_s) {
  now_s_ = now_s;
  if (now_s - measured_s_ >= kMeasure_s) {
    measured_s_ = now_s;
    if (const std::optional<CpuUse> use = meter_.take(now_s)) {
      rate_ = std::max(PatienceClock::kBusyRate, 1.0 - use->wait_share());
      use_.span_s += use->span_s;
      use_.ran_s += use->ran_s;
      use_.waited_s += use->waited_s;
    }
  }
  return clock_.advance(now_s, rate_) > patience_s_;
}

void Patience::begin_again(double now_s) {
  start_s_ = now_s_ = now_s;
  clock_ = PatienceClock(now_s);
  use_ = {};
}

std::string Patience::reason() const {
  const double took_s = now_s_ - start_s_;
  if (took_s <= kProlonged * clock_.time_s()) return {};
  return fmt::format(
      "; this machine is too busy: the wait of {:.1f} s took {:.1f} s, and this program waited for "
      "a CPU {:.0f} % of its working time",
      clock_.time_s(), took_s, 100.0 * use_.wait_share());
}

}  // namespace topogeo::support
