#include "stop_numbers.hpp"

#include <algorithm>

namespace topogeo::localization {

namespace {

/// Whether all existing numbers stay valid: only the end has grown.
bool continues(const PartOrder& before, const PartOrder& now) {
  if (before.size() > now.size()) return false;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const bool at_end = i + 1 == before.size();
    if (before[i].part != now[i].part || before[i].stops > now[i].stops ||
        (!at_end && before[i].stops != now[i].stops)) {
      return false;
    }
  }
  return true;
}

}  // namespace

void StopNumbers::update(const PartOrder& parts, bool all, std::uint64_t version) {
  PartOrder next = parts;
  if (!all && order_.size() == parts.size()) {
    std::size_t waiting = 0;
    bool is_same = true;
    for (std::size_t i = 0; i + 1 < parts.size(); ++i) {
      is_same &= order_[i].part == parts[i].part && order_[i].stops <= parts[i].stops;
      waiting += parts[i].stops - std::min(order_[i].stops, parts[i].stops);
      next[i].stops = order_[i].stops;
    }
    if (!is_same || waiting >= kTogether) next = parts;
  }
  if (!continues(order_, next)) numbered_since_ = version;
  order_ = std::move(next);
}

}  // namespace topogeo::localization
