#include "arrivals.hpp"

#include <algorithm>

namespace topogeo::messaging::detail {

bool Arrivals::put(std::vector<Arrival> batch) {
  std::list<Arrival> replaced;  // messages are freed without the lock
  {
    const std::lock_guard lock(mutex_);
    if (batch.empty()) return false;
    const bool first = queue_.empty();
    for (Arrival& arrival : batch) put(std::move(arrival), replaced);
    if (!first) return false;
  }
  arrived_.notify_all();
  return true;
}

void Arrivals::put(Arrival arrival, Queue& replaced) {
  auto& same = by_key_[{arrival.info.instance, arrival.info.writer}];
  const auto later = std::ranges::upper_bound(same, arrival.number, {},
                                              [](const auto& held) { return held->number; });
  const auto before = later == same.end() ? queue_.end() : *later;
  same.insert(later, queue_.insert(before, std::move(arrival)));
  if (same.size() <= depth_) return;
  replaced.splice(replaced.end(), queue_, same.front());
  same.pop_front();
}

bool Arrivals::take(Arrival& oldest) {
  const std::lock_guard lock(mutex_);
  if (queue_.empty()) return false;
  oldest = std::move(queue_.front());
  const auto same = by_key_.find({oldest.info.instance, oldest.info.writer});
  same->second.pop_front();
  if (same->second.empty()) by_key_.erase(same);
  queue_.pop_front();
  return true;
}

bool Arrivals::is_full(std::size_t more) {
  const std::lock_guard lock(mutex_);
  if (queue_.size() + more <= capacity_) return false;
  was_full_ = true;
  return true;
}

bool Arrivals::was_full() {
  const std::lock_guard lock(mutex_);
  return std::exchange(was_full_, false);
}

std::size_t Arrivals::size() const {
  const std::lock_guard lock(mutex_);
  return queue_.size();
}

bool Arrivals::wait(std::chrono::nanoseconds timeout) {
  std::unique_lock lock(mutex_);
  return arrived_.wait_for(lock, timeout, [this] { return !queue_.empty(); });
}

}  // namespace topogeo::messaging::detail
