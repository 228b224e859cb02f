#include "freeze_watch.hpp"

#include <algorithm>
#include <charconv>
#include <ctime>
#include <stdexcept>
#include <system_error>

#include "topogeo/support/thread_times.hpp"

namespace topogeo::messaging {

namespace {

constexpr FreezeWatch::Duration kWakePeriod = std::chrono::milliseconds(500);

/// This clock goes on while the machine sleeps; the steady clock does not.
FreezeWatch::Duration since_boot() {
  timespec time{};
  clock_gettime(CLOCK_BOOTTIME, &time);
  return std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec);
}

Standstill::Moment this_moment() {
  const std::chrono::duration<double> waited(support::time_of_this_thread().waited_s);
  return {since_boot(), std::chrono::duration_cast<FreezeWatch::Duration>(waited)};
}

}  // namespace

Standstill::Duration Standstill::awake(const Moment& moment) {
  const Duration passed = moment.now - last_.now;
  const Duration waited = std::clamp(moment.waited - last_.waited, Duration::zero(), passed);
  longest_ = std::max(longest_, passed - waited / 2);
  last_ = moment;
  return longest_;
}

FreezeWatch::FreezeWatch(Duration longest) : longest_(longest), thread_([this] { watch(); }) {}

FreezeWatch::~FreezeWatch() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
  }
  ending_.notify_all();
  thread_.join();
}

std::optional<FreezeWatch::Duration> FreezeWatch::stood_still() const {
  const Duration still(stood_still_ns_.load());
  if (still < longest_) return {};
  return still;
}

// Reports up to half a second too much, which is better than missing a standstill.
void FreezeWatch::watch() {
  Standstill standstill(this_moment());
  std::unique_lock lock(mutex_);
  while (!ending_.wait_for(lock, kWakePeriod, [this] { return ends_; })) {
    stood_still_ns_ = standstill.awake(this_moment()).count();
  }
}

std::chrono::nanoseconds longest_freeze(std::chrono::nanoseconds lease, const std::string& text) {
  if (text.empty()) return lease / 2;
  constexpr std::uint32_t kMost_s = 1'000'000;
  std::uint32_t seconds = 0;
  const char* const end = text.data() + text.size();
  const auto [after, error] = std::from_chars(text.data(), end, seconds);
  if (error != std::errc() || after != end || seconds > kMost_s) {
    throw std::runtime_error("TOPOGEO_LONGEST_FREEZE_S: '" + text +
                             "': expected whole seconds from 0 (any time) to 1000000");
  }
  return seconds == 0 ? std::chrono::nanoseconds::max() : std::chrono::seconds(seconds);
}

}  // namespace topogeo::messaging
