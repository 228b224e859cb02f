#include "arrivals.hpp"

#include <algorithm>
#include <utility>

namespace topogeo::messaging::detail {

void Arrivals::announce() {
  {
    const std::lock_guard lock(mutex_);
    announced_ = true;
  }
  arrived_.notify_all();
}

bool Arrivals::take_announced() {
  const std::lock_guard lock(mutex_);
  return std::exchange(announced_, false);
}

void Arrivals::put(std::vector<Arrival> batch) {
  Queue replaced;  // their messages are freed without the lock
  const std::lock_guard lock(mutex_);
  for (Arrival& arrival : batch) put(std::move(arrival), replaced);
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
  announced_ = true;
  return true;
}

std::size_t Arrivals::size() const {
  const std::lock_guard lock(mutex_);
  return queue_.size();
}

bool Arrivals::wait(std::chrono::nanoseconds timeout) {
  std::unique_lock lock(mutex_);
  return arrived_.wait_for(lock, timeout, [this] { return announced_ || !queue_.empty(); });
}

}  // namespace topogeo::messaging::detail
