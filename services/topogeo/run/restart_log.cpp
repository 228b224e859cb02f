#include "run/restart_log.hpp"

#include <algorithm>

namespace topogeo::cli {

RestartLog::Restart RestartLog::died(const std::string& name, double now_s) {
  if (const auto worked = at_work_since_s_.extract(name);
      worked && now_s - worked.mapped() > kSettled_s) {
    deaths_in_row_[name] = 0;
  }
  away_since_s_[name] = now_s;
  constexpr std::uint32_t kMostDoublings = 10;  // far beyond the longest delay
  const std::uint32_t doublings = std::min(deaths_in_row_[name]++, kMostDoublings);
  return {std::min(kFirstDelay * (1U << doublings), kLongestDelay), ++restarts_[name]};
}

std::optional<double> RestartLog::at_work(const std::string& name, double now_s) {
  const auto away = away_since_s_.extract(name);
  if (!away) return std::nullopt;
  at_work_since_s_[name] = now_s;
  return now_s - away.mapped();
}

std::vector<std::string> RestartLog::away() const {
  std::vector<std::string> names;
  names.reserve(away_since_s_.size());
  for (const auto& [name, since_s] : away_since_s_) names.push_back(name);
  return names;
}

void RestartLog::clear() {
  away_since_s_.clear();
  at_work_since_s_.clear();
}

bool has_worked(msg::ServiceState state) {
  return state == msg::kServiceRunning || state == msg::kServiceFinished;
}

}  // namespace topogeo::cli
