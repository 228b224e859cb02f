#include "freeze_watch.hpp"

#include <algorithm>
#include <charconv>
#include <ctime>
#include <stdexcept>
#include <system_error>

namespace topogeo::messaging {

namespace {

constexpr FreezeWatch::Duration kWakePeriod = std::chrono::milliseconds(500);

/// Goes on while the machine sleeps, as the steady clock does not.
FreezeWatch::Duration since_boot() {
  timespec time{};
  clock_gettime(CLOCK_BOOTTIME, &time);
  return std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec);
}

}  // namespace

Standstill::Duration Standstill::awake(Duration now) {
  longest_ = std::max(longest_, now - last_);
  last_ = now;
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

// Half a second too long at most: rather too early than never.
void FreezeWatch::watch() {
  Standstill standstill(since_boot());
  std::unique_lock lock(mutex_);
  while (!ending_.wait_for(lock, kWakePeriod, [this] { return ends_; })) {
    stood_still_ns_ = standstill.awake(since_boot()).count();
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
                             "', allowed are whole seconds from 0 (any time) to 1000000");
  }
  return seconds == 0 ? std::chrono::nanoseconds::max() : std::chrono::seconds(seconds);
}

}  // namespace topogeo::messaging
