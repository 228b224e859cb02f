#include "topogeo/messaging/input_meter.hpp"

#include <algorithm>

namespace topogeo::messaging {

namespace {

constexpr std::chrono::milliseconds kSlice{100};  // bounds the memory: 50 slices in a window

double seconds(std::chrono::steady_clock::duration duration) {
  return std::chrono::duration<double>(duration).count();
}

}  // namespace

void InputMeter::count(Time now) {
  if (total_++ == 0) first_ = now;
  last_ = now;
  if (recent_.empty() || now - recent_.back().first >= kSlice) recent_.emplace_back(now, 0);
  ++recent_.back().second;
  while (now - recent_.front().first > kWindow) recent_.pop_front();
}

double InputMeter::rate_per_s(Time now) const {
  std::uint64_t count = 0;
  for (const auto& [start, in_slice] : recent_) {
    if (now - start <= kWindow) count += in_slice;
  }
  const double passed_s = std::clamp(seconds(now - first_), 1.0, seconds(kWindow));
  return static_cast<double>(count) / passed_s;
}

double InputMeter::age_s(Time now) const {
  return total_ == 0 ? 0.0 : seconds(now - last_);
}

}  // namespace topogeo::messaging
