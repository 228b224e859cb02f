#include "topogeo/service/cpu_watch.hpp"

#include <optional>

#include "topogeo/support/log.hpp"
#include "topogeo/support/machine_cpu.hpp"

namespace topogeo::service {
namespace {

/// Spans several statuses and many scheduler periods, so that the result is not chance.
constexpr double kSpan_s = 1.0;

}  // namespace

CpuWatch::CpuWatch(TimerDelay timer_delay, SetCounter set_counter, support::CpuMeter meter)
    : timer_delay_(std::move(timer_delay)),
      set_counter_(std::move(set_counter)),
      meter_(std::move(meter)) {
  set_counter_(kTimerDelay, 0.0);
  set_counter_(kShort, 0.0);
}

void CpuWatch::tick(double now_s) {
  if (now_s < due_s_) return;
  due_s_ = now_s + kSpan_s;
  const double timer_delay_s = timer_delay_();
  set_counter_(kTimerDelay, timer_delay_s);
  const std::optional<support::CpuUse> use = meter_.take(now_s);
  if (!use) return;
  set_counter_(kWaitRatio, use->wait_ratio());
  if (!shortage_.add(*use, timer_delay_s)) return;
  set_counter_(kShort, lasts() ? 1.0 : 0.0);
  if (lasts()) {
    spdlog::warn("{} ({})", shortage_.text(), describe(support::read_machine_cpu()));
  } else {
    spdlog::info("the CPU shortage is over");
  }
}

}  // namespace topogeo::service
