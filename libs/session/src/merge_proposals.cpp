#include "topogeo/session/merge_proposals.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>

namespace topogeo::localization {

namespace {

using State = MergeProposal::State;

// At this distance two places of a floor show different walls.
constexpr double kOtherPlace_m = 10.0;
// Limit of listed proposals. Refused ones are also needed to respect the refusal.
constexpr std::size_t kMostKept = 64;

bool between_maps(const MergeProposals::Placed& a, const MergeProposals::Placed& b,
                  const MergeProposals::Placed& c, const MergeProposals::Placed& d) {
  return a.map == c.map && b.map == d.map;
}

/// Pose of the stop, or of its last known predecessor: the stop may have left the map, or not have
/// arrived yet at a restarted localizer.
std::optional<MergeProposals::Placed> find_near(const MergeProposals::Find& find,
                                                topomap::StopId stop) {
  for (;; --stop.number) {
    if (const auto placed = find(stop)) return placed;
    if (stop.number == 0) return {};
  }
}

double apart_m(const MergeProposals::Placed& a, const MergeProposals::Placed& b) {
  return (a.T_map_robot.position_m() - b.T_map_robot.position_m()).norm();
}

}  // namespace

bool MergeProposals::refused_there(const MergeProposal& found, const Find& find) const {
  const auto stop = find(found.place.stop);
  const auto other = find(found.place.other);
  if (!stop || !other) return true;
  int refusals = 0;
  double nearest_m = std::numeric_limits<double>::infinity();
  const auto heed = [&](const topomap::StopId& one, const topomap::StopId& two) {
    auto a = find_near(find, one);
    auto b = find_near(find, two);
    if (!a || !b) return;
    if (!between_maps(*stop, *other, *a, *b)) std::swap(a, b);
    if (!between_maps(*stop, *other, *a, *b)) return;
    ++refusals;
    nearest_m = std::min(nearest_m, std::max(apart_m(*stop, *a), apart_m(*other, *b)));
  };
  for (const auto& [one, two] : refused_before_) heed(one, two);
  for (const MergeProposal& before : proposals_) {
    if (before.state == State::kRefused) heed(before.place.stop, before.place.other);
  }
  return refusals > 0 && nearest_m < std::ldexp(kOtherPlace_m, refusals - 1);
}

bool MergeProposals::offer(MergeProposal found, const Find& find) {
  if (refused_there(found, find)) return false;
  const auto stop = find(found.place.stop);
  const auto other = find(found.place.other);
  for (MergeProposal& open : proposals_) {
    if (open.state != State::kOpen) continue;
    const auto a = find(open.place.stop);
    const auto b = find(open.place.other);
    if (!a || !b) continue;
    if (!between_maps(*stop, *other, *a, *b) && !between_maps(*stop, *other, *b, *a)) continue;
    found.number = open.number;
    open = std::move(found);
    return true;
  }
  found.number = next_++;
  found.state = State::kOpen;
  proposals_.push_back(std::move(found));
  if (proposals_.size() > kMostKept) {
    const auto answered = std::ranges::find_if(
        proposals_, [](const MergeProposal& p) { return p.state != State::kOpen; });
    if (answered != proposals_.end()) proposals_.erase(answered);
  }
  return true;
}

MergeProposal MergeProposals::decide(std::uint32_t number, State state) {
  const auto found = std::ranges::find(proposals_, number, &MergeProposal::number);
  if (found == proposals_.end()) {
    throw std::invalid_argument("merge " + std::to_string(number) + " does not exist");
  }
  if (found->state != State::kOpen) {
    throw std::invalid_argument("merge " + std::to_string(number) + " is no longer open");
  }
  found->state = state;
  return *found;
}

void MergeProposals::check(const Find& find) {
  for (MergeProposal& proposal : proposals_) {
    if (proposal.state != State::kOpen) continue;
    const auto a = find(proposal.place.stop);
    const auto b = find(proposal.place.other);
    if (!a || !b) {
      proposal.state = State::kWithdrawn;
    } else if (a->map == b->map) {
      proposal.state = State::kAccepted;
    }
  }
}

}  // namespace topogeo::localization
