#include "recent_complaint.hpp"

#include <utility>

namespace topogeo::ros_bridge {

void RecentComplaint::add(std::string text, std::int64_t now_ns) {
  text_ = std::move(text);
  since_ns_ = now_ns;
}

bool RecentComplaint::grows(const std::string& reason, std::uint64_t count) {
  return std::exchange(counts_[reason], count) < count;
}

std::string RecentComplaint::text(std::int64_t now_ns) const {
  return now_ns - since_ns_ < kRemembered_ns ? text_ : "";
}

}  // namespace topogeo::ros_bridge
