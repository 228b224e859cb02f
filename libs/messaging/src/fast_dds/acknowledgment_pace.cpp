#include "acknowledgment_pace.hpp"

#include <utility>

namespace topogeo::messaging {

bool AcknowledgmentPace::due(const void* reader, Time now) {
  constexpr int kPeriodsKept = 50;
  const std::lock_guard lock(mutex_);
  if (now - forgotten_ >= kPeriodsKept * period_) {
    forgotten_ = now;
    std::erase_if(readers_, [&](const auto& entry) { return now - entry.second.sent >= pause_; });
  }
  const auto [entry, first] = readers_.try_emplace(reader, Reader{now, now});
  Reader& known = entry->second;
  const Time sent = std::exchange(known.sent, now);
  if (!first && now - sent < pause_ && now - known.asked < period_) return false;
  known.asked = now;
  return true;
}

std::size_t AcknowledgmentPace::readers() const {
  const std::lock_guard lock(mutex_);
  return readers_.size();
}

}  // namespace topogeo::messaging
