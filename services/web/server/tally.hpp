// Counters of the server thread for the status of the service.
#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <string_view>

namespace topogeo::web {

/// Thread-safe.
class Tally {
 public:
  void add(std::string_view name, std::uint64_t amount = 1) {
    const std::scoped_lock lock(mutex_);
    const auto found = counts_.find(name);
    if (found != counts_.end()) {
      found->second += amount;
    } else {
      counts_.emplace(name, amount);
    }
  }
  void set(const std::string& name, std::uint64_t value) {
    const std::scoped_lock lock(mutex_);
    counts_[name] = value;
  }
  [[nodiscard]] std::map<std::string, std::uint64_t, std::less<>> counts() const {
    const std::scoped_lock lock(mutex_);
    return counts_;
  }

 private:
  mutable std::mutex mutex_;
  std::map<std::string, std::uint64_t, std::less<>> counts_;
};

}  // namespace topogeo::web
