#include "topogeo/service/command_ages.hpp"

#include <algorithm>
#include <utility>

namespace topogeo::service {
namespace {

/// Clocks drift apart by about a millisecond in it, and a longer stall of a queue is noticed
/// before.
constexpr std::int64_t kAgeWindow_ns = 10'000'000'000;

}  // namespace

std::optional<std::int64_t> CommandAges::age_ns(const messaging::Handle& handle,
                                                std::int64_t stamp_ns, std::int64_t now_ns,
                                                std::int64_t own_ns) {
  const std::int64_t offset_ns = now_ns - stamp_ns;
  Sender& sender = sender_of(handle, offset_ns, now_ns);
  note(sender, offset_ns, now_ns);
  const std::int64_t own_age_ns = own_ns - stamp_ns;
  const bool fresh = own_age_ns >= -kOldest_ns && own_age_ns <= kOldest_ns;
  const bool delayed = own_age_ns > kOldest_ns && own_age_ns <= kLongestDelay_ns;
  sender.own_clock = fresh || (sender.own_clock && delayed);
  if (now_ns - sender.first_ns < kKnown_ns) {
    if (!fresh) return std::nullopt;
    return std::max<std::int64_t>(0, own_age_ns);
  }
  std::int64_t age_ns = offset_ns - std::min(sender.least_ns, sender.before_ns);
  if (sender.own_clock) age_ns = std::max(age_ns, own_age_ns);
  if (set_back(sender, age_ns > kOldest_ns, offset_ns, now_ns)) begin(sender, offset_ns, now_ns);
  return age_ns;
}

void CommandAges::begin(Sender& sender, std::int64_t offset_ns, std::int64_t now_ns) {
  sender = Sender{.first_ns = now_ns,
                  .last_ns = now_ns,
                  .window_ns = now_ns,
                  .least_ns = offset_ns,
                  .before_ns = offset_ns,
                  .own_clock = sender.own_clock};
}

CommandAges::Sender& CommandAges::sender_of(const messaging::Handle& handle, std::int64_t offset_ns,
                                            std::int64_t now_ns) {
  const auto known = senders_.find(handle);
  if (known != senders_.end() && now_ns - known->second.last_ns <= kPause_ns) return known->second;
  if (known == senders_.end() && senders_.size() >= kMostSenders) {
    senders_.erase(std::min_element(
        senders_.begin(), senders_.end(),
        [](const auto& a, const auto& b) { return a.second.last_ns < b.second.last_ns; }));
  }
  Sender& sender = senders_[handle];
  begin(sender, offset_ns, now_ns);
  return sender;
}

void CommandAges::note(Sender& sender, std::int64_t offset_ns, std::int64_t now_ns) {
  sender.last_ns = now_ns;
  if (now_ns - sender.window_ns > kAgeWindow_ns) {
    sender.before_ns = std::exchange(sender.least_ns, offset_ns);
    sender.window_ns = now_ns;
  }
  sender.least_ns = std::min(sender.least_ns, offset_ns);
}

bool CommandAges::set_back(Sender& sender, bool old, std::int64_t offset_ns, std::int64_t now_ns) {
  if (!old) {
    sender.old_since_ns.reset();
    return false;
  }
  if (!sender.old_since_ns) {
    sender.old_since_ns = now_ns;
    sender.old_least_ns = sender.old_most_ns = offset_ns;
  }
  sender.old_least_ns = std::min(sender.old_least_ns, offset_ns);
  sender.old_most_ns = std::max(sender.old_most_ns, offset_ns);
  if (now_ns - *sender.old_since_ns < kSetBack_ns) return false;
  const bool equally = sender.old_most_ns - sender.old_least_ns < kOldest_ns;
  sender.old_since_ns.reset();
  return equally;
}

}  // namespace topogeo::service
