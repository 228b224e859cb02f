// The last complaint about inputs, for the reason in the status of the bridge.
#pragma once

#include <cstdint>
#include <map>
#include <string>

namespace topogeo::ros_bridge {

/// The caller passes the time, nanoseconds of a clock that never goes back.
class RecentComplaint {
 public:
  /// Time after which a complaint that does not recur is forgotten.
  static constexpr std::int64_t kRemembered_ns = 10'000'000'000;

  void add(std::string text, std::int64_t now_ns);
  /// Whether `count` of `reason` has grown since the last call for that reason.
  bool grows(const std::string& reason, std::uint64_t count);
  /// Empty: no complaint lately.
  [[nodiscard]] std::string text(std::int64_t now_ns) const;

 private:
  std::string text_;
  std::int64_t since_ns_ = 0;
  std::map<std::string, std::uint64_t> counts_;
};

}  // namespace topogeo::ros_bridge
