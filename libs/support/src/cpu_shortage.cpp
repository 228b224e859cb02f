#include "topogeo/support/cpu_shortage.hpp"

#include <algorithm>
#include <utility>

#include "topogeo/support/format.hpp"

namespace topogeo::support {

double CpuUse::wait_share() const {
  const double wanted_s = ran_s + waited_s;
  return wanted_s > 0.0 ? waited_s / wanted_s : 0.0;
}

std::optional<CpuUse> CpuMeter::take(double now_s) {
  std::map<long, ThreadTime> times = thread_times(process_);
  if (times.empty()) return std::nullopt;
  const std::optional<double> since_s = std::exchange(last_s_, now_s);
  const std::map<long, ThreadTime> before = std::exchange(last_, std::move(times));
  if (!since_s) return std::nullopt;
  CpuUse use{now_s - *since_s, 0.0, 0.0};
  for (const auto& [number, time] : last_) {
    const auto found = before.find(number);
    const ThreadTime earlier = found == before.end() ? ThreadTime{} : found->second;
    // Another thread may have got the number of an ended one.
    use.ran_s += std::max(0.0, time.ran_s - earlier.ran_s);
    use.waited_s += std::max(0.0, time.waited_s - earlier.waited_s);
  }
  return use;
}

bool CpuShortage::add(const CpuUse& use, double timer_delay_s) {
  use_ = use;
  timer_delay_s_ = timer_delay_s;
  const bool is_well = timer_delay_s < kInTime_s || use.wait_share() < kSmallWaitShare;
  if (lasts_ ? is_well : is_short_now()) {
    ++in_row_;
  } else {
    in_row_ = 0;
  }
  if (in_row_ < (lasts_ ? kEnds : kBegins)) return false;
  lasts_ = !lasts_;
  in_row_ = 0;
  return true;
}

std::string CpuShortage::text() const {
  return fmt::format(
      "the CPU is short: timers fire up to {:.1f} s late, {:.0f} % of the working time is "
      "waiting for a CPU",
      timer_delay_s_, 100.0 * use_.wait_share());
}

}  // namespace topogeo::support
