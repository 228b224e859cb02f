// Places where the collision guard stopped the robot. No other memory holds obstacles that only
// sonars hear, and a detour has to avoid them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace topogeo::navigation {

class ContactMemory {
 public:
  static constexpr std::size_t kMost = 20;  ///< a new one replaces the oldest

  /// Adds a contact, map frame; a known one counts as met again.
  void add(const Eigen::Vector2d& contact_m, std::int64_t now_ns) {
    constexpr double kSame_m = 0.05;  // half a cell
    std::erase_if(contacts_, [&](const Contact& known) {
      return (known.point_m - contact_m).norm() < kSame_m;
    });
    if (contacts_.size() >= kMost) contacts_.erase(contacts_.begin());
    contacts_.push_back({contact_m, now_ns});
  }
  void clear() { contacts_.clear(); }

  /// Contacts of the last seconds, in the order of their last meeting.
  [[nodiscard]] std::vector<Eigen::Vector2d> points_m(std::int64_t now_ns) const {
    constexpr std::int64_t kKept_ns = 12'000'000'000;  // long enough to drive round it
    std::vector<Eigen::Vector2d> points_m;
    for (const Contact& contact : contacts_) {
      if (now_ns - contact.met_ns < kKept_ns) points_m.push_back(contact.point_m);
    }
    return points_m;
  }

 private:
  struct Contact {
    Eigen::Vector2d point_m;
    std::int64_t met_ns;
  };
  std::vector<Contact> contacts_;  ///< last met at the end
};

}  // namespace topogeo::navigation
