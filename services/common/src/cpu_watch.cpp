#include "topogeo/service/cpu_watch.hpp"

#include <chrono>

#include "topogeo/support/log.hpp"
#include "topogeo/support/machine_cpu.hpp"

namespace topogeo::service {
namespace {

/// Several statuses and many turns of the scheduler: what happens in it is no chance.
constexpr double kSpan_s = 1.0;

}  // namespace

CpuWatch::CpuWatch(messaging::EventLoop& loop, messaging::StatusPublisher& status)
    : loop_(loop), status_(status) {
  status_.set_counter(kTimerDelay, 0.0);
  status_.set_counter(kShort, 0.0);
}

void CpuWatch::tick(double now_s) {
  if (now_s < due_s_) return;
  due_s_ = now_s + kSpan_s;
  const double timer_delay_s = std::chrono::duration<double>(loop_.take_timer_delay()).count();
  status_.set_counter(kTimerDelay, timer_delay_s);
  const std::optional<support::CpuUse> use = meter_.take(now_s);
  if (!use) return;
  status_.set_counter(kWaitRatio, use->wait_ratio());
  if (!shortage_.add(*use, timer_delay_s)) return;
  status_.set_counter(kShort, lasts() ? 1.0 : 0.0);
  if (lasts()) {
    spdlog::warn("{} ({})", shortage_.text(), describe(support::read_machine_cpu()));
  } else {
    spdlog::info("the CPU is not short any more");
  }
}

}  // namespace topogeo::service
