// Markov localization as the source of poses (spec B3).
#include "navigator_state.hpp"

namespace topogeo::navigation {

void Navigator::State::use_markov() {
  if (!markov.on()) return;
  if (!follower.take_finished().empty()) markov.primitive_done();
  if (const auto fix = markov.pose()) {
    keeper.add(*fix);
    // What it does not know well enough it looks for before it counts as lost.
    constexpr double kUnsure = 0.8;
    const bool unsure = keeper.sigma_m() > kUnsure * config.largest_sigma_m;
    if ((unsure || !fix->tracking) && !markov.looks()) markov.begin_look(now_ns);
  }
  double corrected_m = 0.0;
  if (markov.looks() && markov.look(now_ns, corrected_m)) {
    if (const auto fix = markov.pose()) keeper.add(*fix);
    constexpr double kMoved_m = 0.05;
    if (corrected_m > kMoved_m) needs_path = true;
    if (settle_ns) looked_at_end = true;
  }
}

std::optional<geometry::Velocity> Navigator::State::look() {
  if (!markov.on()) return std::nullopt;
  if (settle_ns && !looked_at_end && !markov.looks()) markov.begin_look(now_ns);
  if (!settle_ns && follower.has_path() && !needs_path &&
      markov.comes_to_node(follower.progress_m())) {
    markov.begin_look(now_ns);
  }
  if (!markov.looks()) return std::nullopt;
  return stop(NavigatorState::kRelocalizing, HaltReason::kNone, "stands and looks where it is");
}

}  // namespace topogeo::navigation
