#include "topogeo/messaging/total_rate.hpp"

namespace topogeo::messaging {

double TotalRate::add(Time now, std::uint64_t total) {
  samples_.emplace_back(now, total);
  // Keeps the newest sample before the window, because a rate needs an earlier time.
  while (samples_.size() > 2 && now - samples_[1].first >= kWindow) samples_.pop_front();
  const auto& [first_time, first_total] = samples_.front();
  const double passed_s = std::chrono::duration<double>(now - first_time).count();
  return passed_s > 0.0 ? static_cast<double>(total - first_total) / passed_s : 0.0;
}

}  // namespace topogeo::messaging
