// Cache of the most recently used values. Values must be reproducible from their key.
#pragma once

#include <algorithm>
#include <cstddef>
#include <list>
#include <utility>

namespace topogeo::support {

template <typename Value>
class RecentlyUsed {
 public:
  /// Keeps at least one value.
  explicit RecentlyUsed(std::size_t capacity) : capacity_(std::max<std::size_t>(1, capacity)) {}

  /// The value of a key, made by make() if it is not cached. Valid until the next call.
  template <typename Make>
  Value& get(std::size_t key, const Make& make) {
    const auto found = std::find_if(values_.begin(), values_.end(),
                                    [&](const auto& entry) { return entry.first == key; });
    if (found != values_.end()) {
      values_.splice(values_.begin(), values_, found);
    } else {
      values_.emplace_front(key, make());
      while (values_.size() > capacity_) values_.pop_back();
    }
    return values_.front().second;
  }

 private:
  std::size_t capacity_;
  std::list<std::pair<std::size_t, Value>> values_;  // most recently used first
};

}  // namespace topogeo::support
