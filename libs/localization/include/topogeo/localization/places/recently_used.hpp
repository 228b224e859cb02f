// Keeps the values that were asked for last; what is made from the same input is the same again.
#pragma once

#include <algorithm>
#include <cstddef>
#include <list>
#include <utility>

namespace topogeo::localization {

template <typename Value>
class RecentlyUsed {
 public:
  /// At least one is kept.
  explicit RecentlyUsed(std::size_t capacity) : capacity_(std::max<std::size_t>(1, capacity)) {}

  /// The value of a key, made by make() unless it is there. Valid until the next call.
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
  std::list<std::pair<std::size_t, Value>> values_;  // the one used last first
};

}  // namespace topogeo::localization
